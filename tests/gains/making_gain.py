"""Cases on disk whose least change is known by hand: a bar on slides goes through a slot, off its middle."""

import numpy as np

SLIDER = """<?xml version="1.0"?>
<robot name="{name}">
  <link name="base"/><link name="cart"/>
  <link name="tool"><collision><geometry><box size="{size}"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="10"/></joint>
  <joint name="y" type="prismatic"><parent link="cart"/><child link="tool"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="10"/></joint>
</robot>
"""

SLOT = """\
# A bar through a slot.
robot:
  urdf: robots/bar.urdf  # of the shop
  base: {xyz: [0.0, 0.0, 0.0], rpy: [0.0, 0.0, 0.0]}
scene:
  obstacles:
  - name: left  # fixed by two screws
    box: {size: [0.5, 0.4, 2.0]}
    pose: {xyz: [0.0, 0.3, 0.0]}
  - {name: right, box: {size: [0.5, 0.4, 2.0]}, pose: {xyz: [0.0, -0.3, 0.0]}}
trajectory: {file: path.csv, start: 0.5}
limits: {fail: 0.04, warn: 0.04}  # agreed
"""

CROSSING = """\
robots:
- {name: one, urdf: robots/one.urdf, trajectory: along_x.csv}
- {name: other, urdf: robots/one.urdf, trajectory: {file: along_y.csv, rate: 1.0}}
scene: {obstacles: []}
limits: {fail: 0.05, warn: 0.05}
"""

CARRYING = (
    CROSSING.replace(
        "obstacles: []",
        "obstacles: [{name: part, box: {size: [0.04, 0.04, 0.04]}, pose: {xyz: [0.0, -0.5, 0.2]}}]",
    )
    + 'carry: [{part: part, by: other/tool, from: 0.25, until: 0.9, touch: ["other/*"]}]\n'
)

MOVING = """\
robot: {urdf: robots/one.urdf}
trajectory: along_x.csv
scene:
  obstacles:
  - name: cart
    box: {size: [0.1, 0.1, 0.1]}
    moves: {file: cart.csv, start: 0.0}
limits: {fail: 0.05, warn: 0.05}
"""


def write_cell(folder, text):
    """A case file in a folder, with all that these cases name."""
    robots = folder / "robots"
    robots.mkdir(parents=True, exist_ok=True)
    (robots / "bar.urdf").write_text(SLIDER.format(name="bar", size="0.4 0.1 0.1"))
    (robots / "one.urdf").write_text(SLIDER.format(name="one", size="0.1 0.1 0.1"))
    times = np.linspace(0.0, 1.0, 41)
    along = np.linspace(-1.0, 1.0, 41)
    still = np.zeros(41)
    _table(folder / "path.csv", "time,x,y", times, along, still + 0.03)
    _table(folder / "along_x.csv", "time,x,y", times, along, still)
    _table(folder / "along_y.csv", "time,x,y", times, still, along)
    turn = [still, still, still, still + 1.0000000001]
    _table(folder / "cart.csv", "time,x,y,z,qx,qy,qz,qw", times, still, along, still, *turn)
    (folder / "case.yaml").write_text(text)
    return folder / "case.yaml"


def _table(path, header, *columns):
    rows = [",".join(map(repr, row)) for row in np.column_stack(columns).tolist()]
    path.write_text("\n".join([header, *rows, ""]))
