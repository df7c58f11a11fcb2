"""A case, or a report, that came as one zip with all files that it needs: unpacked, checked, read in its place.

A zip may come from anybody. So its list is held against its content: names, number, size, sha256. It is unpacked
into a folder of its own, which goes when the process ends. Not for: packing (`packing`).
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field

from clearance.errors import BadPack, at, names_within
from clearance.formats.files.input_files import regular_file
from clearance.formats.files.mesh_paths import VARIABLES
from clearance.formats.files.place import Place, reading_in
from clearance.formats.schema.strict_model import StrictModel, validated
from clearance.plain_yaml import parse_yaml
from clearance.world.case import Case

MANIFEST = "clearance-pack.json"
TREE, PACKAGES = "files", "packages"
"""Folders of a zip: of files that keep their places to each other, and of those that packages of Python bring."""

MOST_FILES = 20_000
LARGEST = 2**32
"""[bytes] Of all files, unpacked."""

SMALL, MOST_SHRUNK = 2**26, 200
"""[bytes] Up to here anything may be packed as small as it will; beyond, to no less than one part in so many."""

LONGEST_LIST = 2**24
"""[bytes]"""

METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)

DAMAGE = (zipfile.BadZipFile, zlib.error, EOFError, UnicodeError, RuntimeError, OSError)
"""What is raised on the way through a zip that is not in order."""

REMEDY = "a file as `clearance pack` wrote it"

Digest = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Manifest(StrictModel):
    """What a zip says of itself.

    Attributes:
        entry: the case file, or the folder of a report, in the zip. files: sha256 by name in the zip.
        reads: path and sha256 of each source of the case, searches included; none of a report.
        stands_for, variables: as in `Place`, of the folder `TREE`. versions: of what packed it.
    """

    format: Literal[1]
    entry: str
    files: Annotated[dict[str, Digest], Field(max_length=MOST_FILES)]
    reads: list[Annotated[list[str], Field(min_length=2, max_length=2)]]
    stands_for: str
    variables: dict[str, list[str]]
    versions: dict[str, str]


@dataclass(frozen=True, eq=False)
class Unpacked:
    """A zip whose files lie in a folder, which goes when the process ends."""

    path: Path
    manifest: Manifest
    folder: Path

    @property
    def entry(self) -> Path:
        """The case file, or the folder of a report."""
        return self.folder / self.manifest.entry

    @property
    def place(self) -> Place:
        """Where what its files name is found."""
        tree, given = self.folder / TREE, self.manifest.variables
        values = {
            name: os.pathsep.join(str(tree / part) for part in parts)
            for name, parts in given.items()
        }
        packages = self.folder / PACKAGES
        return Place(str(tree), packages, self.manifest.stands_for, values)

    def checked(self, case: Case) -> Case:
        """The case that was read, with the zip as the file of all its sources.

        Raises:
            BadPack: it was read from other files than the zip lists.
        """
        listed_files = {path: sha256 for path, sha256 in self.manifest.reads}
        read = {one.path: one.sha256 for one in case.sources}
        for path in [*listed_files, *read]:
            if listed_files.get(path) != read.get(path):
                problem = "is not what it was when it was packed"
                problem = "is read, and not packed" if path not in listed_files else problem
                raise BadPack(f"{path!r} {problem}", valid=REMEDY)
        for one in case.sources:
            if one.is_file and not Path(one.read_from).is_relative_to(self.folder):
                raise BadPack(f"{one.path!r} is read from outside", valid=REMEDY)
        sources = tuple(replace(one, read_from=str(self.path)) for one in case.sources)
        return replace(case, sources=sources)


def is_zip(path: Path) -> bool:
    """True for a file that is a zip, or is called so; False for what cannot be read."""
    try:
        with regular_file(path) as file:
            return path.suffix.lower() == ".zip" or file.read(4) == b"PK\3\4"
    except (OSError, ValueError):
        return False


@contextmanager
def unpacked(path: Path) -> Iterator[Unpacked | None]:
    """The zip at a path, unpacked, while names lead into it; None for another file or a folder.

    Raises:
        BadPack: a zip that is damaged, or that `clearance pack` has not written.
    """
    if not is_zip(path):
        yield None
        return
    with at(path.name):
        with regular_file(path) as file:
            found = _unpacked(path, hashlib.file_digest(file, "sha256").hexdigest())
        with reading_in(found.place):
            yield found


_FOLDERS: set[Path] = set()
"""All that this process has unpacked."""


@contextmanager
def unpacked_for_now() -> Iterator[None]:
    """Removes at its end all that is unpacked meanwhile."""
    before = {*_FOLDERS}
    try:
        yield
    finally:
        for folder in _FOLDERS - before:
            shutil.rmtree(folder, ignore_errors=True)
            _unpacked.cache_clear()
        _FOLDERS.intersection_update(before)


@cache
def _unpacked(path: Path, sha256: str) -> Unpacked:
    """The zip with this sha256; once in a process."""
    folder = Path(tempfile.mkdtemp(prefix="clearance-"))
    names_within(folder)
    _FOLDERS.add(folder)
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    try:
        with zipfile.ZipFile(path) as archive:
            manifest = _manifest(archive, path.stat().st_size)
            for name, digest in manifest.files.items():
                target = folder / name
                target.parent.mkdir(parents=True, exist_ok=True)
                _write(archive, name, digest, target)
    except DAMAGE as error:
        fault = f"the zip is damaged or cut off, or cannot be unpacked ({error})"
        raise BadPack(fault, valid=REMEDY) from None
    if not (folder / manifest.entry).exists():
        raise BadPack(f"there is no {manifest.entry!r} in it", valid=REMEDY)
    return Unpacked(path, manifest, folder)


def _manifest(archive: zipfile.ZipFile, n_bytes: int) -> Manifest:
    """The list of a zip, which is that of its files.

    Args:
        n_bytes: of the zip.

    Raises:
        BadPack: the zip is none of ours, too large, or has other files than those of its list.
    """
    members = {one.filename: one for one in archive.infolist()}
    total = sum(one.file_size for one in members.values())
    if MANIFEST not in members:
        raise BadPack("this zip holds no packed case", valid=REMEDY)
    if len(archive.infolist()) > MOST_FILES + 1 or total > LARGEST:
        size = f"{len(archive.infolist())} files of {total} bytes"
        raise BadPack(size, valid=f"at most {MOST_FILES} files, {LARGEST} bytes")
    if total > max(SMALL, MOST_SHRUNK * n_bytes):
        raise BadPack(
            f"{total} bytes in a zip of {n_bytes}", valid=f"at most {MOST_SHRUNK} times as many"
        )
    if members[MANIFEST].file_size > LONGEST_LIST:
        raise BadPack("its list is too long", valid=f"at most {LONGEST_LIST} bytes")
    if any(one.compress_type not in METHODS for one in members.values()):
        raise BadPack("it is compressed in another way", valid=REMEDY)
    text = archive.read(MANIFEST)
    manifest = validated(Manifest, parse_yaml(text, MANIFEST), MANIFEST)
    if sorted([*manifest.files, MANIFEST]) != sorted(one.filename for one in archive.infolist()):
        raise BadPack("its files are not those of its list", valid=REMEDY)
    _require_plain(members, manifest)
    return manifest


def _require_plain(members: Mapping[str, zipfile.ZipInfo], manifest: Manifest) -> None:
    """Nothing, if each name stays below the folder and each member is a plain file.

    Raises:
        BadPack: the first that does not, or is not.
    """
    below = [f"{TREE}/{part}" for parts in manifest.variables.values() for part in parts]
    for name in [manifest.entry, *manifest.files, *below]:
        parts = name.split("/")
        if (
            {"", ".", ".."} & {*parts}
            or parts[0] not in (TREE, PACKAGES)
            or "\\" in name
            or not name.isprintable()
        ):
            raise BadPack(f"the name {name!r:.80} leads outside", valid=REMEDY)
    for one in members.values():
        if stat.S_IFMT(one.external_attr >> 16) not in (0, stat.S_IFREG) or one.is_dir():
            raise BadPack(f"{one.filename!r:.80} is a link or no file", valid=REMEDY)
    if not set(manifest.variables) <= set(VARIABLES):
        raise BadPack("a variable that does not lead to packages", valid=", ".join(VARIABLES))


def _write(archive: zipfile.ZipFile, name: str, digest: str, target: Path) -> None:
    """Writes a member of a zip, no longer than the zip says, into a file."""
    left, found = archive.getinfo(name).file_size, hashlib.sha256()
    with archive.open(name) as member, target.open("xb") as file:
        while part := member.read(min(left + 1, 2**20)):
            left -= len(part)
            if left < 0:
                raise BadPack(f"{name!r:.80} is longer than it says", valid=REMEDY)
            found.update(part)
            file.write(part)
    if found.hexdigest() != digest:
        raise BadPack(f"{name!r:.80} is not as it was packed", valid=REMEDY)


def refuse_zip(path: Path) -> None:
    """Refuses a packed case where files beside it are written anew.

    Raises:
        BadPack: it is one.
    """
    if is_zip(path):
        raise BadPack("is a zip", where=str(path), valid="unzip it, and give its case file")


def require_entry(found: Unpacked, kind: str) -> Path:
    """The case file, or the folder of a report, of what was unpacked.

    Args:
        kind: "case" or "report".

    Raises:
        BadPack: it is the other.
    """
    is_case = found.entry.is_file()
    if is_case != (kind == "case"):
        what_for, commands = ("case", "check") if is_case else ("report", "view or verify")
        raise BadPack(f"a packed {what_for}", valid=f"clearance {commands} takes it")
    return found.entry
