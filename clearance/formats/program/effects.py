"""What statements may do, whether they are run or not: move the robot, leave a routine, give variables values.

Values that a controller keeps between runs (PERS of RAPID, data lists of KRL) are followed here too.

Not for: running them (`execution`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from typing import Any

from clearance.errors import BadProgram, nearest_name
from clearance.formats.program.culprits import Culprit, way_past
from clearance.formats.program.expressions import (
    Call,
    Expression,
    Unknown,
    calls_in,
    names_in,
    number,
)
from clearance.formats.program.language import Language
from clearance.formats.program.remarks import UNSAID, WAITS
from clearance.formats.program.statements import (
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
    expressions_of,
    within,
)
from clearance.formats.program.tokens import Line
from clearance.formats.text.notes import counted
from clearance.world.notice import listed

KEPT = "{} decides, which the controller keeps between runs"
"""The doubt on a branch or a loop that a value decides."""


@dataclass(frozen=True, eq=False)
class Effects:
    """What the statements of a program may do.

    Attributes:
        skip: words that are left out.
    """

    language: Language
    routines: Mapping[str, Routine]
    skip: frozenset[str]

    def deciding(
        self, body: tuple[Statement, ...], entered: tuple[str, ...] = ()
    ) -> Iterator[Culprit]:
        """What in a body moves the robot, leaves the body, or may do so."""
        for one, around in self._reached([body], entered):
            leaves = isinstance(one, Leave) and one.what != STOP and not around
            if leaves or (isinstance(one, Unreadable) and not self.leaves_out(one)):
                yield Culprit(f"{one.word} at {one.line}")  # type: ignore[union-attr]
            for call in _calls_of(one):
                if culprit := self._culprit(call, one.line, around):
                    yield culprit

    def _culprit(self, call: Call, line: Line, entered: tuple[str, ...]) -> Culprit | None:
        """An instruction that may move the robot, by what it has run beside the program too; None if not, and of
        what a file has or is left out."""
        if call.name in self.routines or call.name in self.skip:
            return None
        text = f"{call.name} at {line}"
        if name := self.language.beside(call):
            found = None if name in entered else self.culprit_in(name, entered)
            return None if found is None else found._replace(text=text)
        moves = self.language.moves(call.name)
        if moves is False or self.language.initialises(call):
            return None
        return Culprit(text, "" if moves else call.name)

    def leaves_out(self, one: Unreadable) -> bool:
        """True if a statement is left out as asked; one that decides which lines run never is."""
        return one.word in self.skip and not one.jumps

    def moving(self, body: tuple[Statement, ...], entered: tuple[str, ...] = ()) -> Iterator[Call]:
        """The calls in a body that move the robot or change how it moves, or may do so."""
        for one, around in self._reached([body], entered):
            yield from (call for call in _calls_of(one) if self._culprit(call, call.line, around))

    def timing(self, bodies: Iterable[tuple[Statement, ...]]) -> Iterator[tuple[str, str]]:
        """A remark, and where, on what in bodies takes a time, is left out whatever it takes, or sets speeds."""
        for one, _ in self._reached(bodies):
            if isinstance(one, While):
                yield WAITS, f"{one.word} ({one.line})"
            for call in _calls_of(one):
                if call.name in self.skip or self.language.waits(call):
                    yield WAITS, f"{call.name} ({call.line})"
                elif call.name in self.language.retiming:
                    yield UNSAID, f"{call.name} ({call.line})"

    def _reached(
        self,
        bodies: Iterable[tuple[Statement, ...]],
        entered: tuple[str, ...] = (),
        *,
        left_out: bool = False,
    ) -> Iterator[tuple[Statement, tuple[str, ...]]]:
        """The statements that bodies may run, with the names of the routines around them.

        Args:
            left_out: also those of routines that are left out.
        """
        for one in (one for body in bodies for one in within(body)):
            yield one, entered
            for name in (call.name for call in _calls_of(one)):
                may_run = name not in entered and (left_out or name not in self.skip)
                if may_run and name in self.routines:
                    inner, around = self.routines[name].body, (*entered, name)
                    yield from self._reached([inner], around, left_out=left_out)

    def beside_in(self, bodies: Iterable[tuple[Statement, ...]]) -> Iterator[tuple[str, str]]:
        """What in bodies has a routine run beside the program, and that one's name; in what is left out too."""
        for one, _ in self._reached(bodies, left_out=True):
            for call in _calls_of(one):
                if other := self.language.beside(call):
                    yield call.name, other

    def require_left_out(self) -> None:
        """Nothing, if what is left out moves nothing.

        Raises:
            BadProgram: it does.
        """
        for name in self.skip:
            if (culprit := self.moving_in(name)) is not None:
                fault = f"{name} moves the robot, or changes how it moves{culprit}"
                raise BadProgram(fault, where="skip", valid="skip only what moves nothing")

    def moving_in(self, name: str) -> str | None:
        """Where an instruction or a routine moves the robot; None where it does not, or nobody knows."""
        if name not in self.routines:
            return "" if self.language.moves(name) else None
        calls = self.moving(self.routines[name].body, (name,))
        found = (f": {one.name} at {one.line}" for one in calls if self.language.moves(one.name))
        return next(found, None)

    def doubts_on_handlers(self, routine: Routine) -> dict[str, None]:
        """A line on each handler of a routine that moves the robot: it is not run."""
        found = dict[str, None]()
        for word, body in routine.handlers:
            text = f"the {word} handler of {routine.name} does not run: its moves are not measured"
            found |= {f"{call.line}: {text}": None for call in islice(self.moving(body), 1)}
        return found

    def culprit_in(self, name: str, entered: tuple[str, ...] = ()) -> Culprit | None:
        """What in a routine that runs beside the program moves the robot, or may; None if nothing does."""
        body = self.routines[name].body if name in self.routines else ()
        if name in self.skip:  # what it calls was asked before
            jumps = (one for one in within(body) if isinstance(one, Unreadable) and one.jumps)
            return next((Culprit(f"{one.word} at {one.line}") for one in jumps), None)
        found = next(self.deciding(body, (*entered, name)), None)
        if name in self.routines or name in self.language.packages:
            return found
        return Culprit("it is in no file that is given", name)

    def require_still(self, what: str, name: str) -> None:
        """Nothing, if nothing in a routine that runs beside the program moves the robot.

        Raises:
            BadProgram: something does, or may.
        """
        culprit = self.culprit_in(name)
        if culprit is not None:
            fault = f"{what} {name!r} moves the robot, or may: {culprit}"
            valid = way_past([culprit], self.language.suffix) or "call one that moves nothing"
            raise BadProgram(fault, valid=valid)

    def doubts_on_packages(self, bodies: Iterable[tuple[Statement, ...]]) -> Iterator[str]:
        """A line on packages that are in no file and that bodies call, if there are any."""
        calls = (call for body in bodies for one in within(body) for call in _calls_of(one))
        packages, first = (
            {*self.language.packages} - {*self.routines} - self.skip,
            dict[str, Line](),
        )
        for name, line in ((self.language.beside(call) or call.name, call.line) for call in calls):
            if name in packages:
                first.setdefault(name, line)
        if found := [f"{name} ({line})" for name, line in first.items()]:
            text = "packages that are in no file are taken to move nothing, and to set neither tool nor"
            yield f"{text} base: {listed(found, 6)}"

    def doubts_on_stops(self, what: str, name: str) -> dict[str, None]:
        """A line on what in a routine that runs beside the program stops the robot on its way."""
        stops = (call for call in self.calls_of(name) if call.name in self.language.stopping)
        text = f"of {what} {name} may stop the robot: it is taken to go on along its way"
        return {f"{call.name} ({call.line}) {text}": None for call in islice(stops, 1)}

    def calls_of(self, name: str) -> Iterator[Call]:
        """The calls in a routine, and in those that it calls."""
        body = self.routines[name].body if name in self.routines else ()
        return (call for one, _ in self._reached([body], (name,)) for call in _calls_of(one))

    def read_by(self, parts: Iterable[Expression]) -> Iterator[str]:
        """The variables that expressions may read, in routines that they call too."""
        whole = Do(Line(0), Call("", tuple(parts), {}, Line(0)))
        for one, _ in self._reached([(whole,)], left_out=True):
            for part in expressions_of(one):
                yield from names_in(part)

    def changed_concurrently(self, what: str, name: str) -> dict[str, Unknown]:
        """The variables that a routine which runs beside the program may change at any time."""
        changed = self.changed_by(self.routines[name], (name,)) if name in self.routines else ()
        why = f"{what} {name!r} may change it at any time"
        return {one: Unknown(f"{why}: {one!r} at {at}") for one, at in changed}

    def changed_in(
        self, bodies: Iterable[tuple[Statement, ...]], entered: tuple[str, ...] = ()
    ) -> Iterator[tuple[str, Line]]:
        """The variables that bodies may give a value, and where; of routines those that they do not have alone."""
        for one in (one for body in bodies for one in within(body)):
            targets = [one.target] if isinstance(one, Assign) else []
            if isinstance(one, For) and not one.is_own:
                targets.append(one.name)
            for call in _calls_of(one):
                if call.name not in self.routines:
                    targets += self.language.writes(call)
                elif call.name not in entered:
                    targets += given_back(self.routines[call.name], call)
                    yield from self.changed_by(self.routines[call.name], (*entered, call.name))
                other = self.language.beside(call)
                if other in self.routines and other not in entered:
                    yield from self.changed_by(self.routines[other], (*entered, other))
            for name in (assigned(target) for target in targets):
                if name is not None:
                    yield name.name, one.line

    @cached_property
    def used_by_moves(self) -> set[str]:
        """The variables that moves and calls of routines are given, and those that these are worked out from."""
        every = [one for routine in self.routines.values() for one in within(routine.body)]
        calls = [one.call for one in every if isinstance(one, Do)]
        moves = [one for one in calls if one.name in self.routines or self.language.moves(one.name)]
        given = [(assigned(one.target), one.value) for one in every if isinstance(one, Assign)]
        found, parts = set[str](), list[Expression](moves)
        while more := {name for part in parts for name in names_in(part)} - found:
            found |= more
            parts = [value for target, value in given if target and target.name in more]
        return found

    def changed_by(
        self, routine: Routine, entered: tuple[str, ...] = ()
    ) -> Iterator[tuple[str, Line]]:
        """The variables that a routine may change and does not have alone, and where."""
        declared = (one for one in within(routine.body) if isinstance(one, Assign) and one.is_own)
        names = (assigned(one.target) for one in declared)
        own = {*routine.parameters, *(one.name for one in names if one is not None)}
        changed = self.changed_in([routine.body], entered)
        return ((name, line) for name, line in changed if name not in own)


