"""How an option is declared: once, as a field of a dataclass, for Python, command line, manifests and pytest.

A field made by `option` holds the sort of its values, its default and one line of help. Each door takes what was
said by name and hands it to `made`. Not for: which options there are (`run.options`, `gains.request`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from datetime import date, datetime
from functools import cache
from numbers import Real
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from clearance.errors import (
    BadDimension,
    BadInput,
    ClearanceError,
    Contradiction,
    UnknownKey,
    at,
    nearest_name,
)

List = TypeVar("List")

_KEY = "option"  # of a field's metadata


class UnknownOption(UnknownKey, TypeError):
    """An option by name that there is not."""


@dataclass(frozen=True)
class Sort:
    """A sort of values.

    Attributes:
        form: how a text of the command line gives one, as help shows it.
        valid: what would be valid, for messages.
        of_value: the value as it is used. of_text: what `of_value` takes, of a text. Both raise ValueError or
            TypeError for what is none.
        choices: all values, where they are few. suffix: of the option on the command line, its unit there.
        shown: a default, as the command line has it.
    """

    form: str
    valid: str
    of_value: Callable[[Any], Any]
    of_text: Callable[[str], Any] = str
    choices: tuple[str, ...] = ()
    suffix: str = ""
    shown: Callable[[Any], str] = str
    fault: type[BadInput] = BadInput

    def checked(self, given: object) -> Any:
        """The value that is given.

        Raises:
            BadInput: it is none.
        """
        return self._made(lambda: self.of_value(given), given)

    def read(self, text: str) -> Any:
        """The value of a text.

        Raises:
            BadInput: it is none.
        """
        unit = f" [{self.suffix}]" if self.suffix else ""
        return self._made(lambda: self.of_value(self.of_text(text)), text, unit)

    def _made(self, make: Callable[[], Any], given: object, unit: str = "") -> Any:
        try:
            return make()
        except ClearanceError:
            raise
        except (TypeError, ValueError, OverflowError):
            valid = f"{self.valid}{unit}"
            raise self.fault(f"{given!r:.60} is given", valid=valid) from None


@dataclass(frozen=True)
class Option:
    """What is known of an option beside its name.

    Attributes:
        sort: of its value, or of each of `many`. help: one line.
        flag: on the command line, without dashes; else the name, with the unit of the sort.
        off: of a switch that is on, the name of what turns it off.
        needs: another option, and its value without which this one says nothing; None for any but the default.
        of: kinds of question that the option is of; empty for all.
        said: False for what only Python can give.
    """

    default: Any
    sort: Sort
    help: str
    many: bool = False
    flag: str = ""
    off: str = ""
    needs: tuple[str, object] | None = None
    of: tuple[str, ...] = ()
    said: bool = True

    @property
    def is_of_files(self) -> bool:
        """True if the value names files."""
        return self.sort.form == "FILE"

    def checked(self, given: Any) -> Any:
        """The value that is given, as it is used.

        Raises:
            BadInput: it is none.
        """
        if not self.many:
            return self.sort.checked(given)
        if isinstance(given, str | PathLike):
            given = (given,)
        if isinstance(given, Mapping) or not isinstance(given, Collection):
            raise BadInput(f"{given!r:.60} is given", valid=f"a list; each: {self.sort.valid}")
        return tuple(map(self.sort.checked, given))


def option(default: Any, sort: Sort, help: str, **more: Any) -> Any:
    """A field of a list of options; `more` as in `Option`."""
    return field(default=default, metadata={_KEY: Option(default, sort, help, **more)})


def options_in(kind: Any) -> dict[str, Option]:
    """The options of a dataclass by name, in order."""
    return _options_in(kind)


@cache
def _options_in(kind: type) -> dict[str, Option]:
    return {one.name: one.metadata[_KEY] for one in fields(kind) if _KEY in one.metadata}


def flag_of(name: str, known: Option) -> str:
    """What the command line calls an option, without dashes."""
    return known.flag or "-".join([*name.split("_"), *filter(None, [known.sort.suffix])])


def check_values(options: Any) -> None:
    """Puts each value that is given to a list of options into the form in which it is used.

    Raises:
        BadInput: with the name of the option.
    """
    known = options_in(type(options))
    for name, one in known.items():
        given = getattr(options, name)
        if given is not one.default:
            with at(name):
                object.__setattr__(options, name, one.checked(given))
    values = {name: getattr(options, name) for name in known}
    require_needs(type(options), {n: one for n, one in values.items() if one != known[n].default})


Spelling = Callable[[str, object], str]
"""How a door spells an option and its value; with None the option alone."""


def in_python(name: str, value: object) -> str:
    """As a keyword."""
    return name if value is None else f"{name}={value!r}"


def require_needs(kind: type, said: Mapping[str, Any], spelled: Spelling = in_python) -> None:
    """Nothing, if each option that was said says something.

    Raises:
        BadInput: the first that says nothing, and what it needs.
    """
    known = options_in(kind)
    for name in said:
        needs = known[name].needs
        if needs is None:
            continue
        other, value = needs
        usual = known[other].default
        given = said.get(other, usual)
        if given != usual if value is None else given == value:
            continue
        needed = "with " if known[other].off else "without "
        needed += spelled(other, False if known[other].off else value)
        raise Contradiction(f"{spelled(name, None)} says nothing {needed}")


def made(
    kind: type[List], said: Mapping[str, Any], spelled: Spelling = in_python, /, **others: Any
) -> List:
    """The options of what was said by name; what was not has its default.

    Args:
        others: fields that are no options.

    Raises:
        UnknownOption: with the nearest name. BadInput: a value that is none, or one that says nothing.
    """
    known = options_in(kind)
    for name in said:
        if name not in known:
            raise UnknownOption(f"there is no option {name!r}", valid=nearest_name(name, known))
    require_needs(kind, said, spelled)
    with spelling(kind, spelled):
        return kind(**others, **said)


@contextmanager
def spelling(kind: type, spelled: Spelling) -> Iterator[None]:
    """Names an option as a door spells it, where an error inside is of one."""
    try:
        yield
    except ClearanceError as error:
        if error.where in options_in(kind):
            error.where = spelled(error.where, None)
        raise


def finite(given: Any) -> float:
    """A finite number; a TypeError or ValueError for what is none."""
    if isinstance(given, bool) or not isinstance(given, Real) or not math.isfinite(given):
        raise ValueError(given)
    return float(given)


def not_negative(given: Any) -> float:
    """A finite number, 0 or more."""
    number = finite(given)
    if number < 0.0:
        raise ValueError(given)
    return number


def _above_zero(given: Any) -> float:
    number = not_negative(given)
    if number == 0.0:
        raise ValueError(given)
    return number


def _millimetres(text: str) -> float:
    return float(text) / 1000.0


def _in_millimetres(length: float) -> str:
    return f"{length * 1000.0:g}"


def _switch(given: Any) -> bool:
    if not (isinstance(given, bool) or type(given).__name__ in ("bool", "bool_")):  # of NumPy
        raise TypeError(given)
    return bool(given)


def _name(given: Any) -> str:
    if not isinstance(given, str) or not given:
        raise TypeError(given)
    return given


def _path(given: Any) -> Path:
    if not isinstance(given, str | PathLike):
        raise TypeError(given)
    return Path(given)


def _day(given: Any) -> date:
    if isinstance(given, date) and not isinstance(given, datetime):
        return given
    return date.fromisoformat(_name(given))


def one_of(choices: tuple[str, ...]) -> Sort:
    """The sort of which these are all values."""

    def chosen(given: Any) -> str:
        if not isinstance(given, str) or given not in choices:
            raise ValueError(given)
        return given

    return Sort("|".join(choices), f"one of {', '.join(choices)}", chosen, choices=choices)


LENGTH = Sort(
    "MM", "a length, 0 or more", not_negative, _millimetres, suffix="mm", shown=_in_millimetres,
    fault=BadDimension,
)  # fmt: skip
POSITIVE_LENGTH = Sort(
    "MM", "a length above 0", _above_zero, _millimetres, suffix="mm", shown=_in_millimetres,
    fault=BadDimension,
)  # fmt: skip
SECONDS = Sort("S", "a finite number of seconds", finite, float)
SWITCH = Sort("", "True or False", _switch)
NAME = Sort("NAME", "a name", _name)
FILE = Sort("FILE", "the path of a file", _path)
DAY = Sort("DATE", "a day, as 2027-03-31", _day)
