"""Runs a controller's program as far as its file decides it: what is left are moves, one after another.

Loops are unrolled and calls are followed. A condition, a loop or a target that only the controller knows is
refused with its line; what moves nothing may be left out. Not for: what instructions do (each language).
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from clearance.errors import BadProgram, ClearanceError
from clearance.formats.program.controller_program import ControllerMove, ControllerWait, end_of
from clearance.formats.program.culprits import undecided_branch, unknown_word
from clearance.formats.program.effects import (
    Effects,
    PersistentValues,
    arguments_of,
    range_of,
    undecided,
    unreadable_word,
    value_after,
)
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    Name,
    Part,
    Unknown,
    calls_in,
    is_constant,
    value_of,
    with_passed,
)
from clearance.formats.program.passes import MOST_PASSES, Jumps, Passes, without_jump
from clearance.formats.program.remarks import LEFT_OUT, STILL, UNSAID, WAITS
from clearance.formats.program.statements import (
    BREAK,
    CONTINUE,
    RETURN,
    STOP,
    Assign,
    Do,
    For,
    If,
    Leave,
    Routine,
    Statement,
    Unreadable,
    While,
    assigned,
)
from clearance.formats.program.tokens import on
from clearance.formats.program.variables import Variables

MOST_STATEMENTS = 500_000
"""Statements that a program runs; more are a loop that does not end."""

MOST_MOVES = 20_000

MOST_CALLS = 40
"""Routines within routines."""


@dataclass(eq=False)
class Execution(Variables):
    """A program that runs.

    Attributes:
        routines: by name. skip: names of instructions, functions and words of loops to leave out.
        moves: made so far.
    """

    routines: Mapping[str, Routine]
    skip: frozenset[str]
    moves: list[ControllerMove | ControllerWait] = field(default_factory=list)
    _n_run: int = 0

    @cached_property
    def effects(self) -> Effects:
        """What statements may do."""
        return Effects(self.language, self.routines, self.skip)

    @cached_property
    def persistent(self) -> PersistentValues:
        """What rests on values that the controller keeps between runs."""
        return PersistentValues(self.effects, self.frames)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.effects.require_left_out()

    def pass_over(self, call: Call) -> None:
        """Keeps that an instruction was passed over since it moves nothing; routines within it run, and an output
        that the case gives takes its value.
        """
        self.note(WAITS if self.language.waits(call) else STILL, f"{call.name} ({call.line})")
        for target in self.language.writes(call):
            if isinstance(target, Name) and target.name in self.given:
                self.variables[target.name] = self.evaluated(call.args[1])
                return
        for part in (*call.args, *call.named.values()):
            if any(one.name in self.routines for one in calls_in(part)):
                self.evaluated(part)

    def run_concurrently(self, what: str, name: str) -> None:
        """Keeps that a routine runs beside the program: it moves nothing, and what it changes is not known."""
        self.effects.require_still(what, name)
        self.doubts |= self.effects.doubts_on_stops(what, name)
        if name in self.skip:
            self.note(LEFT_OUT, f"{name} ({self.line})")
        self.concurrent |= self.effects.changed_concurrently(what, name)
        for call in self.effects.calls_of(name):
            if call.name in self.language.retiming:
                why = WAITS if self.language.waits(call) else UNSAID
                self.note(why, f"{call.name} ({call.line}) in {what} {name}")

    def add(self, move: ControllerMove | ControllerWait) -> None:
        """A move that the robot makes.

        Raises:
            BadInput: too many.
        """
        self.moves.append(move)
        if len(self.moves) > MOST_MOVES:
            raise BadProgram(f"more than {MOST_MOVES:,} moves", valid="check it in parts")

    def run(self, body: Iterable[Statement]) -> Leave | None:
        """Runs statements, and what they were left by."""
        jumps, at = Jumps(tuple(body), self), 0
        while at < len(jumps.body):
            one = jumps.body[at]
            self.line = one.line
            try:
                with on(one.line):
                    self._count()
                    left, at = jumps.followed(self._step(one), at + 1)
            except ClearanceError:
                self.require_all()
                raise
            if left is not None:
                return left
        return None

    def run_whole(self, body: Iterable[Statement]) -> Leave | None:
        """As `run`, of all statements of a routine, which no jump may leave."""
        return without_jump(self.run(body), self)

    def _count(self) -> None:
        self._n_run += 1
        if self._n_run > MOST_STATEMENTS:
            fault = f"more than {MOST_STATEMENTS:,} statements are run"
            raise BadProgram(fault, valid="make the loop end")

    def _step(self, one: Statement) -> Leave | None:
        match one:
            case Assign():
                self._assign(one)
            case Do():
                return self._called(one.call, False)[1]
            case If():
                return self._branch(one)
            case While():
                return self._while(one)
            case For():
                return self._for(one)
            case Leave():
                return one
            case Unreadable():
                if not self.effects.leaves_out(one):
                    raise unreadable_word(one, self.effects.moving_in(one.word) is None)
                self.note(LEFT_OUT, f"{one.word} ({one.line})")
                self.forget([(one.word, one.line)])
        return None

    def evaluated(self, one: Expression) -> Any:
        """The value of an expression, which nothing else changes."""
        return copy.deepcopy(value_of(one, self))

    def next_of(self, name: Name, value: Expression) -> Any:
        """The value that a variable is given; what it reads of itself, as a counter does, decides nothing else."""
        self._next = "" if any(calls_in(value)) else name.name
        found, self._next = self.evaluated(value), ""
        return found

    def result_of(self, call: Call) -> Any:
        """The value of a function: one of the program, or of the language.

        Raises:
            BadInput: none of them, which may move the robot.
        """
        return self._called(call, True)[0]

    def _called(self, call: Call, has_value: bool) -> tuple[Any, Leave | None]:
        """The value of a call, if it has one, and the end of the program if it comes in it."""
        call = with_passed(call, self.frames[-1])
        if call.name in self.skip:
            self._leave_out(call)
            return Unknown(f"{call.name} ({call.line}) is left out"), None
        if call.name in self.routines:
            return self.enter(self.routines[call.name], call)
        moves = self.language.moves(call.name)
        if (moves is None and not self.language.initialises(call)) or (moves and has_value):
            raise unknown_word(call.name, self.language.suffix, moves)
        if has_value and self.language.waits(call):
            self.note(WAITS, f"{call.name} ({call.line})")
        act: Callable[..., Any] = self.language.result_of if has_value else self.language.instruct
        try:
            return act(call, self), None
        except ClearanceError:
            raise
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            fault = f"{call.name} is given data of another kind"
            raise BadProgram(fault, valid="arguments as in its manual") from None

    def _assign(self, one: Assign) -> None:
        name = assigned(one.target)
        if name is None:
            raise BadProgram("no variable is given", valid="a variable")
        value, origin = self.next_of(name, one.value), self.persistent.origin_of([one.value])
        is_name = isinstance(one.target, Name)
        place = self.variables if one.is_of_all else self.place(name.name, one.is_own)
        self.persistent.put(name.name, origin, place, not is_name)
        if is_name:
            place[name.name] = value
            return
        assert isinstance(one.target, Part)
        whole = value_of(one.target.of, self)
        by = one.target.by if isinstance(one.target.by, str) else value_of(one.target.by, self)
        if isinstance(whole, Unknown):
            return  # it stays so, and why
        if isinstance(by, Unknown):
            self.forget([(name.name, one.line)])
            return
        try:
            self.language.with_part(whole, by, value)
        except (LookupError, TypeError, ValueError):
            raise BadProgram(f"there is no part {by!r:.40}") from None

    def forget_written(self, call: Call) -> None:
        """Makes variables unknown that an instruction or a function of the language gives a value."""
        for one in filter(None, map(assigned, self.language.writes(call))):
            self.forget([(one.name, call.line)], f" by {call.name}")

    def _forget_changed(
        self, bodies: Sequence[tuple[Statement, ...]], by: str = "", remedy: str = ""
    ) -> None:
        """Makes variables unknown that bodies may have changed, or have changed at any time from then on."""
        self.forget(self.effects.changed_in(bodies), by, remedy)
        for what, name in self.effects.beside_in(bodies):
            self.run_concurrently(what, name)

    def _leave_out(self, call: Call) -> None:
        """Keeps that a call is left out, and makes variables unknown that it may have changed."""
        self.note(LEFT_OUT, f"{call.name} ({call.line})")
        self._forget_changed([(Do(call.line, call),)], f" by {call.name}")

    def enter(self, routine: Routine, call: Call | None = None) -> tuple[Any, Leave | None]:
        """As `_called`, of a routine; without a call, of one that takes no arguments.

        Raises:
            BadInput: other arguments than it has; too many routines in one another.
        """
        if len(self.frames) > MOST_CALLS:
            raise BadProgram(f"more than {MOST_CALLS} routines call one another", valid="end them")
        call = call or Call(routine.name, (), {}, routine.line)
        given = {**routine.defaults, **arguments_of(call, routine.parameters)}
        self.doubts |= self.effects.doubts_on_handlers(routine)
        frame = {name: self.evaluated(value) for name, value in given.items()}
        origins = {name: self.persistent.origin_of([one]) for name, one in given.items()}
        self.persistent.origins.append(origins)
        self.frames.append(frame)
        left = self.run_whole(routine.body)
        value = None
        if left is not None and left.what == RETURN and left.value is not None:
            value = self.evaluated(left.value)
        self.frames.pop()
        self.persistent.origins.pop()
        for name in routine.returned & given.keys():
            if (target := assigned(given[name])) is not None:
                value_back = self.given_back(target.name, frame[name], call)
                self._assign(Assign(call.line, given[name], Constant(value_back)))
                place = self.place(target.name)
                self.persistent.put(target.name, origins.get(name, ""), place, True)
        return value, left if left is not None and left.what == STOP else None

    def _branch(self, one: If) -> Leave | None:
        asked, way = list[Expression](), tuple[Statement, ...]()
        for condition, body in one.branches:
            value = True
            if condition is not None:
                asked.append(condition)
                value = value_of(condition, self)
            if isinstance(value, Unknown):
                self._pass_branches(one, value)
                return None
            if value:
                way = body
                break
        origin, left = self.persistent.origin_of(asked), self.run(way)
        self._doubt(one, origin)
        return left

    def _doubt(self, one: If | While | For, origin: str) -> None:
        """Keeps what rests on the value that decided a branch or a loop, if the controller keeps it."""
        if origin:
            self.doubts |= self.persistent.doubts_on(one, origin)

    def _pass_branches(self, one: If, why: Unknown) -> None:
        """Nothing but that variables are not known any more, where no branch moves the robot.

        Raises:
            BadInput: one does.
        """
        bodies = [body for _, body in one.branches]
        if culprits := [found for body in bodies for found in self.effects.deciding(body)]:
            raise undecided_branch(one, culprits, why, self.language.suffix)
        self.note("conditions that only the controller knows, without moves", f"{one.line}")
        for remark in self.effects.timing(bodies):
            self.note(*remark)
        self._forget_changed(bodies, remedy=why.remedy)

    def _while(self, one: While) -> Leave | None:
        n_passes, passes = 0, Passes("an endless loop", MOST_PASSES)
        endless = is_constant(one.condition)
        while (one.at_end and not n_passes) or self._goes_on(one):
            if endless and n_passes and (end := passes.end(one, one.body, self)):
                return end
            self._count()
            left = self.run(one.body)
            n_passes += 1
            if left is not None and left.what != CONTINUE:
                return None if left.what == BREAK else left
        return None

    def _goes_on(self, one: While) -> bool:
        """Whether a loop has a further pass.

        Raises:
            BadInput: only the controller knows, and it moves the robot or is not to be left out.
        """
        value = value_of(one.condition, self)
        origin = self.persistent.origin_of([one.condition])
        others_end = value is False and one.at_end and not one.body and origin
        if others_end:
            value = Unknown("it does not come true before others change it")
        if not isinstance(value, Unknown):
            self._doubt(one, origin)
            return bool(value) != one.at_end
        culprit = next(self.effects.deciding(one.body), None)
        if culprit is not None or one.word not in self.skip:
            raise undecided(one, culprit, value)
        self.note(LEFT_OUT, f"{one.word} ({one.line})")
        self._forget_changed([one.body])
        if others_end:
            self._come_true(one)
        return False

    def _come_true(self, one: While) -> None:
        """Gives what a wait waits for its other value, if it is one that is on or off; else it is not known."""
        names = [*dict.fromkeys(self.effects.read_by([one.condition]))]
        on_off = [[one] for one in self.given if isinstance(self.variables[one], bool)]
        for value in (True, False) if names in on_off else ():
            self.variables[names[0]] = value
            if value_of(one.condition, self) is True:
                return
        self.forget(((name, one.line) for name in names), f" by what {one.word} waits for")

    def _for(self, one: For) -> Leave | None:
        name = one.name.name
        at, last, step = range_of(one, self.evaluated)
        origin = self.persistent.origin_of(filter(None, (one.first, one.last, one.step)))
        place = self.frames[-1] if one.is_own else self.place(name)
        before = {key: place[key] for key in (name,) if key in place}
        left, place[name] = None, at
        while left is None and (at <= last if step > 0.0 else at >= last):
            self._count()
            place[name] = at
            left = self.run(one.body)
            left = None if left is not None and left.what == CONTINUE else left
            if left is None:
                now = place[name] if one.is_own else self.concurrent.get(name, place[name])
                at = value_after(one, at, now, self.language.keeps_counter) + step
        if left is None and not self.language.keeps_counter:
            place[name] = Unknown(f"{name!r} counted the loop at {one.line}")
        self._doubt(one, origin)
        if one.is_own:
            place.pop(name, None)
            place |= before
        return None if left is not None and left.what == BREAK else left

    def state(self) -> tuple[Any, ...]:
        """What decides how the program goes on: variables that lines read for more than their own next value,
        settings, and where the robot is.
        """
        return (*self.read_ones(), copy.deepcopy(self.language.state), end_of(self.moves))
