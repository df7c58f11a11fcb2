"""What became of findings since a baseline, in words. Not for: comparing (`findings.comparison`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from clearance.codes import coded
from clearance.findings.comparison import ComparedDoubt, ComparedFinding, Comparison
from clearance.findings.doubts import ACCEPTED, NOTE, Doubt
from clearance.findings.finding import Finding
from clearance.findings.finding_text import bodies_text, waived_text, who_text
from clearance.record.wording import count, near_mm
from clearance.report.moment import name_shown
from clearance.world.notice import listed

HEADS = ("change", "before", "now", "before, mm", "now, mm", "rule", "between", "why")
"""What `comparison_cells` are."""


MOST_NOTES = 4
"""Notes of one run alone that are listed; more are counted."""


def comparison_text(comparison: Comparison) -> str:
    """How many findings are new, worse, and so on: `1 new, 2 unchanged`; what puts that in doubt goes before."""
    counts = ", ".join(f"{number} {what}" for what, number in comparison.counts.items())
    why = f"; not comparable: {comparison.whole}" if comparison.whole else ""
    other = ""
    if comparison.before != comparison.now:
        other = f" ({comparison.before!r} against {comparison.now!r})"
    doubt = "".join(f"{text}; " for text in _in_doubt(comparison))
    return f"since the baseline{other}: {doubt}{counts or 'no finding to compare'}{why}"


def _in_doubt(comparison: Comparison) -> list[str]:
    """Why a comparison does not pass, and what of it is in doubt whatever its findings say, a few words each."""
    rows = comparison.doubts
    n_broken = sum(row.alarms for row in comparison.rows)
    kinds = dict.fromkeys(row.doubt.kind for row in rows if row.alarms)
    parts = [f"BREAKS A RULE in {count(n_broken, 'finding')}"] * bool(n_broken)
    parts += [
        f"NEW {_many(kind, [r for r in rows if r.alarms and r.doubt.kind == kind])}"
        for kind in kinds
    ]
    parts += ["LESS IS KNOWN"] * bool(comparison.less)
    n_excused = len(comparison.excused)
    parts += [f"{count(n_excused, 'finding')} newly waived"] * bool(n_excused)
    unchanged = [row for row in rows if row.doubt.fails and row.before and row.now]
    kinds = dict.fromkeys(row.doubt.kind for row in unchanged)
    parts += [
        f"{_many(kind, [r for r in unchanged if r.doubt.kind == kind])} as before" for kind in kinds
    ]
    return parts


def _many(kind: str, rows: list[ComparedDoubt]) -> str:
    name = _NAMES.get(kind, kind)
    return name if len(rows) == 1 else f"{name} ({len(rows)})"


_NAMES = {
    "suspect": "suspect input",
    "disputed": "dispute with a peer",
    "not checked": "part not checked",
}
"""Kinds of doubts as a headline calls them."""


def doubt_lines(comparison: Comparison) -> list[str]:
    """Lines: what is known less, a shorter motion, what is newly waived, and each doubt that changed or fails the
    run as before.
    """
    lines = [f"less is known: {text}" for text in comparison.less]
    lines += [*comparison.shorter, *_newly_waived(comparison)]
    rows = [row for row in comparison.doubts if row.doubt.fails or row.change != "as before"]
    notes = Counter(row.change for row in rows if row.doubt.kind == NOTE)
    only_counted = notes["new"] + notes["gone"] > MOST_NOTES
    for row in rows:
        if row.doubt.kind != NOTE or not (only_counted or row.change == "changed"):
            lines.append(f"{row.change}: {doubt_text(row.doubt)}")
    if only_counted:
        lines.append(f"notes: {notes['new']} new, {notes['gone']} gone")
    return lines


def _newly_waived(comparison: Comparison) -> Iterator[str]:
    """A line for each waiver, with the bodies."""
    waived: dict[str, list[str]] = {}
    for one in comparison.excused:
        waived.setdefault(waived_text(one), []).append(bodies_text(one) or one.kind)
    for text, bodies in waived.items():
        yield f"newly waived: {listed(bodies)}: {text.removeprefix('waived ')}"


def doubt_text(doubt: Doubt) -> str:
    """A doubt in one line, its kind before."""
    about = f" {doubt.about}" if doubt.about and doubt.kind not in (ACCEPTED, NOTE) else ""
    return coded(f"{doubt.kind}{about}: {doubt.text}", doubt.code)


def comparison_cells(row: ComparedFinding, unit: str = "") -> tuple[str, ...]:
    """A row of a table with `HEADS`."""
    finding = row.finding
    both = (row.before, row.now)
    statuses = ["" if one is None else _standing(one) for one in both]
    least = ["" if one is None else _near(one, unit) for one in both]
    who = name_shown(finding.rule), who_text(finding)
    return (str(row.change), *statuses, *least, *who, row.why)


def _standing(finding: Finding) -> str:
    """The status of a finding, and what lets it be so."""
    excuse = ", waived" if finding.waived else ", accepted" if finding.accepted else ""
    return f"{finding.status}{excuse}"


def _near(finding: Finding, unit: str = "") -> str:
    """The least clearance of a finding; empty where it has none."""
    return "" if finding.clearance is None else near_mm(finding.clearance, finding.status, unit)


def gone_text(row: ComparedFinding) -> str:
    """A finding that only the baseline has, in one line."""
    before = row.finding
    near = _near(before, " mm")
    least = f", {near} in the baseline" if near else ""
    why = f" ({row.why})" if row.why else ""
    return (
        f"{row.change}: {bodies_text(before) or before.kind}, {name_shown(before.rule)}{least}{why}"
    )


def since_text(row: ComparedFinding | None) -> str:
    """What became of a finding, and its clearance before, in a few words."""
    if row is None:
        return ""
    before = "" if row.before is None else _near(row.before, " mm")
    was = f", was {before}" if before else ""
    return f"{row.change}{was}{f': {row.why}' if row.why else ''}"
