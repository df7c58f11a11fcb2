"""All that a report is made of, as data. Not for: working it out, which whoever asks for a report does before."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.findings.finding import Finding
from clearance.findings.findings_file import FindingList
from clearance.findings.judgement import Judgement
from clearance.findings.verdict import Verdict
from clearance.record.details import RunDetails
from clearance.record.record import Record


@dataclass(frozen=True, eq=False)
class ReportData:
    """A record and what it comes to.

    Attributes:
        of_tolerances: the limits that are not proven with the case's tolerances.
    """

    record: Record
    details: RunDetails
    judgement: Judgement
    of_tolerances: tuple[Finding, ...]
    findings: FindingList
    verdict: Verdict
