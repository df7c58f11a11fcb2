"""The schema of a robot program in a file: the file, and what a controller knows that its file does not say.

Not for: reading the languages of controllers (`formats.program`).
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from clearance.formats.schema.pose import Pose
from clearance.formats.schema.program import Frame
from clearance.formats.schema.strict_model import Angle, Name, StrictModel


class Axis(StrictModel):
    """How a joint follows an axis of the controller: `joint = sign * axis + offset` [rad or m], and multiples of
    other axes by `plus`. Without `axis` (1, 2, … or E1, E2, …) joints have the axes in their order.
    """

    axis: int | Name | None = None
    offset: Angle = 0.0
    sign: Literal[-1, 1] = 1
    plus: dict[int, float] = {}


class ProgramFile(StrictModel):
    """A program's file. All else is for languages of controllers: `entry` is the procedure that runs, `beside` are
    further files, `skip` are instructions to leave out, `link` is the flange, `base` is where the controller's
    base stands, `axes` says how joints follow axes, `axes_as` that axes turn as on robots of a maker (`plain`:
    joints are the axes). `tools` (on the flange) and `frames` (on the base; position registers in the user frame)
    are those that the file names and does not hold (in RAPID they replace the file's), `units` the frames of
    mechanical units that move the work. `zones` are radii [m] of corners for which it has a word and no length
    (`C_PTP`, `CNT50`). `variables` are what registers hold when the program begins, outputs until it changes
    them, and inputs all the time.
    `step` is the most that the tool moves between samples [m].
    """

    file: Name
    entry: Name | None = None
    beside: list[Name] = []
    skip: list[Name] = []
    link: Name | None = None
    base: Frame | None = None
    axes: dict[Name, Axis] = {}
    axes_as: Literal["abb", "abb_parallel", "fanuc", "kuka", "ur", "plain"] | None = None
    tools: dict[Name, Pose] = {}
    frames: dict[Name, Pose] = {}
    units: dict[Name, Frame] = {}
    zones: dict[Name, Annotated[float, Field(gt=0)]] = {}
    variables: dict[Name, bool | int | float] = {}
    step: Annotated[float, Field(gt=0)] = 0.002
