"""The start of a file, and what its first lines show it to be. Not for: the formats (`known_formats`)."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePath

LONGEST = 65536
"""[bytes] Looked at."""

POSE_COLUMNS = ("time", "x", "y", "z", "qx", "qy", "qz", "qw")
"""The columns of a table of poses."""

_ROOT = re.compile(rb"\s*<(?:\w+:)?([A-Za-z_][\w.-]*)[\s/>]")

_BEFORE_ROOT = ((b"<?", b"?>"), (b"<!--", b"-->"), (b"<!", b">"))
"""How what may stand before the root element begins and ends."""


@dataclass(frozen=True)
class FileStart:
    """The first bytes of a file, without a byte order mark and blanks, and its suffix in small letters."""

    suffix: str
    text: bytes

    @classmethod
    def of(cls, data: bytes, shown: str) -> FileStart:
        """The start of a content; `shown` is the file's name."""
        return cls(suffix_of(shown), data[:LONGEST].removeprefix(b"\xef\xbb\xbf").lstrip())

    @property
    def is_xml(self) -> bool:
        """True for a file that begins with an element, a declaration or a comment of XML."""
        return self.text.startswith(b"<")

    @cached_property
    def root(self) -> str:
        """The name of the root element; empty where there is none."""
        found = _ROOT.match(self.text, _root_begins(self.text)) if self.is_xml else None
        return found[1].decode() if found else ""

    @cached_property
    def keys(self) -> frozenset[bytes]:
        """The keys of mappings at the begin of lines, at any depth; none in XML."""
        if self.is_xml:
            return frozenset()
        return frozenset(re.findall(rb"^[ \t{-]*\"?([a-z_]+)\"?:", self.text, re.MULTILINE))


def suffix_of(shown: str) -> str:
    """The suffix of a file's name, in small letters."""
    return PurePath(shown).suffix.lower()


def is_xacro(start: FileStart) -> bool:
    """True for a robot with elements of xacro."""
    return start.root == "robot" and b"<xacro:" in start.text


def is_srdf(start: FileStart) -> bool:
    """True for a robot with groups, and without what only URDF has."""
    groups = re.search(rb"<(disable_collisions|group|virtual_joint|end_effector)\b", start.text)
    parts = re.search(rb"<(parent|visual|collision|inertial)\b", start.text)
    return start.root == "robot" and not is_xacro(start) and bool(groups) and not parts


def is_urdf(start: FileStart) -> bool:
    """True for any other robot."""
    return start.root == "robot" and not is_xacro(start) and not is_srdf(start)


def has_root(*names: str) -> Callable[[FileStart], bool]:
    """Whether a file's root element has one of these names."""
    return lambda start: start.root in names


def has_keys(*keys: bytes) -> Callable[[FileStart], bool]:
    """Whether a file has all of these keys, at any depth."""
    return lambda start: start.keys.issuperset(keys)


def is_moveit_scene(start: FileStart) -> bool:
    """True for the text that MoveIt's RViz plugin writes."""
    is_text = start.suffix == ".scene" or re.match(rb"[^\n:{]*\n\* \S", start.text)
    return not start.is_xml and bool(is_text)


def is_pose_table(start: FileStart) -> bool:
    """True for a first line that names all columns of a table of poses, in whatever units and order."""
    words = set(re.split(rb"[^a-z]+", start.text.split(b"\n", 1)[0].lower()))
    return not start.is_xml and {name.encode() for name in POSE_COLUMNS} <= words


def is_case(start: FileStart) -> bool:
    """True for keys that only a case file has beside each other, in the first column."""
    text = b"" if start.is_xml else start.text.removeprefix(b"{")
    keys = set(re.findall(rb"^\"?([a-z]+)\"?:", text, re.MULTILINE))
    return not keys.isdisjoint((b"robot", b"robots")) and not keys.isdisjoint(
        (b"scene", b"trajectory", b"limits")
    )


def _root_begins(start: bytes) -> int:
    """Where the root element begins, behind declarations and comments; at the end if they do not end."""
    at = 0
    while True:
        while at < len(start) and start[at : at + 1].isspace():
            at += 1
        ends = next((end for begin, end in _BEFORE_ROOT if start.startswith(begin, at)), None)
        if ends is None:
            return at
        found = start.find(ends, at)
        if found < 0:
            return len(start)
        at = found + len(ends)
