"""What a file to convert holds, by its suffix and its first lines: a trajectory, a scene or poses.

Not for: reading it, which may find otherwise (`files`).
"""

from __future__ import annotations

import re
from pathlib import Path

from clearance.errors import BadInput, BadShape
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import FORMATS, Kind, foreign, formats_in
from clearance.formats.motion.bag_files import is_bag
from clearance.formats.text.file_start import LONGEST

CONVERTED = (Kind.TRAJECTORY, Kind.SCENE, Kind.POSES)
"""What can be converted."""

_DOCUMENTS = {".yaml", ".yml", ".json"}

_KEY = re.compile(rb"""(?:^|[{,])[ \t-]*(["']?)([A-Za-z_]+)\1[ \t]*:""", re.MULTILINE)
_COMMENT = re.compile(rb"(?:^|(?<=\s))#[^\n]*")
_QUOTED = re.compile(rb"""("(?:[^"\\\n]|\\.)*"|'[^'\n]*')([ \t]*:)?""")
"""Text in quotes, which may say anything where it is no key."""

_WANTED = "a trajectory, a scene or poses"


def kind_of(path: Path, files: InputFiles) -> Kind:
    """What a file holds.

    Raises:
        MissingFile: it is not there. BadSyntax: another kind of file, and what to do with it. BadShape: it is
        empty. BadInput: nothing says what it is.
    """
    if is_bag(path):
        return Kind.TRAJECTORY
    shown, head = files.shown(path), _head(path, files)
    if not head.removeprefix(b"\xef\xbb\xbf").strip():
        raise BadShape("the file is empty", where=shown, valid=_WANTED)
    known = formats_in(head, shown)
    kinds = [one.kind for one in known if one.kind in CONVERTED]
    if known and not kinds:
        raise foreign(known[0], shown, _WANTED)
    if kinds:
        return kinds[0]
    if path.suffix.lower() not in _DOCUMENTS:
        return Kind.TRAJECTORY
    found = _of_keys(head)
    if found is None:
        raise BadInput(
            "it cannot be told what this file holds",
            where=shown,
            valid=f"--kind says it: {', '.join(CONVERTED)}",
        )
    return found


def _head(path: Path, files: InputFiles) -> bytes:
    opened, _ = files.unread(path)
    with opened() as file:
        return file.read(LONGEST)


def _of_keys(head: bytes) -> Kind | None:
    """By the first key that only one of them has; nested ones count, since messages hold messages."""
    says = {key: one.kind for one in FORMATS for key in one.keys}
    keys = _QUOTED.sub(lambda text: text[0] if text[2] else b"", _COMMENT.sub(b"", head))
    found = (says.get(key[2].decode()) for key in _KEY.finditer(keys))
    return next((kind for kind in found if kind is not None), None)
