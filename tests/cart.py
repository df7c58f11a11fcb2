"""A cart on a rail before a wall, as files: the least robot that moves. What a folder holds after a command."""

from __future__ import annotations

from pathlib import Path

ROOT = Path(__file__).parents[1]

URDF = """<robot name="cart"><link name="ground"/>
  <link name="slider"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="slider"/>
    <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="9" velocity="9"/></joint></robot>"""
CASE = """name: rail
robot: {urdf: cart.urdf}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0], quat_xyzw: [0, 0, 0, 1]}}
allow: []
trajectory: {file: path.csv}
limits: {fail: 0.05, warn: 0.3}
"""
PATH = "time,rail\n0,0\n1,0.3\n2,0.7\n"
"""0.8, 0.5 and 0.1 m from the wall."""


def write_cart(folder: Path, case: str = CASE, path: str = PATH) -> Path:
    """Writes the three files into a folder; the case file."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("cart.urdf", URDF), ("case.yaml", case), ("path.csv", path)):
        (folder / name).write_text(text)
    return folder / "case.yaml"


def files(folder: Path) -> dict[str, bytes]:
    """The content of each file in a folder and below, by path."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
