"""Small MJCF models, written to a folder and read.

MuJoCo is imported here, before any test runs: it starts a process to find out the version of its window system.
"""

import mujoco  # noqa: F401
import numpy as np

from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import RobotRequest, read_robot
from tests.formats.making import binary_stl

TETRAHEDRON = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.2, 0.3, 0.9]])
TETRAHEDRON_TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def tetrahedron_stl() -> bytes:
    return binary_stl(TETRAHEDRON[TETRAHEDRON_TRIANGLES])


def mjcf(bodies: str, *sections: str, model: str = "toy") -> str:
    """A model of what is in the world, and other sections."""
    return f'<mujoco model="{model}">{"".join(sections)}<worldbody>{bodies}</worldbody></mujoco>'


def write_mjcf(folder, text: str | bytes, **files: bytes | str):
    """The model as a file beside others, a double underscore in whose names stands for the dot."""
    (folder / "toy.xml").write_bytes(text.encode() if isinstance(text, str) else text)
    (folder / "a.stl").write_bytes(tetrahedron_stl())
    for name, content in files.items():
        data = content.encode() if isinstance(content, str) else content
        (folder / name.replace("__", ".")).write_bytes(data)
    return folder / "toy.xml"


def load_mjcf(folder, text: str | bytes, geometry="collision", package_dirs=(), **files):
    """The robot in a model."""
    path = write_mjcf(folder, text, **files)
    request = RobotRequest(path, tuple(package_dirs), geometry)
    return read_robot(request, MeshStore(InputFiles(folder)))


BALL = '<geom size="0.1"/>'
"""A ball of 0.1 m."""

JOINTED = mjcf(
    """
<body name="b" pos="0 0 1" euler="10 20 30">
  <joint name="j" axis="0 1 1" pos="0.1 0 0" ref="10" range="-20 30"/>
  <joint name="k" type="slide" axis="1 0 1" pos="0.1 0.2 0" ref="0.1" range="-2 3"/>
  <geom size="0.1"/>
  <body name="c" pos="1 0 0" quat="0.5 0.5 -0.5 0.5"><joint name="r" axis="1 2 3"/>
    <geom size="0.1 0.2" type="capsule"/>
    <body pos="1 0 0"><geom size="0.1"/>
      <body name="e" pos="0 0 1"><joint name="w" type="ball" pos="0 0 0.1"/><geom size="0.1"/></body></body></body>
</body>
<body name="f" pos="3 0 0" euler="0 40 0"><freejoint/><geom size="0.1"/>
  <body name="g" pos="0 1 0"><joint name="m" axis="1 0 0"/>
    <joint name="n" axis="0 1 0" pos="0 0 0.3"/><geom size="0.1"/></body>
</body>""",
    '<compiler autolimits="true"/>',
)
"""Joints of every kind, several on one body and beside its origin, with references."""
