"""A file that is a case, or lists cases by patterns: which cases it means; and which lie in a folder.

Not for: reading them (`case_file`).
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from clearance.case.packed import is_zip
from clearance.errors import NEAREST_NAMES, BadInput, MissingFile
from clearance.formats.files.input_files import read_bytes
from clearance.plain_yaml import parse_yaml
from clearance.world.notice import naming

CASES = "cases"
"""The key of a file that lists cases, by patterns seen from its folder."""


def cases_in(path: Path) -> list[Path]:
    """The cases that a file lists, each once, in the order of its patterns; itself where it is a case.

    Raises:
        BadInput: other keys beside the list, or a pattern outside the folder. MissingFile: nothing matches.
    """
    if is_zip(path):
        return [path]
    content = mapping_in(path)
    if CASES not in content:
        return [path]
    patterns = content[CASES]
    if set(content) != {CASES} or not isinstance(patterns, list) or not patterns:
        valid = "cases: [a pattern, …] and nothing else, or a case"
        raise BadInput("no list of cases", where=path.name, valid=valid)
    found: dict[Path, None] = {}
    for i, pattern in enumerate(patterns):
        found |= dict.fromkeys(_matching(pattern, path, f"{path.name}: {CASES}[{i}]"))
    return list(found)


_OF_CASE = re.compile(rb"^(robots?|cell)\s*:", re.MULTILINE)
"""A key at the start of a line that case files have."""


def refuse_folder(path: Path) -> None:
    """Refuses a folder where a case file is needed, and names the cases in it.

    Raises:
        MissingFile: it is one.
    """
    if not os.path.isdir(path):
        return
    found = [*path.glob("*.yaml"), *path.glob("*.yml"), *path.glob("*/case.yaml")]
    cases = [one for one in sorted(found) if one.is_file() and _OF_CASE.search(one.read_bytes())]
    inside = [one for one in cases if one.parent == path] or cases
    named = [one for one in inside if one == path / "case.yaml"] or inside
    valid = naming("a case in it", [*map(str, named)], NEAREST_NAMES)
    raise MissingFile(
        f"{str(path)!r} is a folder",
        valid="".join(valid) or "no case is in it; a case file is needed",
    )


def mapping_in(path: Path) -> dict[str, Any]:
    """What is in a YAML file, unchecked.

    Raises:
        MissingFile, BadSyntax: no YAML file. BadInput: no mapping is in it.
    """
    refuse_folder(path)
    content = parse_yaml(read_bytes(path, path.name), path.name)
    if not isinstance(content, dict):
        raise BadInput("no mapping", where=path.name, valid="a case, or cases: [a pattern, …]")
    return content


def _matching(pattern: object, path: Path, where: str) -> list[Path]:
    outside = not isinstance(pattern, str) or Path(pattern).is_absolute() or ".." in pattern
    if outside or not pattern:
        raise BadInput(
            f"{pattern!r:.60} is given",
            where=where,
            valid="a pattern below the folder of the list, without `..`",
        )
    found = sorted(path.parent.glob(str(pattern)))
    matching = [one for one in found if not one.is_dir() and one != path]
    if not matching:
        valid = "a pattern of case files"
        raise MissingFile(f"no file is called {pattern!r}", where=where, valid=valid)
    return matching
