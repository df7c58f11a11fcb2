"""What is no solid and no convex polygon is refused in one line, of our own kind, by every entry."""

from __future__ import annotations

import math

import numpy as np
import pytest

import clearance as cl

BOX = cl.box((1.0, 1.0, 1.0))
HULL = cl.Polytope(BOX.vertices)
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
DART = [[0, 0, 0], [1, 0, 0], [0.1, 0.1, 0], [0, 1, 0]]
PENTAGON = [[math.cos(2 * math.pi * k / 5), math.sin(2 * math.pi * k / 5), 0] for k in range(5)]
STAR = [[math.cos(4 * math.pi * k / 5), math.sin(4 * math.pi * k / 5), 0] for k in range(5)]
BOW = [[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    "given", [3, None, "box.stl", np.eye(3), HULL], ids=lambda x: type(x).__name__
)
@pytest.mark.parametrize("swapped", [False, True])
@pytest.mark.parametrize("ask", ["distance", "contact", "Query", "paper"])
def test_what_is_no_polyhedron(ask: str, swapped: bool, given: object) -> None:
    asks = {
        "distance": cl.distance,
        "contact": cl.contact,
        "Query": cl.Query,
        "paper": lambda a, b: cl.distance(a, b, method="paper"),
    }
    pair = (BOX, given) if swapped else (given, BOX)
    with pytest.raises(cl.BadInput, match="is no Polyhedron; ") as error:
        asks[ask](*pair)
    assert str(error.value).startswith("b: " if swapped else "a: ")


@pytest.mark.parametrize("given", [3, None, np.eye(3), BOX], ids=lambda x: type(x).__name__)
def test_what_is_no_polytope(given: object) -> None:
    for ask in (
        lambda: cl.intersect(given),
        lambda: cl.intersect([HULL, given]),
        lambda: cl.common_point([given, HULL]),
        lambda: cl.common_point(given),
        lambda: cl.penetration(given, HULL),
        lambda: cl.penetration(HULL, given),
    ):
        with pytest.raises(cl.BadInput) as error:
            ask()
        assert "Polytope" in str(error.value)


@pytest.mark.parametrize("method", ["exact", "paper"])
@pytest.mark.parametrize(
    "bad", [DART, DART[::-1], BOW, STAR], ids=["dart", "backward", "bow", "star"]
)
def test_polygons_that_are_not_convex(bad: list, method: str) -> None:
    for ask, where in (
        (lambda: cl.polygon_distance(bad, SQUARE, method=method), "p"),
        (lambda: cl.polygon_distance(SQUARE, bad, method=method), "q"),
    ):
        with pytest.raises(cl.BadInput, match="polygon 0 is not convex") as error:
            ask()
        assert str(error.value).startswith(f"{where}: ")
    good = SQUARE if len(bad) == 4 else PENTAGON
    with pytest.raises(cl.BadInput, match="ps: polygon 1 is not convex"):
        cl.polygon_distances([good, bad], [good, good], method=method)


def test_a_tolerance_belongs_to_the_paper() -> None:
    far = np.eye(4)
    far[0, 3] = 5.0
    with pytest.raises(cl.BadInput, match="method 'exact' has no tolerance"):
        cl.distance(BOX, BOX, pose_b=far, tolerance=1.0)
    for bad in (0.0, -1.0, math.nan, "1"):
        with pytest.raises(cl.BadInput, match="tolerance"):
            cl.distance(BOX, BOX, pose_b=far, method="paper", tolerance=bad)
    assert cl.distance(BOX, BOX, pose_b=far, method="paper", tolerance=10.0).distance == 4.0
    assert cl.distance(BOX, BOX, pose_b=far, method="paper", tolerance=1.0).distance == math.inf
