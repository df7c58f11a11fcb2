"""Scopes of KRL: which subprogram and which variable a name means in each file, by hand."""

from __future__ import annotations

import pytest

import clearance as cl
from tests.formats.program.reading import read

FRAMES = "$TOOL=$NULLFRAME\n$BASE=$NULLFRAME\n"


def at(y: object) -> str:
    return f"{{X 0,Y {y},Z 0,A 0,B 0,C 0}}"


def heights(body: str, more: str = "", **asked: str) -> list[float]:
    """Y [mm] of the moves of a.src; other files are given by their names, `_` for the dot."""
    beside = {name.replace("_", "."): text.encode() for name, text in asked.items()}
    found = read("a.src", f"DEF a()\n{body}\nEND\n{more}\n", beside).moves
    return [round(move.to.pose[1, 3] * 1e3, 6) for move in found]


def data(name: str, *rows: str) -> str:
    return "\n".join([f"DEFDAT {name}", *rows, "ENDDAT"])


@pytest.mark.parametrize("place", ["a_dat", "config_dat"])
def test_a_variable_of_a_procedure_is_not_known_in_those_that_it_calls(place):
    beside = {place: data("$CONFIG", "DECL INT m=300")}
    sub = f"DEF sub()\nLIN {at('m')}\nm=150\nEND"
    body = f"DECL INT m\n{FRAMES}m=20\nsub()\nLIN {at('m')}\nsub()"
    assert heights(body, sub, **beside) == [300, 20, 150]
    with pytest.raises(
        cl.ClearanceError, match=r"line 11: Y of the target is not known: 'M' is in"
    ):
        heights(body, sub.replace("m=150\n", ""))
