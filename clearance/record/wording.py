"""How figures are put on the page: lengths in millimetres, angles in degrees, clearances rounded
down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal

from clearance.record.moment import Depth, Moment
from clearance.record.record import PairMinimum, Record
from clearance.record.status import Status
from clearance.world.notice import listed
from clearance.world.rules import DEFAULT
from clearance.world.timing import time_text


def mm(metres: float, levels: Sequence[float] = ()) -> str:
    """A length in millimetres, rounded down so that a shown clearance is never more than the
    measured one.

    Four digits or, below 10 mm, three decimals; what is above 0 and below a micrometre says so. More digits, if it
    would else seem to be below a level [m] that stands beside it.
    """
    if metres == 0.0:
        return "0"
    if 0.0 < metres < 1e-6:
        return "< 0.001"
    value = Decimal(repr(float(metres))) * 1000  # exact, so that 0.0283 m is 28.30 mm
    reached = [Decimal(limit_mm(level)) for level in levels if level <= metres]
    least = max(reached, default=value - 1)
    for places in range(max(0, min(3, 3 - value.adjusted())), MOST_PLACES + 1):
        text = str(value.quantize(Decimal(1).scaleb(-places), rounding=ROUND_FLOOR))
        if Decimal(text) >= least:
            break
    return text


def at_least_mm(metres: float) -> str:
    """`at least 5.000 mm`, rounded down; of less than a micrometre, `more than 0 mm`."""
    return "more than 0 mm" if 0.0 < metres < 1e-6 else f"at least {mm(metres)} mm"


MOST_PLACES = 6
"""Decimals of a millimetre: a nanometre."""

NOISE = 1e-12
"""[-] What is rounded up is first made less by this share: 0.05 m and a rounding is 50.00 mm, not 50.01."""


def depth_mm(metres: float) -> str:
    """A penetration in millimetres, rounded up so that it is not shown less than it is (but for noise)."""
    if metres == 0.0:
        return "0"
    value = Decimal(repr(float(metres) * (1.0 - NOISE))) * 1000
    places = max(0, min(3, 3 - value.adjusted()))
    return str(value.quantize(Decimal(1).scaleb(-places), rounding=ROUND_CEILING))


def volume_cm3(cubic_metres: float) -> str:
    """A volume in cubic centimetres, three digits, rounded up as a depth is."""
    return _digits(cubic_metres * 1e6, 3, ROUND_CEILING)


def least_cm3(cubic_metres: float) -> str:
    """A lower bound of a volume in cubic centimetres, three digits, rounded down."""
    return _digits(cubic_metres * 1e6, 3, ROUND_FLOOR)


def litres(cubic_metres: float) -> str:
    """A volume in litres, four digits, rounded up."""
    return _digits(cubic_metres * 1e3, 4, ROUND_CEILING)


def _digits(value: float, n_digits: int, rounding: str) -> str:
    if value == 0.0:
        return "0"
    towards = -NOISE if rounding == ROUND_CEILING else NOISE
    exact = Decimal(repr(float(value) * (1.0 + towards)))
    last = Decimal(1).scaleb(exact.adjusted() - n_digits + 1)
    return f"{exact.quantize(last, rounding=rounding):f}"


def contact_text(contact: dict) -> str:
    """Depth and volume as one phrase; where they are not exact, the range that holds them."""
    volumes = volume_cm3(contact["volume"]), least_cm3(contact["volume_at_least"])
    depth = Depth(contact["penetration"], contact["penetration_at_least"], contact["exact"])
    return f"{depth_text(depth)}, {_range(*volumes, contact['volume_exact'])} cm³ shared"


def depth_text(depth: Depth | None) -> str:
    """The penetration depth of a contact; if it is not exact, its range."""
    if depth is None:
        return "depth not computed"
    return f"{_range(depth_mm(depth.penetration), mm(depth.at_least), depth.exact)} mm deep"


def near_mm(clearance: float, status: str, unit: str = "") -> str:
    """A least clearance in millimetres; of bodies in contact no length, which would read as a graze."""
    return "contact" if status == Status.CONTACT else f"{mm(clearance)}{unit}"


def least_text(moment: Moment, levels: Sequence[float] = ()) -> str:
    """The clearance of the worst moment, or its depth where bodies touch; `levels` [m] as of `mm`."""
    if moment.touches:
        return depth_text(moment.depth)
    return f"least clearance {padded_mm(moment, levels)}"


SEEN_PADDING = 1e-4
"""[m] Less padding than this is told only where bodies are listed, or where a limit lies between."""

EQUAL = 1e-12
"""[m] Rounding of a clearance that is equal to a limit."""


def padded_mm(moment: Moment, levels: Sequence[float] = ()) -> str:
    """The clearance of a moment in millimetres; with padding, that and the distance of the shapes beside it."""
    text, shapes = f"{mm(moment.clearance, levels)} mm", moment.clearance + moment.padding
    if not moment.touches and moment.padding >= SEEN_PADDING:
        padding = depth_mm(moment.padding)  # rounded up, as the clearance is rounded down
        return f"{text} ({mm(shapes)} mm less {padding} mm of padding)"
    decides = moment.padding > 0.0 and any(
        moment.clearance < level <= shapes + EQUAL for level in levels
    )
    if moment.touches or not decides:
        return text
    return f"{text} ({mm(shapes + EQUAL)} mm less {scientific_mm(moment.padding)} mm of padding)"


def _range(greatest: str, least: str, exact: bool) -> str:
    if exact or greatest == least:
        return greatest
    return f"at most {greatest}" if least == "0" else f"{least} to {greatest}"


def limit_mm(metres: float) -> str:
    """A given limit in millimetres, in as many digits as it has."""
    return f"{metres * 1000.0:.6g}"


def scientific_mm(metres: float) -> str:
    """A difference in millimetres with two digits, e.g. `3.1e-10`; 0 stays 0."""
    return "0" if metres == 0.0 else f"{metres * 1000.0:.1e}"


def joint_value(kind: str, position: float) -> str:
    """A joint position with its unit: degrees, or millimetres where it slides."""
    if kind == "prismatic":
        return f"{position * 1000.0:.2f} mm"
    return f"{math.degrees(position):.2f}°"


def seconds(value: float, move: str = "") -> str:
    """A time with its unit, to the millisecond, and the move of a program that is made then."""
    return f"{value:.3f} s{f' in {move}' if move else ''}"


def count(number: int, noun: str) -> str:
    """`1 step`, `2 steps`, `12,000 steps`."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def gap_text(gap: float) -> str:
    """A gap to a profile [mm], rounded down; of a negative one its size is rounded to 3 digits."""
    return mm(gap) if gap >= 0.0 else f"-{-gap * 1000:.3f}"


