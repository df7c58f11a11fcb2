"""What `clearance new` is given, as keys of a case, and its options in place of keys in errors.

Not for: the command (`new`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click

_OPTION_OF_KEY = {
    "robot.urdf": "--robot",
    "robot.srdf": "--srdf",
    "robot.joint_limits": "--joint-limits",
    "robot.controllers": "--controllers",
    "trajectory.file": "--trajectory",
    "trajectory.program": "--program",
    "trajectory.start_state": "--start",
}
"""The options that stand for keys of a case."""

_OPTION_OF_PROGRAM = {"link": "--flange", "entry": "--entry", "skip": "--skip"}
"""Those that stand for keys of its program."""

_REMEDIES = {
    "robot.srdf: the file": "--srdf FILE",
    "robot.package_dirs": "--package-dir",
    "trajectory: {program: …, start_state: {joint: …}}": "--start JOINT=VALUE,…",
}
"""What is valid in a case file, and what the command has in its place."""

_PATTERNS = {
    re.compile(r"program: (\{.*\})"): r"--program-keys '\1'",
    re.compile(r"robot: \{xacro_args: \{(\w+): VALUE\}\}"): r"--xacro-arg \1:=VALUE",
    re.compile(r"includes: \{\"?(.*?)\"?: skip\} in the case"): r"--include \1=skip",
}
"""Keys with values of their own, as errors name them, and what the command has in their place."""


def names_in(value: str) -> list[str]:
    """Names with commas between them."""
    names = [name.strip() for name in value.split(",")]
    if not all(names):
        raise click.BadParameter(f"{value!r} has an empty name; names with commas between them")
    return names


def keys_in(value: str) -> dict[str, Any]:
    """Keys of a case file, as YAML, with their values."""
    from clearance.errors import ClearanceError
    from clearance.plain_yaml import plain_data

    try:
        found = plain_data(value.encode())
    except ClearanceError as error:
        try:  # several keys, with commas between them
            found = plain_data(f"{{{value}}}".encode())
        except ClearanceError:
            raise click.BadParameter(f"{value!r}: {error}") from None
    if not isinstance(found, dict):
        raise click.BadParameter(f"{value!r} has no keys; as in 'zones: {{CNT: 0.05}}'")
    return found


def start_in(value: str) -> dict[str, float] | str:
    """Positions by joint, or the name of a state."""
    if "=" not in value:
        return value
    pairs = [one.partition("=") for one in value.split(",")]
    try:
        return {name.strip(): float(number) for name, _, number in pairs}
    except ValueError:
        fault = f"{value!r} is given; joint_1=0.5,joint_2=0, or a state"
        raise click.BadParameter(fault) from None


@contextmanager
def naming_options() -> Iterator[None]:
    """Errors name the options of this command, in place of the keys of a case."""
    from clearance.errors import ClearanceError

    try:
        yield
    except ClearanceError as error:
        first, *places = error.where.split(": ")
        option = _OPTION_OF_KEY.get(first, first)
        if option == "--program" and places and places[-1] in _OPTION_OF_PROGRAM:
            option = _OPTION_OF_PROGRAM[places.pop()]
        error.where = ": ".join([option, *places])
        for key, remedy in _REMEDIES.items():
            error.valid = error.valid.replace(key, remedy)
            error.problem = error.problem.replace(key, remedy)
        for pattern, ours in _PATTERNS.items():
            error.valid = pattern.sub(ours, error.valid)
        raise


def given_of(keys: dict[str, Any]) -> dict[str, Any]:
    """What is given of them; several values are a list, as in a file."""
    listed = {key: [*one] if isinstance(one, tuple) else one for key, one in keys.items()}
    return {key: value for key, value in listed.items() if value not in (None, False, [], {})}


def merged(parts: list[dict[str, Any]]) -> dict[str, Any]:
    """All keys; lists and mappings of one key go together.

    Raises:
        UsageError: two values of one key.
    """
    found: dict[str, Any] = {}
    for key, value in (pair for one in parts for pair in one.items()):
        match found.get(key), value:
            case dict(old), dict(new):
                found[key] = {**old, **new}
            case list(old), list(new):
                found[key] = [*old, *new]
            case old, new if key in found and old != new:
                raise click.UsageError(f"{key} is given twice: {old} and {new}; one of them")
            case _:
                found[key] = value
    return found


def motion_of(
    table: dict[str, Any], program: dict[str, Any], states: list[str] | None
) -> dict[str, Any]:
    """The keys of the trajectory, from those of a table or of a program.

    Raises:
        UsageError: several motions, or none that a key is of.
    """
    if table and (states or "file" not in table):
        raise click.UsageError(_only_one(states, [*table]))
    if not program:
        return table
    if "file" not in program:
        option = next(iter(program)).replace("link", "flange")
        option = option if option in ("entry", "flange", "skip", "start") else "program-keys"
        raise click.UsageError(f"--{option} needs --program FILE")
    if table or states:
        raise click.UsageError("both --program and another motion; one of them")
    start = program.pop("start", None)
    return given_of({"program": program, "start_state": start})


def _only_one(states: list[str] | None, keys: list[str]) -> str:
    if "file" in keys:
        return f"both --trajectory and --states {','.join(states or ())}; one of them"
    return f"--{keys[0]} says how a trajectory is read; --trajectory FILE is missing"
