"""A gain in plain lines, and no more than is proven: the terminal and the page say it in these words.

Lengths in millimetres, angles in degrees. Clearances and bounds are rounded down, changes away from zero.
Not for: the layout of the page.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from decimal import ROUND_FLOOR, ROUND_UP, Decimal

from clearance.gains.change_parts import (
    SHOWN,
    ChangePart,
    change_parts,
    joint_parts,
    size_in_unit,
    sliding,
    turning,
)
from clearance.gains.delay import MOST_SLOWER
from clearance.gains.joint_ranges import too_fast
from clearance.gains.moved_windows import windows_that_stay
from clearance.gains.obstruction import HOPELESS
from clearance.gains.offsets import SLIDE
from clearance.gains.result import Gain
from clearance.gains.turn import ARM
from clearance.record.wording import NOISE, depth_mm, limit_mm, mm, moment_text
from clearance.run import Run
from clearance.world.case import index_of_robot

Line = tuple[str, str]
"""A label and what it says."""

TIGHT = 1e-3
"""[-] A change that is within this of what no change can beat is told as the least."""


def lines_of(gain: Gain) -> Iterator[Line]:
    """What was, what is changed by how much, what that comes to, what no change of this kind can do; and what the
    verdict after it does not cover."""
    yield from _lines_of(gain)
    verdict = gain.after.verdict
    yield from (("measured", line) for line in verdict.scope)
    yield from (("warning", line) for line in verdict.warnings)


def _lines_of(gain: Gain) -> Iterator[Line]:
    yield "before", _worst(gain.before)
    if gain.before.verdict.n_waivers:
        yield (
            "waivers",
            "not counted: a change is sought with which waived pairs keep their limits, too",
        )
    if gain.clearances_kept and gain.size == 0.0:
        yield from _kept_as_it_is(gain)
        return
    yield from _kept(gain) if gain.clearances_kept else _not_kept(gain)
    yield from (("warning", line) for line in gain.unjudged)
    if gain.request.kind == "obstacle" and gain.size > 0.0:
        yield from (("note", line) for line in _programs_left(gain))
    if gain.request.kind == "timing" and gain.size > 0.0:
        yield from (("warning", line) for line in _windows_left(gain))
    if not is_hopeless(gain):
        yield "bound", bound_text(gain)
    fast = _too_fast(gain)
    if fast:
        yield (
            "note",
            f"faster than the robot's own file allows as it is, and made no faster: {fast}",
        )
    if gain.request.margin:
        yield "margin", "it is not written into the changed case, whose limits are as they were"


def _windows_left(gain: Gain) -> Iterator[str]:
    case = gain.case
    for window in windows_that_stay(case, index_of_robot(case.robots, gain.who)):
        yield (
            f"{window} stays at its times, and robot {gain.who!r} is there later: "
            "check that it still covers what it is meant for"
        )


def _programs_left(gain: Gain) -> Iterator[str]:
    """Programs whose targets may be taught on the obstacle that is moved."""
    for placed in gain.case.robots:
        if placed.trajectory is not None and placed.trajectory.moves:
            yield (
                f"the program of robot {placed.robot.name!r} stays as it is: if it works on {gain.who}, "
                "move its work frame as well"
            )


def _too_fast(gain: Gain) -> str:
    if not gain.joint_names:
        return ""
    robots = gain.before.record.case.robots
    names = gain.request.robot or (gain.who,)
    lines = [too_fast(robots[index_of_robot(robots, name)]) for name in names]
    return ", ".join(line for line in lines if line)


def _kept(gain: Gain) -> Iterator[Line]:
    """A change with which every clearance holds, after what else fails the changed case."""
    yield from _not_passed(gain)
    yield from (("changed", line) for line in changed_lines(gain))
    yield from (("tool", line) for line in tool_lines(gain))
    yield "after", _worst(gain.after)
    held = "rule" if gain.kept else "clearance"
    yield "proven", f"every {held} holds at every moment{_by_margin(gain)}"


def _kept_as_it_is(gain: Gain) -> Iterator[Line]:
    """A case whose clearances all hold without a change, and what else fails it."""
    if gain.kept:
        yield "kept", f"nothing had to be changed: every rule is proven to hold{_by_margin(gain)}"
        return
    yield from _not_passed(gain)
    yield "proven", f"every clearance holds without a change{_by_margin(gain)}"


def _not_passed(gain: Gain) -> Iterator[Line]:
    """That the case fails though every clearance holds, and by what: a change is sought for clearances alone."""
    if gain.kept:
        return
    verdict = gain.after.verdict
    yield "not kept", not_passed_text(gain)
    suspects = (f"suspect {one.kind}: {one.line}" for one in verdict.suspects)
    yield from (("because", line) for line in (*verdict.beside, *verdict.waiver_faults, *suspects))


def not_passed_text(gain: Gain) -> str:
    """The verdict of a case that fails though every clearance holds."""
    case = "changed case" if gain.size > 0.0 else "case"
    return f"the {case} is not passed: {gain.after.verdict.headline()}"


def _not_kept(gain: Gain) -> Iterator[Line]:
    """The best that was reached, and what it is up against."""
    yield "not kept", _not_kept_text(gain)
    if gain.size > 0.0:
        yield from (("best", line) for line in changed_lines(gain))
        yield from (("tool", line) for line in tool_lines(gain))
        yield "reached", _worst(gain.after)
    if gain.blocked is not None:
        yield "blocked", str(gain.blocked)
    yield from (("binding", line) for line in gain.binding)


def is_hopeless(gain: Gain) -> bool:
    """True if no change of the kind, however large, can make every rule hold."""
    return gain.blocked is not None and gain.blocked.why in HOPELESS


def changed_lines(gain: Gain) -> list[str]:
    """What is moved by how much."""
    parts = change_parts(gain)
    if gain.request.kind == "waypoints":
        return [_joint(part) for part in parts] or ["no joint moves"]
    if gain.request.slow_down:
        rate = 1.0 / (1.0 + gain.size)
        return [
            f"robot {gain.who} takes {amount_text(parts[0])} longer for its path: {_down(rate)} times as fast, "
            "from its table's time 0 on"
        ]
    if gain.request.kind == "timing":
        return [f"robot {gain.who} begins {amount_text(parts[0])} later"]
    who = f"{'robot' if gain.request.kind == 'base' else 'obstacle'} {gain.who}"
    axes = ", ".join(
        f"{part.name} {signed_text(part).removesuffix(' mm')}" for part in parts if part.unit == "m"
    )
    turned = [f", turned {signed_text(part)}{_about(gain)}" for part in parts if part.unit == "rad"]
    joints = ""
    if gain.request.kind == "base":
        joints = "; its joints as they are, so its tool moves along"
    if gain.tool_path is not None:
        joints = f"; its joints make up for it, so that {gain.tool_path.link} goes the same way"
    moved = f"{who} moved {size_text(gain)}: {axes}{''.join(turned)}{joints}"
    followed = [] if gain.tool_path is None else joint_parts(gain)
    return [moved, *(_joint(part) for part in followed)]


def _about(gain: Gain) -> str:
    """What a turn is about, and how it counts."""
    turn = gain.request.turn
    assert turn is not None
    through = "its origin"
    moving = [one.name for one in gain.case.obstacles if one.moves is not None]
    if gain.request.kind == "obstacle" and gain.who in moving:
        through = "its origin at its first sample"
    if turn.about is not None:
        through = ", ".join(f"{1e3 * one:g}" for one in turn.about) + " mm"
    counted = 1e3 * math.radians(1.0) * ARM
    return f" about {turn.axis} through {through} (1 deg counts as {counted:.2f} mm)"


def tool_lines(gain: Gain) -> Iterator[str]:
    """How far a tool is off where it is to stay, rounded up."""
    off = gain.tool_path
    if off is not None:
        yield (
            f"{off.link} is off its path by up to {_up(off.far * 1e3)} mm and {_up(math.degrees(off.turn))} deg "
            f"at its samples; by no more than {_up(off.far_between * 1e3)} mm and "
            f"{_up(math.degrees(off.turn_between))} deg between them"
        )
    for one in gain.tool_moves:
        yield (
            f"{one.link} at {one.keep.time:.3f} s is moved {_up(one.far * 1e3)} mm of {one.keep.far * 1e3:g} and "
            f"turned {_up(math.degrees(one.turn))} deg of {math.degrees(one.keep.turn):g}"
        )


def amount_text(part: ChangePart) -> str:
    """How far a part moves, without a sign."""
    factor, unit = SHOWN[part.unit]
    return f"{_up(abs(part.amount) * factor)} {unit}"


def signed_text(part: ChangePart) -> str:
    """The same with its sign; none where that is nothing in the digits told."""
    text = amount_text(part)
    return text if text.startswith("0 ") else f"{'+' if part.amount > 0.0 else '-'}{text}"


def size_text(gain: Gain) -> str:
    """The size of the change."""
    size, _, unit = size_in_unit(gain)
    factor, shown = SHOWN[unit]
    return f"{_up(size * factor)} {shown}"


def bound_text(gain: Gain) -> str:
    """What no change of the kind can beat."""
    if gain.lower_bound <= 0.0:
        return (
            f"not known how little would be enough{f'; {_LOCAL}' if gain.clearances_kept else ''}"
        )
    _, least, unit = size_in_unit(gain)
    factor, shown = SHOWN[unit]
    bound = f"{_down(least * factor)} {shown}{_counted(gain)}"
    if not gain.clearances_kept:
        return f"at least {bound} is needed"
    if gain.lower_bound >= gain.size * (1.0 - TIGHT):
        return f"at least {bound} is needed; this change is within 0.1 % of the least"
    return f"at least {bound} is needed; {_LOCAL}"


_LOCAL = "this change is the smallest that a local search found"


def _counted(gain: Gain) -> str:
    """How slides and turns are held against each other."""
    if gain.request.kind != "waypoints":
        return ""
    if turning(gain) and sliding(gain):
        return f" at a joint, where {1e3 * math.radians(1.0) / SLIDE:.1f} mm of a slide count as 1 deg,"
    return " at a joint"


def _not_kept_text(gain: Gain) -> str:
    if is_hopeless(gain):
        ends = gain.request.kind == "waypoints" and gain.request.keep_ends and not gain.request.keep
        of_ends = " while the ends of the path are kept (--free-ends frees them)" if ends else ""
        return f"no change of this kind can make every rule hold{of_ends}"
    if gain.request.kind == "timing":
        return _not_in_time(gain)
    return "no change of this kind was found with which every rule is proven to hold"


def _not_in_time(gain: Gain) -> str:
    """Up to what was looked."""
    how = f"delay up to {gain.request.most_delay:g} s"
    if gain.request.slow_down:
        how = f"slow-down to {1.0 + MOST_SLOWER:g} times its duration"
    return f"no {how} was found with which every rule holds"


def _by_margin(gain: Gain) -> str:
    return (
        f", by {limit_mm(gain.request.margin)} mm more than its limit"
        if gain.request.margin
        else ""
    )


def _worst(run: Run) -> str:
    """The most critical moment, its limit, and the verdict; its own status too where that is another."""
    verdict, worst = run.verdict, run.verdict.worst
    fail = run.record.rule(worst.rule).limits.fail
    far = "touch" if worst.touches else f"{mm(worst.clearance)} mm"
    if not worst.touches and worst.clearance < 0.0:
        far = f"{depth_mm(-worst.clearance)} mm too near for their padding"
    text = f"{worst.link} and {worst.obstacle}: {far} at {moment_text(run.record, worst)}"
    status = run.record.status_of(worst)
    own = "" if status == verdict.measured else f"{status}, but the case is "
    return f"{text}; fail below {limit_mm(fail)} mm: {own}{verdict.headline()}"


def _joint(part: ChangePart) -> str:
    text = f"joint {part.name} by up to {signed_text(part)}"
    return f"{text} at {part.time:.3f} s, between {part.start:.3f} and {part.end:.3f} s"


def _up(value: float) -> str:
    """Four digits, three or four places, rounded away from zero: enough of a change. 0 for what is rounding."""
    if abs(value) < 1e-9:
        return "0"
    exact = Decimal(repr(value * (1.0 - NOISE)))
    places = max(3, min(4, 3 - exact.adjusted()))
    return f"{exact.quantize(Decimal(1).scaleb(-places), rounding=ROUND_UP):f}"


def _down(value: float) -> str:
    """Four digits, at most four places, two digits of what is small; rounded down."""
    exact = Decimal(repr(value))
    places = 4 if value >= 1e-3 else 1 - exact.adjusted()
    places = max(0, min(places, 3 - exact.adjusted()))
    return f"{exact.quantize(Decimal(1).scaleb(-places), rounding=ROUND_FLOOR):f}"
