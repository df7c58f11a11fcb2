"""The arm as its controller sees it: its flange, its base, and how joints follow axes. Not for: moves
(`conversion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from clearance.errors import BadProgram, MissingKey, UnknownLink, at, nearest_name
from clearance.formats.program.axes import AxisMap
from clearance.formats.program.controller_program import ControllerMove, PoseTarget
from clearance.formats.program.conventions import CONVENTIONS, Convention
from clearance.formats.program.wrist import Wrist, wrist_of
from clearance.formats.schema import program as schema
from clearance.formats.schema.program_file import Axis, ProgramFile
from clearance.geometry.pose import inverse
from clearance.geometry.quaternions import quaternions_of
from clearance.world.kinematic_chain import KinematicChain, chain_between
from clearance.world.notice import listed
from clearance.world.robot import Robot

FLANGE, BASE_LINK = "tool0", "base"
"""The links whose frames are the controller's flange and base, where a robot's file keeps to the convention of
ROS-Industrial."""

FLAGS = r"flags as they were taught, or none (RAPID: `ConfJ\Off` before the move; KRL: no S and T)"
"""The remedy where those of a configuration contradict each other."""


@dataclass(eq=False)
class ControlledArm:
    """What a case and a robot say of an arm.

    Attributes:
        doubt: why the robot's root link may not be the controller's base; empty where that does not matter.
        maker: the preset of `axes_as` where the case says none.
        root_from_world: (4, 4) [m] where the world is, seen from the robot's root; None if that may change.
        notes: a line each on what is assumed. assumed: of the base, where nobody says it; empty where it is known.
    """

    asked: ProgramFile
    robot: Robot
    doubt: str = ""
    maker: str = "plain"
    root_from_world: np.ndarray | None = None
    notes: list[str] = field(default_factory=list)
    assumed: str = ""
    _several_turns: dict[str, None] = field(init=False, default_factory=dict)

    @cached_property
    def link(self) -> str:
        """The flange's link.

        Raises:
            UnknownLink, MissingKey: nobody says it.
        """
        links = self.robot.link_names
        if self.asked.link is None and FLANGE not in links:
            valid = f"the link whose frame is the controller's flange, one of {', '.join(links)}"
            raise MissingKey(f"there is no link {FLANGE!r}", where="link", valid=valid)
        link = self.asked.link or FLANGE
        if link not in links:
            valid = nearest_name(link, links)
            raise UnknownLink(f"there is no link {link!r}", where="link", valid=valid)
        if self.asked.link is None:
            self.notes.append(f"link {FLANGE!r} is taken for the flange")
        return link

    @cached_property
    def chain(self) -> KinematicChain:
        """From the robot's root to the flange."""
        return chain_between(self.robot, self.robot.link_names[0], self.link)

    @cached_property
    def axes(self) -> AxisMap:
        """How joints follow axes."""
        own, asked = self.chain.masters, self.asked.axes
        further = (
            joint
            for joint in self.robot.moving_joints
            if joint not in own and joint.name in asked and isinstance(asked[joint.name].axis, str)
        )
        joints = (*own, *further)
        with at("axes"):
            return AxisMap.of(
                joints, self.asked.axes, self.convention.third if self.convention else 0.0
            )

    @property
    def convention(self) -> Convention | None:
        """How the controller's axes turn; None where nobody knows."""
        return CONVENTIONS.get(self.asked.axes_as or self.maker)

    def doubts_on_axes(self) -> Iterator[str]:
        """A line each on what is assumed of axes, where the case does not say it.

        Raises:
            BadProgram: the joints are not those of `axes_as`, or of the maker, and nobody says how they follow.
        """
        convention, said = self.convention, self.asked.axes_as is not None
        if convention is None or self.misfit is None:
            if not said and not self.asked.axes:
                text = f"joints {', '.join(self.axes.numbers)} are taken to turn as the axes do"
                yield f"{text}; axes_as: plain in the program says so"
            yield from self._doubts_on_plain()
            return
        if self.misfit and said:
            valid = "axes: {joint: {sign: …, offset: …}} beside it, or another preset"
            raise BadProgram(self.misfit, where="axes_as", valid=valid)
        if self.misfit and not self.asked.axes:
            raise BadProgram(self.misfit, where="axes", valid=self._fitting(convention))
        else:
            text = f"joints turn as the axes of {convention.robots}"
            self.notes.append(self.misfit or text)
        (third,) = (name for name, number in self.axes.numbers.items() if number == 3)
        own = self.axes.rules[third].model_fields_set
        if convention.doubt and not said and not ("plus" in own or (own and not convention.third)):
            yield convention.doubt

    def _fitting(self, convention: Convention) -> str:
        """What is valid where joints are not a maker's axes: signs and offsets with which they are, if any."""
        base = np.eye(4) if self.root_from_base is None else self.root_from_base
        rules = convention.rules(self.chain, self.axes, base)
        plain = "axes_as: plain is right only if the controller shows the joints' own angles"
        if not rules:
            return f"how joints follow axes, as program: {{axes: {{joint: {{sign: -1, offset: 90deg}}}}}}; {plain}"
        written = ", ".join(
            f"{name}: {_written(one)}" for name, one in rules.items() if _written(one)
        )
        (last,) = (name for name, number in self.axes.numbers.items() if number == 6)
        text = f"if {last} and its axis are 0 together, program: {{axes: {{{written}}}}}"
        return f"{text}; {plain}"

    def _doubts_on_plain(self) -> Iterator[str]:
        """A line where joints are taken for the axes, and the maker's axes turn or count otherwise."""
        usual = CONVENTIONS.get(self.maker)
        if usual is None or self.asked.axes_as != "plain" or self.asked.axes:
            return
        otherwise = self._misfit_of(usual)
        if not otherwise and usual.third:
            otherwise = f"axis 3 of {usual.robots} counts from the horizontal"
        if otherwise:
            yield f"joints are taken for the axes (axes_as: plain), but {otherwise}"

    @cached_property
    def misfit(self) -> str | None:
        """Why the joints are not those of the controller's axes, empty if they are; None if nobody knows these."""
        return self._misfit_of(self.convention)

    def _misfit_of(self, convention: Convention | None) -> str | None:
        if convention is None or len(self.axes.numbers) != 6:
            return None
        base = np.eye(4) if self.root_from_base is None else self.root_from_base
        return convention.misfit(self.chain, self.axes, base)

    @cached_property
    def wrist(self) -> Wrist | None:
        """Where the wrist is; None where flags of a configuration do not say so much."""
        if self.misfit != "" or self.axes.external or self.root_from_base is None:
            return None
        return wrist_of(self.chain, self.axes, self.root_from_base[:3, 2])

    def ranges_of(self, to: PoseTarget, tool: np.ndarray) -> dict[str, list]:
        """The ranges of joints in a target's configuration [rad or m]: of a joint one, or several by whole turns.

        Raises:
            BadProgram: its flags do not agree.
        """
        external = {name: [value, value] for name, value in self.axes.external_values(to).items()}
        found: dict[str, list] = self.axes.ranges_of(to) | external
        if self.wrist is None or to.is_behind is None or to.unit:
            return found
        assert self.root_from_base is not None
        flange = self.root_from_base @ to.pose @ inverse(tool)
        names = (joint.name for joint in self.chain.masters)
        limits = dict(zip(names, self.chain.ranges.tolist(), strict=True))
        for name, ends in self.wrist.ranges(flange, to.is_behind, to.is_back).items():
            other = found.get(name, limits[name])
            within = [max(other[0], limits[name][0]), min(other[1], limits[name][1])]
            both = _overlaps(ends, within)
            if not both and name in found and within[0] < within[1]:
                ranges = f"{name} at {_shown(ends)}, or whole turns off, and at {_shown(other)}"
                raise BadProgram(f"the configuration asks for {ranges}", valid=FLAGS)
            if len(both) > 1:
                self._several_turns[f"turns of {name}"] = None
                found[name] = both
            else:
                found[name] = both[0] if both else found.get(name, ends)
        return found

    def doubts_on_configurations(self, ends: Sequence[PoseTarget]) -> Iterator[str]:
        """A line on flags of the configurations of poses that nothing checks, if there are any."""
        unchecked = dict.fromkeys(one.unchecked for one in ends if one.unchecked)
        unchecked |= self._several_turns
        if self.wrist is None and any(one.is_behind is not None for one in ends):
            unchecked["whether the wrist is before axis 1 and the upper arm"] = None
        if unchecked:
            text = f"configurations are not checked for {listed([*unchecked])}"
            yield f"{text}: the nearest joints are taken, and the controller may take others"

    def base(self) -> dict[str, Any]:
        """The controller's base, as a frame of a program."""
        if self.root_from_base is None or self.asked.base is not None:
            assert self.asked.base is not None
            return self.asked.base.model_dump(exclude_unset=True)
        return {"on": schema.BASE, **pose_written(self.root_from_base)}

    def units(self) -> dict[str, Any]:
        """The frames of mechanical units, as those of a program."""
        return {name: one.model_dump(exclude_unset=True) for name, one in self.asked.units.items()}

    @cached_property
    def root_from_base(self) -> np.ndarray | None:
        """(4, 4) the controller's base, seen from the robot's root [m]; None where only the cell says it."""
        if self.asked.base is not None:
            on = self._root_from(self.asked.base.on)
            return None if on is None else on @ self.asked.base.matrix()
        root = self.robot.link_names[0]
        link = BASE_LINK if BASE_LINK in self.robot.link_names else root
        if chain_between(self.robot, root, link).masters:
            link = root
        if self.doubt and link != BASE_LINK:
            valid = "where it is, seen from the robot's root, as program: {base: {on: base, xyz: [0, 0, …]}}"
            raise MissingKey(self.doubt, where="base", valid=valid)
        text = f"poses are seen from link {link!r}, taken for the controller's base"
        if link == BASE_LINK:
            self.notes.append(text)
        else:
            self.assumed = f"{text}; base: {{on: base}} in the program says that it is"
        return chain_between(self.robot, root, link).end

    def _root_from(self, name: str) -> np.ndarray | None:
        """(4, 4) what a base may be on, seen from the robot's root [m]; None where only the cell says it."""
        if name == schema.WORLD:
            return self.root_from_world
        if name != schema.BASE and name not in self.robot.link_names:
            return None
        root = self.robot.link_names[0]
        chain = chain_between(self.robot, root, root if name == schema.BASE else name)
        return None if chain.masters else chain.end

    def tool_at(self, joints: Mapping[str, float], tool: np.ndarray) -> np.ndarray:
        """(4, 4) `root_from_tool` [m]."""
        row = np.array([[joints[joint.name] for joint in self.chain.masters]])
        return np.asarray(self.chain.frames(row)[0, -1] @ tool)

    def off(
        self, to: PoseTarget, joints: Mapping[str, float], tool: np.ndarray
    ) -> tuple[float, float] | None:
        """How far joints have the tool from a pose [m] and [rad]; None where only the cell says where that is."""
        if self.root_from_base is None or to.unit:
            return None
        found = inverse(self.tool_at(joints, tool)) @ self.root_from_base @ to.pose
        turn = float(np.arccos(np.clip(0.5 * np.trace(found[:3, :3]) - 0.5, -1.0, 1.0)))
        return float(np.linalg.norm(found[:3, 3])), turn

    def base_from_flange(self, one: ControllerMove | None, unit: str = "") -> np.ndarray | None:
        """(4, 4) the flange at a move's end, seen from the base or a mechanical unit [m]; None if unknown."""
        if one is None or one.orientation == "constant":
            return None
        if isinstance(one.to, PoseTarget):
            return None if one.to.unit != unit else np.asarray(one.to.pose @ inverse(one.tool))
        if self.root_from_base is None or unit:
            return None
        flange = self.tool_at(self.axes.joints_of(one.to), np.eye(4))
        return np.asarray(inverse(self.root_from_base) @ flange)