@dataclass(eq=False)
class PersistentValues:
    """Which variables of a run rest on values that may be others: the controller keeps them, or the case has them.

    Attributes:
        frames: the run's variables of the whole program, then of each routine that is entered.
        origins: for each of these, by variable, what decides with it, as `KEPT`.
    """

    effects: Effects
    frames: list[dict[str, Any]]
    origins: list[dict[str, str]] = field(default_factory=lambda: [{}])

    def origin_of(self, parts: Iterable[Expression]) -> str:
        """What decides with values that expressions rest on; empty where none is."""
        for name in self.effects.read_by(parts) if any(self.origins) else ():
            origins = self.origins[-1 if name in self.frames[-1] else 0]
            if name in origins:
                return origins[name]
        return ""

    def put(self, name: str, origin: str, place: dict[str, Any], is_part: bool = False) -> None:
        """Keeps what a variable rests on that is given a value, or a part of one."""
        origins = self.origins[0 if place is self.frames[0] else -1]
        if origin:
            origins[name] = origin
        elif not is_part:
            origins.pop(name, None)

    def doubts_on(self, one: If | While | For, origin: str) -> dict[str, None]:
        """A line on a branch or a loop that a kept value decided, if the robot moves in it, or by what it changes;
        variables that it changes rest on the value too.
        """
        bodies = [body for _, body in one.branches] if isinstance(one, If) else [one.body]
        changed = {name for name, _ in self.effects.changed_in(bodies)}
        for name in changed:
            self.origins[-1 if name in self.frames[-1] else 0][name] = origin
        other = "the way not taken is" if isinstance(one, If) else "other numbers of passes are"
        text = f"{one.line}: {other} not measured; {origin}"
        moves = any(True for body in bodies for _ in self.effects.deciding(body))
        return {text: None} if moves or changed & self.effects.used_by_moves else {}


