"""What is suspect about a simulated motion: obstacles that push the robot, and joints off their trajectory.

Not for: making the motion (`bullet`), nor what its URDF lacks (`model`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from clearance.world.joint_limits import notices_on_joints
from clearance.world.joint_positions import turns
from clearance.world.joint_speeds import notices_on_speed
from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import Trajectory

OFF_TURN, OFF_SLIDE = 0.2, 0.05
"""[rad], [m] A robot farther off its trajectory does not follow it; recorded runs are refused at 0.2 rad."""

NOT_ARRIVED = 2e-3
"""[rad or m] A joint that ends farther from its last sample has not arrived."""

AT_LIMIT = 1e-4
"""[rad or m] The engine's joints give way at their limits: nearer than that they are at them."""

SPEED_ROUNDING = 1e-3
"""[-] of a speed limit, which the engine's drives keep to no better: a table at its limit is not beyond it."""

HULLS = (
    "simulated motion: contact_response: the links push as their convex hulls; the clearance is that of "
    "the shapes themselves"
)


@dataclass
class Pushes:
    """The contacts of the engine between a robot and obstacles that push it.

    Attributes:
        links: names by the engine's number. obstacles: names by the engine's number.
        n_steps: simulation steps made. found: first and last step and greatest force [N] by link and obstacle.
    """

    links: Mapping[int, str]
    obstacles: dict[int, str] = field(default_factory=dict)
    n_steps: int = 0
    found: dict[tuple[str, str], tuple[int, int, float]] = field(default_factory=dict)

    def add(self, points: Sequence[tuple]) -> None:
        """Adds the engine's contact points of the step that is being made."""
        for _, _, other, link, _, _, _, _, _, force, *_ in points:
            if force > 0.0 and other in self.obstacles:
                pair, now = (self.links[link], self.obstacles[other]), self.n_steps + 1
                first, _, most = self.found.get(pair, (now, now, 0.0))
                self.found[pair] = first, now, max(most, force)

    def notices(self, times: np.ndarray) -> list[Notice]:
        """Suspect input where an obstacle pushes: in the physics its clearance is never less than nothing."""
        if not self.found:
            return []
        texts = [
            f"{link!r} and {obstacle!r} from {times[first]:.3f} to {times[last]:.3f} s with up to {most:.3g} N"
            for (link, obstacle), (first, last, most) in self.found.items()
        ]
        text = (
            f"CHECK MOTION: obstacles push the simulated robot: {listed(texts)}; the engine stops the convex "
            "hulls of links in front of obstacles, so contact is not measured"
        )
        return [Notice(Severity.SUSPECT, "simulated", text)]


def notices_on_course(
    placed: PlacedRobot, times: np.ndarray, positions: np.ndarray, off: np.ndarray
) -> Iterator[Notice]:
    """Suspect motion: joints far off their trajectory, or that do not arrive at its last sample.

    Args:
        off: (n, k) [rad or m] how far each joint is from where it is asked to be.
    """
    joints = placed.robot.moving_joints
    units = ["rad" if turns(joint) else "m" for joint in joints]
    end = placed.given_trajectory.times[-1]
    rest = (times[-1] - end) / placed.timing.rate
    for column, (joint, unit) in enumerate(zip(joints, units, strict=True)):
        name, worst = repr(joint.name), int(np.argmax(off[:, column]))
        most = OFF_TURN if unit == "rad" else OFF_SLIDE
        asks = "are masses and efforts those of the robot, and has the table enough time?"
        texts = []
        if off[worst, column] > most:
            texts.append(
                f"leaves the trajectory by up to {off[worst, column]:.3g} {unit}, at {times[worst]:.3f} s"
            )
        if off[-1, column] > NOT_ARRIVED:
            texts.append(
                f"is {off[-1, column]:.3g} {unit} from its last sample {rest:.3g} s after it; "
                "later motion is not measured"
            )
        if texts:
            text = f"CHECK MOTION: simulated joint {name} {' and '.join(texts)}; {asks}"
            yield Notice(Severity.SUSPECT, "simulated", text)


def as_measured(placed: PlacedRobot, times: np.ndarray, positions: np.ndarray) -> PlacedRobot:
    """The robot with its simulated motion as its trajectory, by which its joint limits are judged."""
    names = tuple(joint.name for joint in placed.robot.moving_joints)
    trajectory = Trajectory(times, names, positions, path_error=AT_LIMIT)
    return replace(placed, trajectory=trajectory)


def notices_on_limits(
    placed: PlacedRobot, times: np.ndarray, positions: np.ndarray, rule: str, before: str
) -> Iterator[Notice]:
    """Joints that the simulated motion takes beyond their limits.

    Args:
        rule: "warn" or "fail", as `Limits.joints`. before: what stands before the names of joints.
    """
    made = as_measured(placed, times, positions)
    found = [
        *notices_on_joints(made, rule, before),
        *notices_on_speed(made, rule, before, SPEED_ROUNDING),
    ]
    yield from (replace(one, text=f"simulated motion: {one.text}") for one in found)
