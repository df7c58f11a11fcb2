"""`worst_moments.yaml`: plain YAML, what MoveIt calls things, all that is near, and no more than a file holds."""

import pytest
from ruamel.yaml import YAML

import clearance as cl
from clearance.report import moveit_moments
from tests.made_cases import at
from tests.report.cells import LEFT, box, cell, sliding
from tests.report.made import model_of
from tests.report.records import record

WIDE = (cl.Rule(("*", "*"), name="wide", fail=0.0, warn=9.0),)
LIMITS = cl.Limits(fail=0.01, warn=0.3)


def moments_text(made) -> str:
    return moveit_moments.moments_text(model_of(made))


def read(text: str):
    return YAML(typ="safe", pure=True).load(text)


def test_what_is_too_much_is_left_out_and_counted(monkeypatch):
    run = record(limits=LIMITS)
    n = len(read(moments_text(run))["moments"])
    monkeypatch.setattr(moveit_moments, "MOST", n - 2)
    told = read(moments_text(run))
    assert (len(told["moments"]), told["n_left_out"]) == (n - 2, 2)


def test_links_name_their_robot_where_there_are_several_and_held_parts_the_link():
    part, wall = box("part", (0.05, 0.05, 0.05), at(0.5, z=0.9)), box("wall", (0.1, 2, 2), at(1.6))
    carries = (cl.Carry("part", "left/tool", cl.Window(0.0)),)
    robots = sliding("left", LEFT), sliding("right", LEFT, at(0.0, 3.0))
    case = cell(WIDE, robots, (part, wall), carries)
    moments = read(moments_text(cl.check(case)))["moments"]
    bodies = [body for moment in moments for body in moment["bodies"]]
    assert {"type": "ROBOT_LINK", "link_name": "tool", "robot": "left"} in bodies
    assert {"type": "ROBOT_ATTACHED", "id": "part", "link_name": "tool", "robot": "left"} in bodies
    assert {"type": "WORLD_OBJECT", "id": "wall"} in bodies
    left, right = moments[0]["robot_states"]
    assert left["attached_collision_objects"] == [{"link_name": "tool", "object": {"id": "part"}}]
    assert (right["robot"], right["attached_collision_objects"]) == ("right", [])


def test_padding_is_told_where_there_is_some():
    wall = box("wall", (0.1, 1, 1), at(1.6), padding=0.01)
    case = cell(WIDE, (sliding("arm", LEFT),), (wall,), ())
    moment = read(moments_text(cl.check(case)))["moments"][0]
    assert moment["padding"] == 0.01
    assert moment["distance"] == pytest.approx(moment["clearance"] + 0.01, abs=1e-15)
