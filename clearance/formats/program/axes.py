"""How the joints of a robot follow the axes of its controller. Not for: moves (`conversion`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadProgram, UnknownJoint, at, nearest_name
from clearance.formats.program.controller_program import AxisTarget, PoseTarget
from clearance.formats.schema.program_file import Axis
from clearance.geometry.pose import inverse
from clearance.world.kinematic_chain import KinematicChain
from clearance.world.robot import Joint, JointKind


@dataclass(frozen=True, eq=False)
class AxisMap:
    """Joints of an arm, from its root to its tool, and what each follows.

    Attributes:
        joints: that are free to move. rules: by joint, as the case says. numbers: the axis that a joint follows,
            from 1. external: the name of the external axis that a joint follows instead. third: the multiple of
            axis 2 by which the joint of axis 3 turns beside its own, unless its rule has a `plus`.
    """

    joints: tuple[Joint, ...]
    rules: Mapping[str, Axis]
    numbers: Mapping[str, int]
    external: Mapping[str, str]
    third: float = 0.0

    @classmethod
    def of(
        cls, joints: tuple[Joint, ...], rules: Mapping[str, Axis], third: float = 0.0
    ) -> AxisMap:
        """The map that a case says; joints of which it does not say the axis have the others in their order.

        Raises:
            BadInput: a joint that is not of the arm, an axis twice.
        """
        names = [joint.name for joint in joints]
        for name in rules:
            if name not in names:
                raise UnknownJoint(f"unknown joint {name!r}", valid=nearest_name(name, names))
        said = {name: one.axis for name, one in rules.items() if one.axis is not None}
        external = {name: axis.upper() for name, axis in said.items() if isinstance(axis, str)}
        own = [name for name in names if name not in external]
        free = iter(i for i in range(1, len(own) + 1) if i not in said.values())
        numbers = {name: int(said[name]) if name in said else next(free, 0) for name in own}
        if sorted(numbers.values()) != list(range(1, len(own) + 1)):
            text = ", ".join(f"{name}: {number}" for name, number in numbers.items())
            raise BadProgram(f"the axes are {text}", valid=f"each of 1 to {len(own)} once")
        for joint in joints:
            if joint.kind is JointKind.PRISMATIC and joint.name in numbers:
                text = f"joint {joint.name!r} slides, and axes are read as angles"
                raise BadProgram(
                    text,
                    valid=f"if it is external, program: {{axes: {{{joint.name}: {{axis: E1}}}}}}",
                )
        if len(set(external.values())) != len(external):
            raise BadProgram("an external axis is there twice", valid="each once")
        own_rules = {name: rules.get(name, Axis()) for name in names}
        return cls(joints, own_rules, numbers, external, third)

    def joints_of(self, target: AxisTarget) -> dict[str, float]:
        """The joints [rad or m], by name.

        Raises:
            BadInput: not as many axes as the arm has; an external axis without a value.
        """
        if len(target.axes) != len(self.numbers):
            raise BadProgram(
                f"{len(target.axes)} axes are given, and the arm has {len(self.numbers)} joints "
                f"({', '.join(self.numbers)})",
                valid="another flange (link), or joints that are external axes: program: {axes: {…: {axis: E1}}}",
            )
        axes, offset, matrix = np.array(target.axes), *self._linear
        found = dict(zip(self.numbers, (matrix @ axes + offset).tolist(), strict=True))
        return {**self.external_values(target), **found}

    def external_values(self, target: AxisTarget | PoseTarget) -> dict[str, float]:
        """The joints that are external axes [rad or m], by name.

        Raises:
            BadInput: no value of one.
        """
        found = {}
        for joint in self.joints:
            if joint.name not in self.external:
                continue
            axis, rule = self.external[joint.name], self.rules[joint.name]
            if axis not in target.external:
                raise BadProgram(f"no value of external axis {axis}", valid="one")
            slides = joint.kind is JointKind.PRISMATIC
            unit = 1e-3 if slides else np.pi / 180.0
            found[joint.name] = rule.sign * target.external[axis] * unit + rule.offset
        return found

    def ranges_of(self, target: PoseTarget) -> dict[str, list[float]]:
        """The ranges of joints in a target's configuration [rad]; none of one that follows several axes."""
        offset, matrix = self._linear
        found = {}
        for row, (name, number) in enumerate(self.numbers.items()):
            if number in target.ranges and np.count_nonzero(matrix[row]) == 1:
                ends = [
                    matrix[row, number - 1] * end + offset[row] for end in target.ranges[number]
                ]
                found[name] = [float(min(ends)), float(max(ends))]
        return found

    def at_zero(
        self, chain: KinematicChain, root_from_base: np.ndarray
    ) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
        """By the number of an axis, about what its joint turns, and where that is [m], when all axes are at 0.

        Args:
            root_from_base: (4, 4) from where they are seen.
        """
        offsets = [self.rules[joint.name].offset for joint in chain.masters]
        frames = inverse(root_from_base) @ chain.frames(np.array([offsets]))[0]
        ways, places = {}, {}
        for joint, frame in reversed([*zip(chain.joints, frames[:-1], strict=True)]):
            number = self.numbers.get(chain.masters[joint.column].name)
            if number is not None:
                ways[number] = np.sign(joint.factor) * frame[:3, :3] @ joint.axis
                places[number] = frame[:3, 3]
        return ways, places

    @cached_property
    def _linear(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) and (n, n): joints in the order of `numbers` are the matrix times axes 1 to n, plus the first."""
        n = len(self.numbers)
        matrix, offset = np.zeros((n, n)), np.zeros(n)
        for row, (name, number) in enumerate(self.numbers.items()):
            rule = self.rules[name]
            offset[row], matrix[row, number - 1] = rule.offset, rule.sign
            usual = {2: rule.sign * self.third} if number == 3 and self.third else {}
            plus = rule.plus if "plus" in rule.model_fields_set else usual
            for other, factor in plus.items():
                with at(f"{name}.plus"):
                    if not 1 <= other <= n or other == number:
                        raise BadProgram(f"axis {other} is given", valid=f"another of 1 to {n}")
                matrix[row, other - 1] = factor
        return offset, matrix
