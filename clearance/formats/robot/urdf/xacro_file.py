"""A xacro file to URDF, with the files, arguments and warnings that are to be told of it.

xacro evaluates Python, so a file is handed to it only where that is asked for, in a process of its own
(`xacro_process`, the one adapter of xacro). Its exceptions become errors of ours here. Not for: reading the URDF
(`robot`).
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from clearance.errors import BadSyntax, MissingFile, Unavailable, UnknownKey, nearest_name
from clearance.extras import install, is_installed
from clearance.formats.files.found_files import PACKAGE, note_lookup, notes_on_variables
from clearance.formats.files.input_files import InputFiles, regular_file
from clearance.formats.files.mesh_paths import VARIABLES
from clearance.formats.files.place import environment
from clearance.formats.robot.request import RobotRequest
from clearance.world.case import Source
from clearance.world.notice import listed

MOST_WORK = 30
"""[s] of processor time; the largest file seen takes 0.5 s."""

LONGEST = 2.0 * MOST_WORK
"""[s] of the clock, should the other limit not hold."""

MOST_MEMORY = 1 << 30
"""[bytes] That the process may have."""

_PROCESS = Path(__file__).with_name("xacro_process.py")


class ExpandedUrdf(NamedTuple):
    """A URDF document, and a line each on how it was made."""

    urdf: bytes
    notes: tuple[str, ...]


def expanded(request: RobotRequest, files: InputFiles) -> ExpandedUrdf:
    """The URDF that xacro makes of a file; all files that it reads are read through `files` too.

    Raises:
        BadInput: with the file and, where it is known, the line. UnknownKey: an argument that no file asks for.
        Unavailable: xacro is not installed.
    """
    if not is_installed("xacro"):
        raise Unavailable("a xacro file needs xacro, which is not installed", valid=install("ros"))
    shown = files.shown(request.path)
    files.read(request.path)
    done = _run(request, shown)
    for name in done.get("files", ()):
        if b"<!ENTITY" in files.read(Path(name)):
            fault, where = "an entity is declared, which stands for something", Path(name)
            raise BadSyntax(fault, where=files.shown(where), valid="write it out")
    if "problem" in done:
        _refuse(done, shown, files)
    given = dict(request.xacro_args)
    _require_asked(given, done["asked"], shown)
    for package, folder in done["packages"].items():
        asked = package, request.path.parent, request.package_dirs
        note_lookup(files, PACKAGE, *asked, Path(folder))
    others = [files.shown(Path(name)) for name in done["files"]]
    found = {
        variable: {f"$(find {name})": files.shown(Path(path)) for name, path in names.items()}
        for variable, names in done["variables"].items()
    }
    notes = [
        _note(
            shown, [name for name in others if name != shown], given, _shown(done["args"], files)
        ),
        *notes_on_variables(found),
        *_warnings(done["said"], shown, request.path.parent),
    ]
    return ExpandedUrdf(done["urdf"].encode(), tuple(notes))


def _run(request: RobotRequest, shown: str) -> dict[str, Any]:
    """What the process answers, and what it wrote beside that."""
    asked = {
        "path": os.path.abspath(request.path),
        "package_dirs": [os.path.abspath(folder) for folder in request.package_dirs],
        "args": dict(request.xacro_args),
        "modules": sys.path,
        "seconds": MOST_WORK,
        "bytes": MOST_MEMORY,
    }
    command = [sys.executable, "-P", str(_PROCESS)]
    try:
        done = subprocess.run(
            command,
            input=json.dumps(asked).encode(),
            capture_output=True,
            timeout=LONGEST,
            env={**os.environ, **dict.fromkeys(VARIABLES, ""), **environment()},
        )
        answer: dict[str, Any] = json.loads(done.stdout)
    except (subprocess.SubprocessError, OSError, ValueError) as error:
        ended = isinstance(error, ValueError)
        reason = f"it ends after {MOST_WORK} s of work" if ended else type(error).__name__
        raise BadSyntax(
            f"xacro came to no end ({reason})", where=shown, valid="a file that it can evaluate"
        ) from None
    return answer | {"said": done.stderr.decode(errors="replace")}


def _refuse(done: Mapping[str, Any], shown: str, files: InputFiles) -> None:
    """Raises what stopped xacro, at the file and the line that it was in."""
    name, line, missing = done["file"], done["line"], done["missing"]
    inner = "" if name is None else files.shown(Path(name))
    places = [shown, "" if inner == shown else inner, f"line {line}" if line else ""]
    where = ": ".join(place for place in places if place)
    if missing is not None:
        raise MissingFile(
            f"there is no file {files.shown(Path(missing))!r}",
            where=where,
            valid="it is included; is it in another package or branch?",
        )
    raise BadSyntax(f"xacro: {done['problem']}", where=where, valid=done["valid"])


def _require_asked(given: Mapping[str, str], asked: list[str], shown: str) -> None:
    for name in given:
        if name not in asked:
            raise UnknownKey(
                f"nothing in it asks for the argument {name!r}",
                where=shown,
                valid=nearest_name(name, asked),
            )


_SWITCH = re.compile(r"true|false|\d+", re.IGNORECASE)
"""A value that may say which links there are; others mostly name files and places."""


def _note(shown: str, others: list[str], given: Mapping[str, str], used: Mapping[str, str]) -> str:
    also = f" and in {listed(others, 2)}" if others else ""
    text = f"{shown}: xacro evaluated it, with the Python in it{also}"
    own = [f"{name}:={value}" for name, value in given.items()]
    switches = sorted(used.items(), key=lambda one: not _SWITCH.fullmatch(one[1]))
    defaults = [f"{name}:={value}" for name, value in switches if name not in given]
    text += f"; arguments {listed(own, 12)}" if own else ""
    return text + (f"; defaults {listed(defaults, 8)}" if defaults else "")


def _shown(args: Mapping[str, str], files: InputFiles) -> dict[str, str]:
    """Arguments with paths as they are on every machine."""
    return {
        name: files.shown(Path(value)) if os.path.isabs(value) else value
        for name, value in args.items()
    }


def expand_xacro(path: Path, package_dirs: Sequence[Path], files: InputFiles) -> tuple[str, ...]:
    """Lets `files` give what xacro makes of a file beside the robot's in place of its content; notes on that.

    Raises:
        BadInput: as `expanded`.
    """
    made = expanded(RobotRequest(path, tuple(package_dirs), xacro=True), files)
    files.put(path, made.urdf)
    return made.notes


def _warnings(said: str, shown: str, folder: Path) -> list[str]:
    """A note on the warnings of xacro, the first in words."""
    lines = [
        line.removeprefix("warning: ") for line in said.splitlines() if line.startswith("warning: ")
    ]
    if not lines:
        return []
    others = f" and {len(lines) - 1} more" if len(lines) > 1 else ""
    return [f"{shown}: xacro warns: {lines[0].replace(f'{os.path.abspath(folder)}/', '')}{others}"]


_SUFFIXES = frozenset({".xacro", ".xml", ".urdf"})

_ASKED = re.compile(rb"\$\(\s*(?:opt)?env\s+([A-Za-z_]\w*)")


def variables_asked(sources: Iterable[Source]) -> tuple[str, ...]:
    """The names of the variables that some files ask for, sorted."""
    files = [one for one in sources if os.path.splitext(one.read_from)[1].lower() in _SUFFIXES]
    return tuple(sorted({name for one in files for name in _in_file(one.read_from, one.sha256)}))


@lru_cache(maxsize=256)
def _in_file(path: str, sha256: str) -> frozenset[str]:
    """Those of one file, by its content; of one that is gone none, and its case is then measured again."""
    try:
        with regular_file(Path(path)) as file:
            return frozenset(name.decode() for name in _ASKED.findall(file.read()))
    except OSError:
        return frozenset()
