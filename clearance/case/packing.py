"""One zip of a case and all files that it was made from, or of a report and those of its case.

A case says which files it read, so what is packed follows from it. The zip is read back before it is kept: it
gives the same sources, or there is none. Same input, same bytes. Not for: reading it (`packed`).
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from clearance.case.case_file import load_case
from clearance.case.packed import MANIFEST, PACKAGES, TREE, refuse_zip, unpacked
from clearance.errors import BadPack
from clearance.files import written_file
from clearance.formats.files.brought import is_brought
from clearance.formats.files.input_files import regular_file
from clearance.formats.files.mesh_paths import is_package, variables_of
from clearance.formats.robot.urdf.xacro_file import variables_asked
from clearance.world.case import LOOKUP, Source

LONGEST_TEXT = 2**26
"""[bytes] No longer file names others."""

BEGIN = (1980, 1, 1, 0, 0, 0)
"""The time of all files in a zip."""


@dataclass(frozen=True)
class Contents:
    """What is packed.

    Attributes:
        entry: the case file, or the folder of a report.
        case_file: of a report that of its receipt; None where it has none.
        sources: of the case. others: files beside these.
    """

    entry: Path
    case_file: Path | None
    sources: Sequence[Source]
    others: Sequence[Path] = ()

    @property
    def named_folders(self) -> list[str]:
        """The folders whose names count: a report's, and a case's, which may be called so."""
        case = self.case_file and os.path.dirname(os.path.abspath(self.case_file))
        return [one for one in (os.path.abspath(self.entry), case) if one]

    @property
    def is_case(self) -> bool:
        """False for a report."""
        return self.entry == self.case_file


def case_contents(case_file: Path) -> Contents:
    """A case and all that it reads.

    Raises:
        BadInput: it cannot be read, or is packed already.
    """
    refuse_zip(case_file)
    return Contents(case_file, case_file, load_case(case_file).sources)


def write_pack(contents: Contents, target: Path, versions: Mapping[str, str]) -> int:
    """Writes a zip; returns how many files are in it.

    Raises:
        BadPack: not all can be read from a zip. Unwritable: there is no way to write.
    """
    _refuse_variables(contents.sources)
    files, manifest = _listed(contents)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder, target.name)
        _write_zip(made, {**manifest, "versions": dict(versions)}, files)
        if contents.is_case:
            load_case(made)
        else:
            with unpacked(made):
                pass
        with made.open("rb") as file, written_file(target) as whole:
            shutil.copyfileobj(file, whole)
    return len(files)


def _refuse_variables(sources: Iterable[Source]) -> None:
    """Refuses files that mean something else on another machine."""
    asked = variables_asked(one for one in sources if one.is_file)
    if asked:
        variables = ", ".join(f"${name}" for name in asked)
        raise BadPack(
            f"a xacro file asks for {variables}, which is another on every machine",
            valid="an argument of the robot (xacro_args) in its place",
        )


def _listed(contents: Contents) -> tuple[dict[str, str], dict[str, object]]:
    """The files by name in the zip, and what is told of them."""
    sources = [one for one in contents.sources if one.is_file]
    brought = {
        f"{PACKAGES}/{one.path.replace(':', '/', 1)}": one.read_from
        for one in sources
        if is_brought(one.path)
    }
    own = [one.read_from for one in sources if one.read_from not in brought.values()]
    own += [os.path.abspath(one) for one in contents.others]
    packages = _package_folders(own, contents.sources)
    own += [one for folder in packages if os.path.isfile(one := f"{folder}/package.xml")]
    variables = variables_of(own)
    inside = [*own, *packages, *contents.named_folders]
    parts = [part for parts in variables.values() for part in parts]
    root = _root([*map(os.path.dirname, inside), *parts])
    files = {f"{TREE}/{_name(one, root)}": one for one in own} | brought
    reads = contents.sources if contents.is_case else ()
    return files, {
        "format": 1,
        "entry": f"{TREE}/{_name(os.path.abspath(contents.entry), root)}",
        "files": {name: _digest(path) for name, path in sorted(files.items())},
        "reads": [[one.path, one.sha256] for one in reads],
        "stands_for": root if _is_named(root, own) else "",
        "variables": {
            name: [_name(one, root) for one in value] for name, value in variables.items()
        },
    }


def _root(folders: Sequence[str]) -> str:
    """The least folder that all lie in.

    Raises:
        BadPack: there is none.
    """
    try:
        return os.path.commonpath(folders)
    except ValueError:
        raise BadPack("its files lie on two drives", valid="all on one") from None


def _name(path: str, root: str) -> str:
    return Path(os.path.relpath(path, root)).as_posix()


def _is_named(root: str, files: Iterable[str]) -> bool:
    """True if one of the files may name another by its place on this machine."""
    if root == os.path.abspath(os.sep):
        return True
    texts = (Path(one) for one in files if os.path.getsize(one) <= LONGEST_TEXT)
    return any(os.fsencode(root) in one.read_bytes() for one in texts)


def _package_folders(files: Iterable[str], sources: Iterable[Source]) -> list[str]:
    """The folders above the files that may be packages by which files were looked for."""
    asked = [one.path.removeprefix(LOOKUP) for one in sources if one.path.startswith(LOOKUP)]
    names = {part for one in asked for part in one.partition(" ")[2].split("/")} - {""}
    above = {folder for one in files for folder in Path(one).parents} if names else set()
    return sorted(str(one) for one in above if any(is_package(one, name) for name in names))


def _digest(path: str) -> str:
    with regular_file(Path(path)) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _write_zip(target: Path, manifest: Mapping[str, object], files: Mapping[str, str]) -> None:
    text = json.dumps(manifest, indent=1, ensure_ascii=False) + "\n"
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(_info(MANIFEST), text)
        for name, path in sorted(files.items()):
            with (
                regular_file(Path(path)) as file,
                archive.open(_info(name), "w", force_zip64=True) as member,
            ):
                shutil.copyfileobj(file, member)


def _info(name: str) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, BEGIN)
    info.compress_type, info.create_system, info.external_attr = (
        zipfile.ZIP_DEFLATED,
        3,
        0o100644 << 16,
    )
    return info
