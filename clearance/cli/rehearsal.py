"""Small questions which between them call the kernels that real ones call, so that these lie compiled afterwards.

Not for: answers that anybody reads, and times.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

URDF = """<robot name="cart">
<link name="rail"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
<link name="slide"><collision><origin xyz="0 0 0.2"/><geometry><mesh filename="ball.stl"/></geometry></collision>
</link>
<link name="arm"><collision><geometry><cylinder radius="0.03" length="0.3"/></geometry></collision>
<collision><origin xyz="0 0 0.1"/><geometry><mesh filename="shelf.obj"/></geometry></collision></link>
<joint name="x" type="prismatic"><parent link="rail"/><child link="slide"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" velocity="9" effort="9"/></joint>
<joint name="turn" type="revolute"><parent link="slide"/><child link="arm"/><origin xyz="0 0 0.5"/>
<axis xyz="0 0 1"/><limit lower="-9" upper="9" velocity="9" effort="9"/></joint>
</robot>
"""

SHELF = """v 0 0 0
v 0.3 0 0
v 0.3 0.1 0
v 0.1 0.1 0
v 0.1 0.3 0
v 0 0.3 0
v 0 0 0.1
v 0.3 0 0.1
v 0.3 0.1 0.1
v 0.1 0.1 0.1
v 0.1 0.3 0.1
v 0 0.3 0.1
f 6 5 4 3 2 1
f 7 8 9 10 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
"""
"""An L, cut into ears, and open on one side."""

PATH = "time,x,turn\n" + "".join(f"{0.1 * i:.1f},{0.1 * i:.1f},{0.2 * i:.1f}\n" for i in range(12))

SCENE = """scene:
  obstacles:
  - {{name: ball, mesh: {{file: ball.stl}}, pose: {{xyz: [{away}, 0, 0.2]}}}}
  - {{name: shelf, mesh: {{file: shelf.obj}}, pose: {{xyz: [{away}, 0.4, 0.4], rpy: [0, 0, 0.3]}}}}
  - {{name: post, cylinder: {{radius: 0.05, length: 1}}, pose: {{xyz: [{away}, -0.3, 0.3]}}}}
  - {{name: box, box: {{size: [0.2, 0.2, 0.2]}}, pose: {{xyz: [{away}, 0.1, 0.6]}}}}
limits: {{fail: 0.001, warn: 0.02}}
"""

ONE = "robot: {urdf: cart.urdf}\ntrajectory: path.csv\n"

TWO = """robots:
- {name: one, urdf: cart.urdf, trajectory: path.csv}
- {name: two, urdf: cart.urdf, base: {xyz: [0.9, 0.9, 0]}, trajectory: path.csv}
"""

FILES = {
    "cart.urdf": URDF,
    "shelf.obj": SHELF,
    "path.csv": PATH,
    "clear.yaml": ONE + SCENE.format(away=3.0),
    "near.yaml": ONE + SCENE.format(away=1.45),
    "contact.yaml": ONE + SCENE.format(away=0.7),
    "self.yaml": ONE.replace("urdf}", "urdf, self_clearance: true}") + SCENE.format(away=3.0),
    "common.yaml": TWO + SCENE.format(away=2.0) + "clock: common\n",
    "any_time.yaml": TWO + SCENE.format(away=2.0) + "clock: unsynchronised\n",
    "tolerances.yaml": ONE
    + SCENE.format(away=1.45)
    + "tolerance: {joints: {all: 0.001}, kinematics: {all: {xyz: 0.001}}, timing: {all: 0.01}}\n",
    "slack.yaml": TWO + SCENE.format(away=2.0) + "clock: {slack: 0.1}\n",
}


class CommandCall(NamedTuple):
    """One call of the command line, and what it is about."""

    about: str
    arguments: tuple[str, ...]


EVERYDAY = (
    CommandCall("a motion that stays clear", ("check", "clear.yaml")),
    CommandCall("a motion that comes near", ("check", "near.yaml")),
    CommandCall("a motion in contact", ("check", "contact.yaml", "--json")),
)
"""What `clearance check` does of itself."""

THE_REST = (
    CommandCall("every pair", ("check", "contact.yaml", "--need", "pairs")),
    CommandCall("steps below the limit", ("check", "near.yaml", "--need", "limit")),
    CommandCall("the worst moment", ("check", "near.yaml", "--need", "minimum")),
    CommandCall("contact of every step", ("check", "contact.yaml", "--contact", "every", "--json")),
    CommandCall("the paper's method", ("check", "near.yaml", "--method", "paper")),
    CommandCall("self-collision", ("check", "self.yaml")),
    CommandCall("two robots on one clock", ("check", "common.yaml")),
    CommandCall("two robots on two clocks", ("check", "any_time.yaml")),
    CommandCall("two clocks that nearly agree", ("check", "slack.yaml")),
    CommandCall("tolerances", ("check", "tolerances.yaml")),
)
"""What it does where it is asked to."""


def write_files(folder: Path) -> None:
    """Puts down what the questions are about."""
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "ball.stl").write_text(_ball(), encoding="utf-8")


def _ball(n: int = 16, radius: float = 0.15) -> str:
    """A sphere of some five hundred triangles, as text."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in triangle)
        + "endloop\nendfacet\n"
        for triangle in _triangles(n, radius)
    )
    return f"solid ball\n{facets}endsolid ball\n"


def _triangles(n: int, radius: float) -> Iterator[tuple[tuple[float, float, float], ...]]:
    def at(i: int, j: int) -> tuple[float, float, float]:
        polar, around = math.pi * i / n, math.pi * (j % (2 * n)) / n
        flat = radius * math.sin(polar) if 0 < i < n else 0.0
        return flat * math.cos(around), flat * math.sin(around), radius * math.cos(polar)

    for i in range(n):
        for j in range(2 * n):
            if i > 0:
                yield at(i, j), at(i + 1, j), at(i, j + 1)
            if i < n - 1:
                yield at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)
