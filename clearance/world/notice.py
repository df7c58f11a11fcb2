"""Suspect input and warnings, which a reader of the verdict must know as well as the clearance.

Not for: errors (`clearance.errors`), and notes on what loading mended, which are plain text.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from clearance.codes import coded, codes, kind_of
from clearance.errors import BadInput


class Severity(StrEnum):
    """Effects of a notice on the verdict, worst first."""

    SUSPECT = "suspect"
    VIOLATED = "violated"
    UNPROVEN = "unproven"
    WARNING = "warning"


KINDS = (
    "units", "limits", "axis", "inside", "frame", "package", "gaps", "clocks", "wrap", "start", "simulated",
    "never",
)  # fmt: skip
"""Kinds of suspect input that a case can accept by name: lengths or angles in another unit, joints beyond their
limits, meshes turned by their file's axis tag and programs for other axes, solids of which inside and outside
cannot be decided, scenes in the frame of a link that moves or stands elsewhere, files read in place of those of
a missing package, holes in recordings (then bridged straight), tables that never move at the same time, turns
that could go either way (then as written), goals without a start (then single poses), simulated robots that
are pushed, do not arrive or are far off their trajectory, and pairs left out by an SRDF made for other shapes."""

IN_MILLIMETRES = "lengths are in metres, is this millimetres?"
"""What a notice on units asks of a length."""

WRAP, START = "wrap", "start"

WARNED_TOO = ("units", "limits", "gaps", "clocks", START, "simulated", "never")
"""Those whose lesser cases are warnings: their code accepts the warnings alone, their name suspect input too."""

WARNINGS = (
    "geometry", "equality", "scene", "padding", "reach", "scan", "plane", "program", "carry", "rest", "neighbours",
    "columns", "recorded run", "pairs", "rules", "profiles", "sketch", "waivers", "paper", "certificate",
    "contact", "cross-check", "limbs", "srdf",
)  # fmt: skip
"""Kinds of warnings alone, which a case can accept too: where warnings fail, these do not then."""

CODES_OF_KINDS = tuple(codes()[kind] for kind in (*KINDS, *WARNINGS))
"""By these a case can accept them too."""


def accepted_kind(given: object) -> str:
    """The kind of suspect input, or of a warning, that is given by its name or its code; of `WARNED_TOO` the code.

    Raises:
        BadInput: no kind that can be accepted.
    """
    kind = kind_of(given) if isinstance(given, str) else ""
    if kind not in (*KINDS, *WARNINGS):
        valid = f"kinds of suspect input: {', '.join(KINDS)}, their codes, or the code of a warning"
        raise BadInput(f"{given!r:.60} is given", valid=valid)
    return str(given) if kind in WARNED_TOO else kind


HOLD, LINEAR, NOT_MEASURED = GAPS = ("hold", "linear", "not_measured")
"""How joints move in a hole of a recording, as the case says: they stay until just before their next message, they
go straight, or the stretch is not measured."""


@dataclass(frozen=True)
class Notice:
    """One thing that was found in the input, or while measuring, that bears on the verdict.

    Attributes:
        severity: a suspect input makes the verdict suspect unless it is accepted; a rule of the case that
            is broken makes it violated; what is not proven of the motion fails it, unless only samples are asked
            for; a warning stands in the headline.
        kind: one of `KINDS`, or a word of its own for the others ("joint limits", "geometry", "package", …).
        text: one line: what was found, where, and what to do.
        about: the name of what it is of, where several could have such a notice: the robot, for joint limits.
    """

    severity: Severity
    kind: str
    text: str
    about: str = ""

    @property
    def code(self) -> str:
        """The stable code of its kind: `CL120`."""
        return codes()[self.kind]

    def accepted_by(self, accept: Collection[str]) -> str:
        """The entry of a case's `accept` that accepts it: its kind or, unless suspect, its code; else empty."""
        entries = [self.kind] if self.severity is Severity.SUSPECT else [self.kind, self.code]
        return next((entry for entry in entries if entry in accept), "")

    @property
    def line(self) -> str:
        """The text with its code, as a user sees it."""
        return coded(self.text, self.code)


def units(text: str) -> Notice:
    """Suspect input of kind "units"."""
    return Notice(Severity.SUSPECT, "units", f"CHECK UNITS: {text}")


def worst_first(notices: Iterable[Notice]) -> tuple[Notice, ...]:
    """The notices by severity, each once; those of one severity stay in their order."""
    order = list(Severity)
    return tuple(sorted(dict.fromkeys(notices), key=lambda notice: order.index(notice.severity)))


def listed(items: Sequence[str], most: int = 3) -> str:
    """The first few items, and how many more there are: `'a', 'b', 'c' and 9 more`."""
    text = ", ".join(items[:most])
    return text if len(items) <= most else f"{text} and {len(items) - most} more"


def naming(text: str, names: Collection[str], most: int = 6) -> list[str]:
    """A line that ends with the first few names, `text: 'a', 'b' and 9 more`; none where there is no name."""
    return [f"{text}: {listed([*names], most)}"] if names else []


def warnings_naming(text: str, names: Collection[str]) -> list[Notice]:
    """The same line as a warning on geometry."""
    return [Notice(Severity.WARNING, "geometry", line) for line in naming(text, names)]
