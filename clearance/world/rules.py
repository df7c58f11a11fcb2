"""Which pairs may come how close, and which may touch: rows of patterns, times and carried parts."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from datetime import date
from fnmatch import fnmatchcase

from clearance.errors import BadDimension, BadInput, BadWaiver
from clearance.world.field_types import require_two_patterns, require_types
from clearance.world.timing import ALWAYS, Window

DEFAULT = "default"
"""The name of the limits that apply where no rule does."""


def matches(name: str, pattern: str) -> bool:
    """True if `pattern` is the name itself (which may contain `[`, `*` or `?`) or a wildcard for it."""
    return name == pattern or fnmatchcase(name, pattern)


def pattern_of(name: str) -> str:
    """The pattern that matches this name alone, whatever wildcards the name contains."""
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)


@dataclass(frozen=True)
class PairPattern:
    """Two patterns of bodies, in any order, and when they are meant.

    Attributes:
        between: patterns of names as in tables; that of a link may leave out its robot's name.
        window: of the run's time [s]. while_carried: only while this part is carried, if one is named.
    """

    between: tuple[str, str]
    window: Window = ALWAYS
    while_carried: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "between", require_two_patterns(self, "between", self.between))
        require_types(self, window=Window, while_carried=(str, None))

    def is_active(self, start: float, end: float, carried: Collection[str]) -> bool:
        """True if it applies from `start` to `end` [s], between which no window begins or ends."""
        if self.while_carried is not None and self.while_carried not in carried:
            return False
        return self.window.holds(start, end)

    def matches(self, one: Collection[str], other: Collection[str]) -> bool:
        """True if it is of two bodies, each given by the names it goes by."""
        first, second = self.between
        return (_any(one, first) and _any(other, second)) or (
            _any(one, second) and _any(other, first)
        )

    def matches_in_order(self, one: Collection[str], other: Collection[str]) -> bool:
        """True if the first pattern is of the first body and the second of the second."""
        return _any(one, self.between[0]) and _any(other, self.between[1])

    @property
    def when(self) -> str:
        """When it applies, in words; empty for always."""
        words = [str(self.window)] if self.window.ends else []
        words += [f"while {self.while_carried} is carried"] if self.while_carried else []
        return " ".join(words)


@dataclass(frozen=True)
class Allowance(PairPattern):
    """Pairs that are not measured; for a link and an obstacle the first pattern names the link."""

    def __str__(self) -> str:
        return " ".join([f"allowed by {list(self.between)}", *([self.when] if self.when else [])])


@dataclass(frozen=True)
class Rule(PairPattern):
    """Limits of some pairs [m].

    Attributes:
        name: for tables.
        fail: as in `case.Limits`; None for the one that applies without a rule. warn: as `fail` where it is None.

    Raises:
        BadDimension: a level that is below 0 or not finite, or `warn` below `fail`. BadInput: the name of the
            limits that apply without a rule.
    """

    name: str = ""
    fail: float | None = None
    warn: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.name:
            object.__setattr__(self, "name", " - ".join(self.between))
        if self.name == DEFAULT:
            raise BadInput(f"a rule is called {DEFAULT!r}", valid="another name")
        for name in ("fail", "warn"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, checked_level(given, name))
        if self.fail is not None:
            self.levels(self.fail)

    def levels(self, fail: float) -> tuple[float, float]:
        """Its two levels [m], where `fail` is the one that applies without a rule.

        Raises:
            BadDimension: `warn` below `fail`.
        """
        fail = fail if self.fail is None else self.fail
        return fail, ordered_warn(fail, self.warn, f" of rule {self.name!r}")


@dataclass(frozen=True)
class Waiver(PairPattern):
    """A limit of its own for two bodies, below that of their rule; of contact there is none.

    Attributes:
        at_least: [m] the clearance that they must keep. reason: why that suffices. by: who says so.
        until: the last valid day. case, rule: patterns of the names of cases and rules; "*" for all.
        where: its file and row, for messages. shared: given for many cases at once, and not all of them need it:
            whether any does is for whoever gives it to say, and no case fails by that it does not.

    Raises:
        BadDimension: a level that is below 0 or not finite. BadInput: nobody, or no reason.
    """

    at_least: float = 0.0
    reason: str = ""
    by: str = ""
    until: date = date.max
    case: str = "*"
    rule: str = "*"
    where: str = ""
    shared: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "at_least", checked_level(self.at_least, "at_least"))
        for name in ("reason", "by"):
            if not getattr(self, name).strip():
                raise BadWaiver(f"a waiver with no {name}", valid="why, and who says so")

    def is_of_case(self, name: str) -> bool:
        """True if it is of a case of this name."""
        return matches(name, self.case)

    def is_of(self, rule: str, one: Collection[str], other: Collection[str]) -> bool:
        """True if it is of two bodies, each given by the names it goes by, as far as a rule judges them."""
        return matches(rule, self.rule) and self.matches(one, other)

    def is_expired(self, today: date) -> bool:
        """True after its last day."""
        return today > self.until

    def __str__(self) -> str:
        place = f" ({self.where})" if self.where else ""
        return f"waiver {' - '.join(self.between)}{place}"


def _any(names: Collection[str], pattern: str) -> bool:
    return any(matches(name, pattern) for name in names)


def ordered_warn(fail: float, warn: float | None, whose: str = "") -> float:
    """The warn limit [m]: the fail limit where none is given.

    Raises:
        BadDimension: it is below the fail limit.
    """
    if warn is None:
        return fail
    if warn < fail:
        raise BadDimension(
            f"the warn limit {warn * 1000:g} mm is below the fail limit {fail * 1000:g} mm{whose}",
            valid="warn at or above fail",
        )
    return warn


def checked_level(given: float, name: str) -> float:
    """The level of clearance [m] that a limit is.

    Raises:
        BadDimension: no number, below 0 or not finite.
    """
    try:
        if isinstance(given, (str, bool)):
            raise ValueError
        level = float(given)
    except (TypeError, ValueError):
        raise BadDimension(f"limit {name} is {given!r:.60}", valid="a number of metres") from None
    if not 0.0 <= level < math.inf:
        raise BadDimension(f"limit {name} is {level} m", valid="0 or more")
    return level
