"""Small URDF files, put together from their elements."""

from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import RobotRequest, read_robot
from clearance.formats.robot.urdf.elements import checked_document, reduced_document
from tests.formats.making import cube_stl


def load_robot(folder, urdf, package_dirs=(), geometry="collision"):
    path = folder / "arm.urdf"
    path.write_bytes(urdf.encode() if isinstance(urdf, str) else urdf)
    if not (folder / "upper.stl").exists():
        (folder / "upper.stl").write_bytes(cube_stl())
    request = RobotRequest(path, tuple(package_dirs), geometry)
    return read_robot(request, MeshStore(InputFiles(folder)))


def parse_document(data: bytes):
    """The checked root element of a document."""
    return checked_document(reduced_document(data)[0])


def link(shapes: str, name: str = "a") -> str:
    return f'<link name="{name}">{shapes}</link>'


def collision(shape: str, origin: str = "") -> str:
    return f"<collision>{origin}<geometry>{shape}</geometry></collision>"


def robot(*elements: str) -> str:
    return f'<robot name="r">{"".join(elements)}</robot>'


def joint(name, parent, child, kind="revolute", inner='<limit lower="-1" upper="1"/>') -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inner}</joint>'


BOX = collision('<box size="1 1 1"/>')
"""A cube of one metre, to collide with."""