def _overlaps(ends: list[float], other: list[float]) -> list[list[float]]:
    """What is both in a range of an angle, whole turns off or not, and in another range."""
    turns = (0.0, 2.0 * np.pi, -2.0 * np.pi)
    both = ([max(ends[0] + by, other[0]), min(ends[1] + by, other[1])] for by in turns)
    return [one for one in both if one[0] < one[1]]


def _written(rule: Axis) -> str:
    """Sign and offset of a rule, as a case has them, to a tenth of a degree; empty where it has none."""
    degrees = round(np.degrees(rule.offset), 1)
    parts = {"offset": f"{degrees:g}deg" if degrees else "", "sign": "-1" if rule.sign < 0 else ""}
    shown = ", ".join(f"{key}: {value}" for key, value in parts.items() if value)
    return f"{{{shown}}}" if shown else ""


def _shown(ends: list[float]) -> str:
    low, high = np.degrees(ends)
    return f"{low:.4g} to {high:.4g} deg"


def pose_written(pose: np.ndarray) -> dict[str, Any]:
    """A (4, 4) pose [m] as the schema has it."""
    quaternion = quaternions_of(pose[None, :3, :3])[0]
    return {"xyz": pose[:3, 3].tolist(), "quat_xyzw": quaternion.tolist()}
