"""The schema of files that say where something goes over time, and when they are followed.

Not for: reading those files (`timed_files`).
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from clearance.errors import BadMotion, Contradiction
from clearance.formats.schema.program import Program
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import Name, StrictModel, validated
from clearance.world.timing import Timing


class TimedFile(StrictModel):
    """A table of samples and when it is followed: `{file: t.csv, start: 1.0}`, or the path alone. It begins at
    `start` [s], `rate` times as fast as written; after its last sample it holds, loops, or is absent.
    """

    file: Name
    start: float = 0.0
    rate: Annotated[float, Field(gt=0)] = 1.0
    after: Literal["hold", "loop", "absent"] = "hold"

    @model_validator(mode="before")
    @classmethod
    def _path_alone(cls, data: Any) -> Any:
        return {"file": data} if isinstance(data, str) else data

    @property
    def timing(self) -> Timing:
        """When the table is followed."""
        said = self.model_fields_set & {"start", "after"}
        return Timing(self.start, self.rate, self.after, frozenset(said))


class Units(StrictModel):
    """What the angles and lengths of a table are written in; velocities are in it a second."""

    angle: Literal["rad", "deg"] = "rad"
    length: Literal["m", "mm"] = "m"


class LengthUnit(StrictModel):
    """What the lengths of a table are written in."""

    length: Literal["m", "mm"]


class PoseFile(TimedFile):
    """Poses over time and when they are followed; lengths of a table may be in other `units`."""

    units: LengthUnit | None = None

    @property
    def length(self) -> str | None:
        """The unit of lengths, if it is said."""
        return None if self.units is None else self.units.length


def _by_itself(given: Any) -> Any:
    """Columns by name; those of a list are called so themselves."""
    if not isinstance(given, list) or not all(isinstance(name, str) for name in given):
        return given
    return {name: name for name in given}


class Choice(StrictModel):
    """What is said of a trajectory's file beside its path and times; None where nothing is.

    `which` of those in a file of several, from 1. A table may be in other `units`, have no header but `joints`
    for its columns, and no times but a `period` [s] from row to row. `columns` names the columns of a table to
    read, and no others; `{joint: column}` if names differ. `topic` is a topic of a bag. `gaps` says how joints
    move in holes of a recording: they hold, go straight (linear), or are not measured.
    """

    which: Annotated[int | None, Field(ge=1)] = None
    units: Units | None = None
    joints: Annotated[list[Name], Field(min_length=1)] | None = None
    period: Annotated[float | None, Field(gt=0)] = None
    topic: Name | None = None
    gaps: Literal["hold", "linear", "not_measured"] | None = None
    columns: (
        Annotated[dict[Name, Name], BeforeValidator(_by_itself), Field(min_length=1)] | None
    ) = None

    @property
    def unit_pair(self) -> tuple[str, str] | None:
        """The units of angles and lengths that name none themselves: keys of `column_units.UNITS`."""
        return None if self.units is None else (self.units.angle, self.units.length)

    def refuse_others(self, used: Collection[str], what: str) -> None:
        """Nothing, if all that is said is of use.

        Args:
            used: names of attributes. what: the kind of file, for the message.

        Raises:
            BadInput: the first that says nothing about such a file.
        """
        for name in Choice.model_fields:
            if name not in used and getattr(self, name) is not None:
                remedy = f"leave {name!r} out of trajectory"
                if name == "units":
                    remedy += (
                        ", or give it of the table that `clearance convert` makes of this file"
                    )
                raise BadMotion(f"{name!r} says nothing about {what}", valid=remedy)


class TrajectoryFile(Choice, TimedFile):
    """A trajectory, when it is followed, and what is said of its file. `wrap` says which way a continuous joint
    goes in a step of more than half a turn. `start_state` is the start at 0 s if the first sample is later:
    positions, or names of states. `program` is a robot program instead of a file, or the path of one; it starts
    in `start_state`.
    """

    wrap: Literal["shortest", "as_written"] | None = None
    start_state: dict[Name, float] | Name | list[Name] | None = None
    program: Name | ProgramFile | Program | None = None

    @model_validator(mode="before")
    @classmethod
    def _file_or_program(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "program" not in data:
            return data
        if "file" in data:
            raise Contradiction("both file and program are given", valid="one of them")
        others = sorted(data.keys() - {"program", "start", "rate", "after", "start_state"})
        if others:
            raise Contradiction(
                f"{others[0]} belongs to a file, not to a program", valid="no such key"
            )
        program = data["program"]
        if isinstance(program, dict):
            model = ProgramFile if "file" in program else Program
            program = validated(model, program, "program")
        return {"file": "-", **data, "program": program}

    @property
    def program_file(self) -> ProgramFile | None:
        """The file of the program, if it is in one."""
        if isinstance(self.program, str):
            return ProgramFile(file=self.program)
        return self.program if isinstance(self.program, ProgramFile) else None
