"""SDF files written by tests, and read as scenes."""

from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import SceneRequest, read_scene
from clearance.formats.schema.obstacle import Scene

BOX = "<box><size>0.2 0.4 0.6</size></box>"


def sdf(*parts, version="1.9"):
    return f'<?xml version="1.0"?>\n<sdf version="{version}">{"".join(parts)}</sdf>'


def world(*parts):
    return f'<world name="w">{"".join(parts)}</world>'


def model(*parts, name="m", attributes=""):
    return f'<model name="{name}"{attributes}>{"".join(parts)}</model>'


def link(*parts, name="l"):
    return f'<link name="{name}">{"".join(parts)}</link>'


def collision(shape=BOX, *parts, name="c"):
    return f'<collision name="{name}">{"".join(parts)}<geometry>{shape}</geometry></collision>'


def pose(text, relative_to="", more=""):
    base = f' relative_to="{relative_to}"' if relative_to else ""
    return f"<pose{base}{more}>{text}</pose>"


def at(x, relative_to=""):
    return pose(f"{x} 0 0 0 0 0", relative_to)


def content_of(folder, document, package_dirs=()):
    """What the reader makes of a document."""
    path = folder / "cell.sdf"
    path.write_bytes(document if isinstance(document, bytes) else document.encode())
    return read_scene(SceneRequest(path, InputFiles(folder), tuple(package_dirs)))


def obstacles_of(folder, document, package_dirs=()):
    """The obstacles of a document, by name."""
    content = content_of(folder, document, package_dirs)
    made, _ = make_obstacles(
        Scene.model_validate(content.scene).obstacles, folder, MeshStore(InputFiles(folder))
    )
    return {one.name: one for one in made}


def places_of(folder, document, package_dirs=()):
    """The x [m] of each obstacle, by name."""
    made = obstacles_of(folder, document, package_dirs)
    return {name: round(float(one.world_from_body[0, 3]), 12) for name, one in made.items()}


def library(folder, name="post", document=None, config=True):
    place = folder / name
    place.mkdir(parents=True)
    (place / "model.sdf").write_text(document or sdf(model(at(1), link(collision()), name=name)))
    if config:
        rows = '<sdf version="1.12">new.sdf</sdf><sdf version="1.5">model.sdf</sdf>'
        (place / "model.config").write_text(f"<model>{rows}<sdf>old.sdf</sdf></model>")


def include(*parts, uri="model://post", attributes=""):
    return f"<include{attributes}><uri>{uri}</uri>{''.join(parts)}</include>"
