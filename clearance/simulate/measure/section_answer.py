"""What was found of one section. Not for: what sections come to together (`run_answer`)."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion
from clearance.simulate.measure.sections import Section


@dataclass(frozen=True, eq=False)
class SectionAnswer:
    """What was found of a section; pairs and steps are the section's own, distances without padding."""

    section: Section
    found: MeasuredSteps
    certificate: ProvenMotion | None
