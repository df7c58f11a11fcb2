"""What a case holds that can be right but looks wrong: lengths, angles or times in another unit, joints beyond
their limits.

Works on the case itself, so that one that was made in memory is looked at as one from files is. Not for: what
only a file shows (`load.plausibility`), and values that cannot be right.
"""

from __future__ import annotations

from clearance.world.case import Case, Limits
from clearance.world.joint_limits import notices_on_joints
from clearance.world.notice import Notice, Severity, worst_first
from clearance.world.plausible_motion import notices_on_motion
from clearance.world.plausible_sizes import notices_on_sizes

LARGE_LIMIT = 0.5
"""[m] A clearance limit above half a metre would forbid a robot most of its cell; in millimetres it
is usual.
"""


def notices_of(case: Case) -> tuple[Notice, ...]:
    """All that is suspect about a case, and all warnings, worst first: what loading found and what is seen here.

    Raises:
        BadInput: `limits.joints` is neither "warn" nor "fail".
    """
    found = [*case.notices]
    for placed in case.robots:
        found += placed.robot.notices
    found += _notices_on_limits(case.limits)
    found += notices_on_sizes(case)
    for placed in case.robots:
        if placed.trajectory is not None:  # else nothing is asked of it
            found += notices_on_motion(placed)
            found += notices_on_joints(placed, case.limits.joints)
    return worst_first(found)


def _notices_on_limits(limits: Limits) -> list[Notice]:
    given = {"fail": limits.fail, "warn": limits.warn}
    large = [f"limits.{key} is {value:g} m" for key, value in given.items() if value > LARGE_LIMIT]
    if not large:
        return []
    text = f"CHECK UNITS: {' and '.join(large)}; limits are in metres, is this millimetres?"
    return [Notice(Severity.SUSPECT, "units", text)]
