"""What is suspect about a case, for commands whose answer has no verdict to say it in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from clearance.world.case import Case


def say_notices(case: Case, *, quiet: bool = False) -> bool:
    """Writes the notices of a case to the error output, the worst first; kinds that it accepts are left out.

    True if one of them is suspect; if quiet, only these are written.
    """
    from clearance.world.notice import Severity
    from clearance.world.plausibility import notices_of

    is_suspect = False
    for notice in notices_of(case):
        suspect = notice.severity is Severity.SUSPECT
        if notice.accepted_by(case.accept) if suspect else quiet:
            continue
        click.echo(f"{notice.severity}: {case.name}: {notice.line}", err=True)
        is_suspect |= suspect
    return is_suspect
