"""Where a mesh named in a URDF lies: `package://…`, `file://…`, absolute, or relative."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath
from urllib.parse import unquote, urlsplit

from clearance.errors import BadSyntax, MissingFile

_PACKAGE_SCHEMES = ("package", "model")


def mesh_path(given: str, urdf_folder: Path, package_dirs: Sequence[Path]) -> Path:
    """The file that `given` means.

    `package://x/y` is looked for as `x/y` in each of the package folders and then in the URDF's
    folder, then without its leading parts, one after the other: the longest match wins.

    Raises:
        MissingFile: no such file, with the places tried. BadSyntax: a scheme that is not known.
    """
    scheme, separator, rest = given.partition("://")
    if not separator:
        return _existing(given, [urdf_folder / given.replace("\\", "/")])
    if scheme in _PACKAGE_SCHEMES:
        return _existing(given, list(_package_candidates(rest, [*package_dirs, urdf_folder])))
    if scheme == "file":
        path = unquote(urlsplit(given).path)
        return _existing(given, [Path(path), urdf_folder / path.lstrip("/")])
    raise BadSyntax(f"{given!r} is given", valid="package://, file:// or a path is needed")


def _package_candidates(rest: str, folders: Sequence[Path]) -> Iterator[Path]:
    parts = PurePosixPath(rest.replace("\\", "/")).parts
    for n_dropped in range(len(parts)):
        for folder in folders:
            yield folder.joinpath(*parts[n_dropped:])


def _existing(given: str, candidates: list[Path]) -> Path:
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    remedy = "give its package's folder in robot.package_dirs" if len(candidates) > 1 else ""
    raise MissingFile(f"there is no mesh {given!r}", valid=remedy)
