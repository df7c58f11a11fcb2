"""What the words of a controller's language do, as a run asks for it, and what all languages have in common.

Not for: running a program (`execution`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

from clearance.errors import BadProgram, MissingKey, nearest_name
from clearance.formats.program.controller_program import ControllerProgram, ControllerWait
from clearance.formats.program.expressions import Call, Expression, Unknown, applied, number


class Language:
    """What the words of a language do. Each language says what differs from one that knows no words.

    Attributes:
        maker: the preset of `axes_as` that it has. base: as of a `ControllerProgram`.
        suffix: of the file that has a called program by its name; empty where its name says nothing of the file.
        moving, still: words that decide where the robot goes, and those that do not.
        timed: words that take a time that counts; their file may not say how long.
        retiming: words that change how long moves take also from a thread, a trap or an interrupt.
        stopping: words that stop the robot on its way; it goes on along it.
        signals: words that set an output or a flag: their arguments are which, and the value.
        packages: routines of the maker; where no file has one, it moves nothing that is called beside a program.
        keeps_counter: a loop counts by the value of its variable, and leaves it at the last one; elsewhere it is
            not known behind the loop.
        shares_variables: a routine has none of its own, but for its parameters.
        skips_overlaps: as of a `ControllerProgram`.
        values: functions whose value follows from their arguments.
    """

    maker, base, suffix = "plain", "", ""
    moving: Collection[str] = ()
    still: Collection[str] = ()
    timed: Collection[str] = ()
    retiming: Collection[str] = ()
    stopping: Collection[str] = ()
    signals: Collection[str] = ()
    packages: Collection[str] = ()
    keeps_counter = shares_variables = skips_overlaps = False
    values: Mapping[str, Callable[..., Any]] = {}

    @property
    def state(self) -> Any:
        """What settings are in force: a loop repeats itself where it is the same."""
        return None

    def moves(self, name: str) -> bool | None:
        """Whether an instruction or a function can move the robot; None where it is not known."""
        if name in self.moving:
            return True
        return False if name in self.still else None

    def initialises(self, call: Call) -> bool:
        """Whether a call of a package initialises it, and so moves nothing."""
        return False

    def waits(self, call: Call) -> bool:
        """Whether an instruction or a function takes a time that counts."""
        return call.name in self.timed

    def beside(self, call: Call) -> str:
        """The routine that an instruction has run beside the program from then on; empty where it has none."""
        return ""

    def writes(self, call: Call) -> Iterable[Expression]:
        """The arguments of an instruction or a function that it gives a value."""
        return call.args[:1] if call.name in self.signals else ()

    def instruct(self, call: Call, run: Any) -> None:
        """Does what an instruction does: a move, a setting, or a wait.

        Raises:
            BadInput: a move that is not read.
        """
        run.pass_over(call)

    def wait(self, call: Call, run: Any, reads_on: bool = True) -> None:
        """Waits for the time that the first argument says [s]."""
        seconds = number(run.evaluated(call.args[0]), "the time") if call.args else 0.0
        if seconds > 0.0:
            run.add(ControllerWait(call.line, seconds, reads_on))

    def result_of(self, call: Call, run: Any) -> Any:
        """The value of a function of the language; `Unknown` where only the controller knows it."""
        args = [run.evaluated(one) for one in call.args]
        named = {name: run.evaluated(one) for name, one in call.named.items()}
        if call.name in self.values:

            def act(*given: Any) -> Any:
                more = zip(named, given[len(args) :], strict=True)
                return self.values[call.name](*given[: len(args)], **dict(more))

            return applied(act, (*args, *named.values()), call.line, call.name)
        run.forget_written(call)
        unknown = (one for one in (*args, *named.values()) if isinstance(one, Unknown))
        return next(unknown, Unknown(f"{call.name}() at {call.line}"))

    def value_of(self, name: str, run: Any) -> Any:
        """The value of a name that the language itself knows; None where it knows none."""
        return None

    def remedy(self, name: str) -> str:
        """How a case gives a variable that no file has, as of an `Unknown`; empty where it cannot."""
        return ""

    def items(self, values: list[Any], kind: str) -> Any:
        """Values in brackets."""
        return values

    def part_of(self, value: Any, by: Any) -> Any:
        """A part of a value."""
        raise TypeError

    def with_part(self, value: Any, by: Any, new: Any) -> None:
        """Changes a part of a value."""
        raise TypeError

    def program_of(
        self, run: Any, notes: Iterable[str] = (), doubts: Iterable[str] = ()
    ) -> ControllerProgram:
        """The program that a run has made, with further notes and doubts.

        Raises:
            MissingKey: it uses values by name that no file has; with all of them.
        """
        run.require_all()
        return ControllerProgram(
            tuple(run.moves),
            (*run.notes, *notes),
            self.base,
            (*run.doubts, *doubts),
            self.maker,
            run.left_out,
            self.skips_overlaps,
        )


def entry_of(what: str, names: Sequence[str], asked: str | None, folded: str, usual: str) -> str:
    """The routine that runs: the one that is asked for, else the usual one, else the only one.

    Args:
        what: it is called. folded: the name that is asked for, as names are compared.

    Raises:
        BadProgram: there is none of the name, or none at all. MissingKey: several could be it.
    """
    if asked is not None and folded not in names:
        valid = nearest_name(asked, names)
        raise BadProgram(f"there is no {what} {asked!r}", where="entry", valid=valid)
    found = folded if asked is not None else usual
    if found in names or len(names) == 1:
        return found if found in names else names[0]
    if not names:
        raise BadProgram(f"no {what} that runs by itself is in it", valid="a whole program")
    fault = f"several {what}s are there: {', '.join(map(str, names))}"
    raise MissingKey(fault, where="entry", valid="the one that is the program")
