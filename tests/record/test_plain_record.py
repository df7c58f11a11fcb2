"""A record is data: nothing in it measures, and nobody has to be asked before it is read."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from types import FunctionType, MethodType
from typing import Any

import pytest

import clearance as cl
from clearance.world.case import Case, Limits
from clearance.world.motion import Motion
from clearance.world.timeline import Timeline

SCENES = Path(__file__).parents[2] / "scenes"
GIVEN = Case, Motion, Timeline
"""What a record was made of, which other rooms answer for."""


def closures(value: Any, path: str, seen: set[int]) -> Iterator[str]:
    """Where a function is kept in a value, or in anything that it holds."""
    if id(value) in seen or isinstance(value, GIVEN):
        return
    seen.add(id(value))
    if isinstance(value, FunctionType | MethodType | partial):
        yield path
    elif isinstance(value, Mapping):
        for name, one in value.items():
            yield from closures(one, f"{path}[{name}]", seen)
    elif isinstance(value, list | tuple | set | frozenset):
        for i, one in enumerate(value):
            yield from closures(one, f"{path}[{i}]", seen)
    elif dataclasses.is_dataclass(value):
        for name, one in vars(value).items():
            yield from closures(one, f"{path}.{name}", seen)


def kinds(value: Any, seen: set[int]) -> Iterator[str]:
    """The rooms of all objects that a value holds."""
    if id(value) in seen or isinstance(value, GIVEN):
        return
    seen.add(id(value))
    held: tuple[Any, ...] = ()
    if isinstance(value, Mapping):
        held = tuple(value.values())
    elif isinstance(value, list | tuple | set | frozenset):
        held = tuple(value)
    elif dataclasses.is_dataclass(value):
        yield type(value).__module__
        held = tuple(vars(value).values())
    for one in held:
        yield from kinds(one, seen)


@pytest.fixture(scope="module")
def run() -> cl.Run:
    return cl.check(SCENES / "box_box" / "case.yaml", limits=Limits(0.04, 0.06))


def test_no_function_is_kept_in_a_record(run):
    assert [*closures(run.record, "record", set())] == []


def test_a_record_holds_no_object_of_a_room_that_measures(run):
    rooms = {kind.split(".")[1] for kind in kinds(run.record, set())}
    assert "record" in rooms and not rooms & {"simulate", "run", "budget", "kernels"}


def test_the_session_holds_what_the_record_does_not(run):
    """So that the two tests above would see it."""
    assert [*closures(run.session.rules, "rules", set())] != []
    rooms = {kind.split(".")[1] for kind in kinds(run.session.rules, set())}
    assert "simulate" in rooms


def test_reading_a_record_and_its_verdict_measures_nothing_more(run, monkeypatch):
    """All that moments, pairs and stretches are measured with is out of order."""
    from clearance.findings.verdict import verdict_of
    from clearance.query.pair_query import Query

    def refuse(*given, **options):
        raise AssertionError("a record is read, nothing is measured")

    monkeypatch.setattr(Query, "distances", refuse)
    monkeypatch.setattr("clearance.simulate.measure.moment_query.distance", refuse)
    monkeypatch.setattr("clearance.simulate.measure.measure.sweep", refuse)
    monkeypatch.setattr("clearance.simulate.measure.certify.certify", refuse)
    record = run.record
    assert verdict_of(record).status == "violated"
    assert record.worst.clearance < 0.04 and record.nearest is record.worst
    assert record.certificate.worst is not None and record.steps.num_rows == 301
