"""Every exception this package raises on purpose.

The class names the fault, the object keeps the data, and the message is one line: what was wrong, where
(file and field), and what would be valid. `at` lets an outer room add the place that an inner room cannot
know. Not for: programming errors of our own, which stay `AssertionError`.
"""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

from clearance.codes import code_of_error, coded

MOST_NAMES, NEAREST_NAMES = 40, 5
"""Valid names that a message lists in full, and those that it lists of more."""


_UNPACKED: list[str] = []
"""Folders that packed files lie in for as long as this process lasts, each with the separator at its end."""


def names_within(folder: Path) -> None:
    """Lets messages name what lies in a folder, into which a file is unpacked, as seen from it."""
    _UNPACKED.append(f"{folder}{os.sep}")


def is_unpacked(path: str) -> bool:
    """Whether a file lies in such a folder."""
    return path.startswith(tuple(_UNPACKED))


def shown(text: str) -> str:
    """The text with everything escaped that a terminal would not show as it is, and without unpacked folders."""
    for folder in _UNPACKED:
        text = text.replace(folder, "")
    if text.isprintable():
        return text
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode("ascii")
        for letter in text
    )


class ClearanceError(Exception):
    """Base of all errors that a caller can provoke; its text is always one line.

    Args:
        problem: what was wrong, with the value given.
        where: file and field, outermost first, e.g. `case.yaml: limits.fail`.
        valid: what would have been valid.
    """

    def __init__(self, problem: str, *, where: str = "", valid: str = "") -> None:
        super().__init__(problem)
        self.problem = problem
        self.where = where
        self.valid = valid

    @property
    def code(self) -> str:
        """The stable code of this class of errors: `CL104`."""
        return code_of_error(type(self))

    @property
    def line(self) -> str:
        """The text with its code, as a user sees it."""
        return coded(str(self), self.code)

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        remedy = f"; {self.valid}" if self.valid else ""
        return shown(" ".join(f"{place}{self.problem}{remedy}".split()))


class BadInput(ClearanceError, ValueError):
    """A value that cannot be used; the subclasses say why."""


class MissingFile(BadInput):
    """A file that is named but is not there or cannot be read."""


class SuspectInput(BadInput):
    """A value that can be right but looks wrong, and that nobody has accepted."""


class BadSyntax(BadInput):
    """A file that is not of the format it should be (YAML, XML, CSV, mesh)."""


class UnknownKey(BadInput):
    """A key that the schema does not have."""


class MissingKey(BadInput):
    """A key that the schema requires."""


class UnknownLink(BadInput):
    """A link name that the robot does not have."""


class UnknownObstacle(BadInput):
    """An obstacle name that the scene does not have."""


class UnknownJoint(BadInput):
    """A joint name that the robot does not have."""


class UnknownState(BadInput):
    """A state of joints by name that the robot's SRDF does not have, or of which it has several."""


class UnknownRobot(BadInput):
    """A robot name that the case does not have."""


class NoTrajectory(BadInput):
    """A robot that nothing is asked of, where a motion is needed."""


class DuplicateName(BadInput):
    """Two things of one kind with one name."""


class NotFinite(BadInput):
    """A NaN or an infinity where a number is needed."""


class BadShape(BadInput):
    """An array with the wrong number of rows or columns."""


class BadDimension(BadInput):
    """A length, radius or size that no solid can have."""


class BadPose(BadInput):
    """A quaternion or matrix that is not a rotation."""


class EmptyMesh(BadInput):
    """A mesh without faces."""


class BadPolygon(BadInput):
    """A face that is not a convex planar polygon, or refers to vertices that do not exist."""


class BadTime(BadInput):
    """Times that do not increase."""


class Contradiction(BadInput):
    """Two things that are said and cannot both hold, or one that says nothing without another."""


class BadRobot(BadInput):
    """A robot file whose links, joints or arguments do not fit together, or that asks for what is not read."""


class BadScene(BadInput):
    """A scene file whose objects do not fit together, or that asks for what is not read."""


class BadMotion(BadInput):
    """A motion, recording or bag that cannot be followed as it is, or is not the only one in its file."""


class BadProgram(BadInput):
    """A robot program that is not understood, or that the arm cannot follow as far as a proof needs."""


class UnknownPlace(BadProgram):
    """A frame of a program is on what is not there, or on a robot whose own program is not read yet."""


class BadTolerance(BadInput):
    """Tolerances that do not fit the case, or that no proof covers."""


class BadWaiver(BadInput):
    """A waiver without what makes it one."""


class BadChange(BadInput):
    """A change that cannot be looked for in this case, or that its request leaves open."""


class BadBatch(BadInput):
    """A manifest, a list of cases, or a store of answers that cannot be used."""


class BadReport(BadInput):
    """A report that is damaged or of another version."""


class BadPack(BadInput):
    """A zip that `clearance pack` has not written, or a case that cannot be packed."""


class NoReceipt(BadInput):
    """A run for which no receipt can be written or verified."""


class NotSimulated(BadInput):
    """A case whose motion the physics engine cannot simulate."""


class NothingToMeasure(BadInput):
    """A case in which no pair of bodies is left to measure."""


class Unwritable(ClearanceError):
    """A place for output that cannot be written."""


class Unavailable(ClearanceError):
    """An optional library that is needed for this call and is not installed."""


class Incomplete(ClearanceError):
    """Work that could not be finished; what was done stays, and the same command goes on with it."""


@contextmanager
def at(place: str) -> Iterator[None]:
    """Puts `place` before the `where` of any ClearanceError raised inside."""
    try:
        yield
    except ClearanceError as error:
        error.where = f"{place}: {error.where}" if error.where else place
        raise


@contextmanager
def unwritable(place: Path) -> Iterator[None]:
    """Turns what the system says about writing in `place` into `Unwritable`."""
    try:
        yield
    except OSError as error:
        raise Unwritable(
            f"cannot write here: {error.strerror or error}",
            where=str(place),
            valid="a folder that can be written, on a disk with room, is needed",
        ) from error


def refuse_truth(answer: object, decisive: str) -> NoReturn:
    """Refuses `bool` of an answer that says yes or no in an attribute: `assert check(…)` would always pass.

    Raises:
        BadInput: always.
    """
    name = type(answer).__name__
    valid = f"{name.lower()}.{decisive} is needed"
    raise BadInput(f"a {name} is neither true nor false", valid=valid)


def meant_name(given: str, read: Iterable[str]) -> str:
    """The name that is probably meant by an unknown one; "" if `given` is read, or resembles none.

    Formats of others have more names than we read. A typing error among ours would hide a shape or move it.
    """
    small = {name.lower(): name for name in read if abs(len(name) - len(given)) <= 2}
    close = difflib.get_close_matches(given.lower(), small, n=1, cutoff=0.75)
    return small[close[0]] if close and small[close[0]] != given else ""


def nearest_name(given: str, valid: Iterable[str]) -> str:
    """The remedy for a misspelt name: the nearest valid one, or the list of all, of many the nearest."""
    names = sorted(valid)
    close = difflib.get_close_matches(given, names, n=1, cutoff=0.6)
    if close:
        return f"did you mean {close[0]!r}?"
    if len(names) > MOST_NAMES:
        nearest = difflib.get_close_matches(given, names, n=NEAREST_NAMES, cutoff=0.0)
        return f"valid are {len(names):,} names, the nearest: {', '.join(nearest)}"
    return f"valid: {', '.join(names)}" if names else "there are none"
