"""The schema of where joints rest: positions by name, and states of an SRDF by `state`. Not for: reading these."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import ValidatorFunctionWrapHandler, WrapValidator

from clearance.errors import BadInput
from clearance.world.names import checked_name

STATE = "state"
"""The key of the names of states; a joint may be called so too, and then has a number."""


class RestingJoints(dict[str, float]):
    """Positions by joint [rad] or [m].

    Attributes:
        states: of an SRDF, which give the positions of others.
    """

    def __init__(self, positions: dict[str, float], states: Iterable[str] = ()) -> None:
        super().__init__(positions)
        self.states = tuple(states)


def states_of(joints: dict[str, float]) -> tuple[str, ...]:
    """The states that a case file names among its joints."""
    return joints.states if isinstance(joints, RestingJoints) else ()


def _with_states(data: Any, positions: ValidatorFunctionWrapHandler) -> RestingJoints:
    given = data.get(STATE) if isinstance(data, dict) else None
    if not isinstance(given, str | list):
        return RestingJoints(positions(data))
    names = [given] if isinstance(given, str) else given
    if not names or not all(isinstance(name, str) and name for name in names):
        raise BadInput(f"{given!r:.60} is given", where=STATE, valid="names of states")
    others = {name: value for name, value in data.items() if name != STATE}
    return RestingJoints(positions(others), map(checked_name, names))


Joints = Annotated[dict[str, float], WrapValidator(_with_states)]
