"""What was found of one section. Not for: what sections come to together (`run_answer`)."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.simulate.certificate import Certificate
from clearance.simulate.measurement import Measurement
from clearance.simulate.sections import Section


@dataclass(frozen=True, eq=False)
class SectionAnswer:
    """What was found of a section; pairs and steps are the section's own, distances without padding."""

    section: Section
    found: Measurement
    certificate: Certificate | None