def arguments_of(call: Call, names: Sequence[str]) -> dict[str, Expression]:
    """The arguments of a call by name, of those that it may have.

    Raises:
        BadProgram: more than these, or others.
    """
    if len(call.args) > len(names):
        fault = f"{call.name} is given {counted(len(call.args), 'argument')}"
        raise BadProgram(fault, valid=f"{len(names)} at most")
    for name in call.named:
        if name not in names:
            raise BadProgram(f"{call.name} has no {name!r}", valid=nearest_name(name, names))
    return {**dict(zip(names, call.args, strict=False)), **call.named}


def range_of(one: For, value_of: Callable[[Expression], Any]) -> tuple[float, float, float]:
    """The first value of a loop's counter, the last one, and the step.

    Raises:
        BadProgram: one is no known number, or the step is 0.
    """
    name = one.name.name
    first, last = (
        number(value_of(part), f"the range of {name!r}") for part in (one.first, one.last)
    )
    step = -1.0 if one.turns_back and last < first else 1.0
    if one.step is not None:
        step = number(value_of(one.step), f"the step of {name!r}")
    if step == 0.0:
        raise BadProgram("a step of 0", valid="another")
    return first, last, step


def value_after(one: For, before: float, value: Any, is_free: bool) -> float:
    """The counter of a loop at the end of a pass that began with a value of it.

    Args:
        is_free: the loop goes on from whatever value a pass gives it.

    Raises:
        BadProgram: the pass may have changed it, and how the loop goes on then is not known.
    """
    now = number(value, f"the counter {one.name.name!r}")
    if now != before and not is_free:
        fault = f"{one.name.name!r} counts the passes of a loop, and one of them changes it"
        raise BadProgram(fault, valid="another variable in it")
    return now


