"""A case checked as pytest's options say. Not for: which cases there are (`collected`)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from clearance.options import options_in
from clearance.pytest_plugin import PREFIX, USUAL
from clearance.run import CheckOptions, Run, check


def check_case(path: Path, config: pytest.Config) -> Run:
    """The run of a case; its report is written where `--clearance-out` says.

    Raises:
        BadInput: with the file and the field.
    """
    given = {name: config.getoption(f"{PREFIX}{name}", None) for name in options_in(CheckOptions)}
    said = {name: one for name, one in given.items() if one is not None}
    run = check(path, **USUAL | said)
    folder = report_folder(path, config)
    if folder is not None:
        run.save(folder)
    return run


def report_folder(path: Path, config: pytest.Config) -> Path | None:
    """Where the report of a case goes; None where none is wanted."""
    out = config.getoption("--clearance-out")
    if not out:
        return None
    path = path.absolute()
    known = path.relative_to(config.rootpath) if path.is_relative_to(config.rootpath) else path
    return (
        config.invocation_params.dir / out / re.sub(r"[^\w.-]+", "-", known.as_posix().strip("/"))
    )