def swept_text(plane: str, section: float | None, links: Sequence[str]) -> str:
    """The sweep that a profile is held against: `xy`, `yz at 0.5 m`, `xy, only gripper`."""
    at = "" if section is None else f" at {section:g} m"
    return f"{plane}{at}, only {listed(links)}" if links else f"{plane}{at}"


def moment_text(record: Record, moment: Moment) -> str:
    """When a moment is: `1.220 s, step 61`, or which steps it is between; and when its second body is there, if
    that has a clock of its own."""
    where = f"step {moment.step}"
    if moment.between:
        where = f"between the steps {moment.step} and {moment.step + 1}"
    at = seconds(moment.time, record.moves.at(moment.time))
    return f"{at}, {where}{other_time(moment.obstacle, moment.time_b)}"


def other_time(name: str, time: float | None) -> str:
    """When a body with a clock of its own is there; empty where there is one clock."""
    return "" if time is None else f", with {name} at {seconds(time)}"


def of_rule(rule: str) -> str:
    """` of rule 'fence'`; nothing for the limits that hold where no rule does."""
    return "" if rule == DEFAULT else f" of rule {rule!r}"


def judged_by(rule: str) -> str:
    """`, judged by rule 'fence'`; nothing for the limits that hold where no rule does."""
    return "" if rule == DEFAULT else f", judged by rule {rule!r}"


def limits_text(fail: float, warn: float) -> str:
    """`fail below 5 mm, warn below 20 mm`; where no gap is asked for, only contact fails."""
    warned = f"warn below {limit_mm(warn)} mm"
    if fail == 0.0:
        return f"only contact fails, {warned}" if warn > 0.0 else "only contact fails"
    return f"fail below {limit_mm(fail)} mm, {warned}"


def clock_text(slack: float) -> str:
    """How far clocks may be apart; empty for one clock."""
    if slack == 0.0:
        return ""
    return "clocks not tied" if math.isinf(slack) else f"clocks up to {slack:g} s apart"


def not_measured_text(spans: Sequence[tuple[float, float]]) -> str:
    """Which stretches [s] of a run are left out; empty for none."""
    if not spans:
        return ""
    spelled = [f"from {time_text(start)} to {time_text(end)} s" for start, end in spans]
    return f"not measured {listed(spelled)}"


def span_text(start: float, end: float, moves: str = "") -> str:
    """A stretch of time: `0.500-1.220 s`, or `at 1.220 s` where it is no longer than shown; and its moves."""
    if f"{start:.3f}" == f"{end:.3f}":
        return f"at {seconds(start, moves)}"
    return f"{start:.3f}-{seconds(end, moves)}"


def least_proven(certified: dict) -> str:
    """The least proven clearance, and of which moments; a bound of 0 but for rounding says nothing."""
    if certified["touches"]:
        return "no clearance, since there is contact"
    if -SEEN_PADDING < certified["lower_bound"] <= 0.0:
        return "contact is not ruled out"
    when = "at every moment that is measured" if certified["not_measured"] else "at every moment"
    when = "at every moment that is proven" if certified.get("not_proven") else when
    when = "at this pose" if certified["is_pose"] else when
    return f"{at_least_mm(certified['lower_bound'])} {when}"


def certified_text(certified: dict) -> str:
    """What is proven of the continuous motion, as one sentence."""
    way = {
        "linear": "linearly",
        "cubic": "on cubics through the given velocities",
        "quintic": "on quintics through the given velocities and accelerations",
        "program": "so that the tool keeps to the lines and arcs of its program",
        "program with zones": "so that the tool keeps to the lines, arcs and corner zones of its program",
    }[certified["joints"]]
    if certified["is_pose"] or certified["touches"]:
        return least_proven(certified)
    proven = f"{least_proven(certified)}, joints moving {way} between steps"
    if certified["upper_bound"] is None:  # only so much was asked, everywhere
        return proven
    end = seconds(certified["end"], certified.get("moves", ""))
    moment = f"between {seconds(certified['start'])} and {end}"
    return f"{proven}; lowest {moment}, where {mm(certified['upper_bound'])} mm occurs"


def step_text(minimum: PairMinimum) -> str:
    """The step of a pair's least clearance; with + for a moment between that step and the next."""
    return f"{minimum.step}{'+' if minimum.between else ''}"
