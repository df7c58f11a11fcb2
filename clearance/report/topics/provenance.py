"""What a result rests on: files that were read, versions that computed it, counters, and who signs.

Paths are written so that the same inputs give the same report on every machine: relative to the
case file, or as `package:path` for files that an installed package brings.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from importlib import metadata
from pathlib import Path, PurePosixPath
from typing import Any

from clearance import __version__
from clearance.report.blocks import Inline, Paragraph, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.topic import Topic
from clearance.world.case import Case

LIBRARIES = ("numpy", "scipy", "trimesh", "lxml", "pybullet", "python-fcl", "pyarrow", "meshcat")


def data(model: ReportModel) -> dict[str, Any]:
    """Files, versions, counters, fields to sign."""
    case = model.record.case
    return {
        "tally": dict(model.record.tally),
        "sign_off": None if case.sign_off is None else asdict(case.sign_off),
        "inputs": inputs(case),
        "versions": versions(),
    }


def versions() -> dict[str, str]:
    """Versions of this package, of Python and of the libraries that can change a figure."""
    found = {"clearance": __version__, "python": platform.python_version()}
    return found | {name: _version(name) for name in LIBRARIES}


@cache
def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "unknown"


def inputs(case: Case) -> list[dict[str, object]]:
    """Path, size and sha256 of every file that was read, in the order it was read."""
    home = _home(case)
    return [
        {"path": public_path(source.path, home), "sha256": source.sha256, "n_bytes": source.n_bytes}
        for source in case.sources
        if source.is_file
    ]


def public_origin(case: Case, origin: str) -> str:
    """The origin of a body with any path in it as `public_path` writes it."""
    return ", ".join(public_path(part.strip(), _home(case)) for part in origin.split(","))


def public_path(path: str, home: Path | None) -> str:
    """`path` without what is particular to this machine.

    Args:
        home: folder of the case file, absolute, or None where it is not known.
    """
    if not os.path.isabs(path):
        return path
    parts = PurePosixPath(Path(path).as_posix()).parts
    for folder in ("site-packages", "dist-packages"):
        if folder in parts:
            inside = parts[parts.index(folder) + 1 :]
            return f"{inside[0]}:{'/'.join(inside[1:])}" if len(inside) > 1 else inside[0]
    return Path(os.path.relpath(path, home)).as_posix() if home else parts[-1]


def _home(case: Case) -> Path | None:
    first = next((Path(source.path) for source in case.sources if source.is_file), None)
    return first.parent if first is not None and first.is_absolute() else None


def sections(content: PageContent) -> Iterator[Section]:
    """Files with their sha256, versions, counters; room to sign where the case has such fields."""
    summary = content.summary
    files = [
        Row([one["path"], number(f"{one['n_bytes']:,}"), Inline(one["sha256"], element="code")])
        for one in summary["inputs"]
    ]
    programs = ", ".join(f"{name} {version}" for name, version in summary["versions"].items())
    counted = ", ".join(f"{name.replace('_', ' ')} {n:,}" for name, n in summary["tally"].items())
    table = Table(("File", ">Bytes", "sha256"), files, "bodies")
    counters = [faint(f"Counted: {counted}.")] if counted else []
    yield Section("Where this comes from", [table, faint(programs), *counters])
    signed = summary["sign_off"]
    if signed is not None:
        roles = {"Author": signed["author"], "Checked": "", "Approved": ""}
        rows = [Row([Inline(role, element="strong"), name, "", ""]) for role, name in roles.items()]
        revision = [Paragraph(f"Revision {signed['revision']}")] if signed["revision"] else []
        fields = Table(("", "Name", "Date", "Signature"), rows, "sign-off")
        yield Section("Sign-off", [*revision, fields])


TOPIC: Topic = Topic(data, sections=sections)
