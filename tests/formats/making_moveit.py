"""MoveIt's scenes written by tests, in both dialects and both versions of text."""

from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import SceneRequest, read_scene
from clearance.formats.schema.obstacle import Scene
from tests.formats.making import CASE, CUBE, CUBE_TRIANGLES

NAMED = CASE.partition("scene:")[0] + "scene: cell.yaml\ntrajectory: path.csv\n"
"""A case whose scene is in a file `cell.yaml` of its own."""

POSES = """
      pose: {position: {x: 1.0, y: 0.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}
      primitive_poses:
      - {position: {x: 0.0, y: 2.0, z: 0.0}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 0.0}}"""

MESSAGE = f"""name: cell
robot_model_name: arm
robot_state:
  joint_state: {{name: [shoulder], position: [0.5]}}
  attached_collision_objects:
  - link_name: tip
    object:
      header: {{frame_id: tip}}
      id: tool
      operation: 0
      primitives: [{{type: 2, dimensions: [0.05]}}]
      primitive_poses: [{{position: {{x: 0.0, y: 0.0, z: 0.1}}}}]
    touch_links: [upper]
allowed_collision_matrix:
  entry_names: [base, upper, post, ghost]
  entry_values:
  - {{enabled: [false, true, true, true]}}
  - {{enabled: [true, false, false, false]}}
  - {{enabled: [true, false, false, false]}}
  - {{enabled: [true, false, false, false]}}
  default_entry_names: []
  default_entry_values: []
link_padding:
- {{link_name: base, padding: 0.0}}
- {{link_name: upper, padding: 0.01}}
- {{link_name: ghost, padding: 1.0}}
link_scale: [{{link_name: base, scale: 1.0}}]
world:
  collision_objects:
    - header: {{frame_id: world}}
      id: post
      operation: 0
      primitives: [{{type: 1, dimensions: [0.1, 0.1, 1.0]}}]{POSES}
  octomap: {{octomap: {{data: []}}}}
is_diff: false
"""

LISTS = """fixed_frame_transforms:
- child_frame_id: base_link
  header: {frame_id: map}
  transform: {translation: [0, 0, 3], rotation: [0, 0, 0, 1]}
world:
  collision_objects:
  - id: can
    header: {frame_id: map}
    primitives:
    - {type: cylinder, dimensions: [0.14, 0.03]}
    - {type: box, dimensions: [1, 2, 3]}
    primitive_poses:
    - {position: [0.5, 0, 1], orientation: [0, 0, 0, 1]}
    - {position: [0.25, 0, 1], orientation: [0, 0, 1, 0]}
"""

_CORNERS = "\n".join(" ".join(map(str, corner)) for corner in CUBE.tolist())
_TRIANGLES = "\n".join(" ".join(map(str, triangle)) for triangle in CUBE_TRIANGLES.tolist())
_POSE, _COLOUR = "0 2 0\n0 0 0 1", "0 0 0 0"

FIRST = f"""(noname)+
* a post
1
box
0.1 0.2 0.3
{_POSE}
{_COLOUR}
* cube
2
mesh
8 12
{_CORNERS}
{_TRIANGLES}
{_POSE}
{_COLOUR}
cylinder
0.5 2
0 0 0
0 0 0 1
{_COLOUR}
.
"""

SECOND = f"""cell
* post
1 0 0
0 0 0 1
1
sphere
0.025
{_POSE}
{_COLOUR}
1
grip
0 0 0
0 0 0 1
* ball
0 0 5
0 0 0 1
1
sphere
0.05
{_POSE}
{_COLOUR}
0
.
"""


def content_of(folder, document, name="cell.yaml"):
    """What the reader makes of a document."""
    path = folder / name
    path.write_bytes(document if isinstance(document, bytes) else document.encode())
    return read_scene(SceneRequest(path, InputFiles(folder)))


def obstacles_of(folder, document, name="cell.yaml"):
    """The obstacles of a document, by name."""
    path = folder / name
    path.write_text(document)
    files = InputFiles(folder)
    content = read_scene(SceneRequest(path, files))
    given = Scene.model_validate(content.scene).obstacles
    return {one.name: one for one in make_obstacles(given, folder, MeshStore(files))[0]}
