"""What is suspect about a case, for commands whose answer has no verdict to say it in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from clearance.world.case import Case


def say_notices(case: Case) -> None:
    """Writes the notices of a case to the error output, the worst first; kinds that it accepts are left out."""
    from clearance.world.notice import Severity
    from clearance.world.plausibility import notices_of

    for notice in notices_of(case):
        if notice.severity is not Severity.SUSPECT or not notice.accepted_by(case.accept):
            click.echo(f"{notice.severity}: {case.name}: {notice.line}", err=True)
