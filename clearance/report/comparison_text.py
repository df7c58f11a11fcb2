"""What became of findings since a baseline, in words. Not for: comparing (`findings.comparison`)."""

from __future__ import annotations

from clearance.findings.comparison import Compared, Comparison
from clearance.report.finding_text import bodies_text
from clearance.report.rules import name_shown
from clearance.report.wording import mm

HEADS = ("change", "before", "now", "before, mm", "now, mm", "rule", "between", "why")
"""What `comparison_cells` are."""


def comparison_text(comparison: Comparison) -> str:
    """How many findings are new, worse, and so on: `1 new, 2 unchanged`."""
    told = ", ".join(f"{number} {what}" for what, number in comparison.counts.items())
    why = f"; not comparable: {comparison.whole}" if comparison.whole else ""
    other = ""
    if comparison.before != comparison.now:
        other = f" ({comparison.before!r} against {comparison.now!r})"
    return f"since the baseline{other}: {told or 'nothing to compare'}{why}"


def comparison_cells(row: Compared) -> tuple[str, ...]:
    """A row of a table with `HEADS`."""
    finding = row.finding
    both = (row.before, row.now)
    statuses = ["" if one is None else one.status for one in both]
    least = ["" if one is None or one.clearance is None else mm(one.clearance) for one in both]
    who = bodies_text(finding) or finding.text or finding.kind
    return (str(row.change), *statuses, *least, name_shown(finding.rule), who, row.why)


def gone_text(row: Compared) -> str:
    """A finding that only the baseline has, in one line."""
    before = row.finding
    least = "" if before.clearance is None else f", {mm(before.clearance)} mm in the baseline"
    why = f" ({row.why})" if row.why else ""
    return (
        f"{row.change}: {bodies_text(before) or before.kind}, {name_shown(before.rule)}{least}{why}"
    )


def since_text(row: Compared | None) -> str:
    """What became of a finding, and its clearance before, in a few words."""
    if row is None:
        return ""
    before = None if row.before is None else row.before.clearance
    was = "" if before is None else f", was {mm(before)} mm"
    return f"{row.change}{was}{f': {row.why}' if row.why else ''}"