def given_back(routine: Routine, call: Call) -> list[Expression]:
    """The arguments of a call that are the caller's own variables, which the routine may change."""
    given = {**dict(zip(routine.parameters, call.args, strict=False)), **call.named}
    return [
        given[name] for name in routine.parameters if name in routine.returned and name in given
    ]


def _calls_of(one: Statement) -> Iterator[Call]:
    """The calls that a statement itself makes."""
    for part in expressions_of(one):
        yield from calls_in(part)


def unreadable_word(one: Unreadable, may_be_left_out: bool) -> BadProgram:
    """The error for a statement that may do anything."""
    does = "decides which lines run" if one.jumps else "may decide where the robot goes"
    valid = "take it out of the program"
    if one.jumps:
        valid = "a copy of the program that has only the lines that run"
    elif may_be_left_out:
        valid = f"{valid}, or write skip: [{one.word}] if it does not"
    return BadProgram(f"{one.word!r} is not understood, and {does}", valid=valid)


def undecided(one: While, culprit: Culprit | None, value: Unknown) -> BadProgram:
    """The error for a loop whose condition only the controller knows."""
    fault, valid = f"{one.word} decides on {culprit}, and", value.valid("let the file decide it")
    if culprit is None:
        fault, valid = f"{one.word} waits for what", f"{valid}, or skip: [{one.word}]"
    return BadProgram(f"{fault} is not known: {value.why}", valid=valid)
