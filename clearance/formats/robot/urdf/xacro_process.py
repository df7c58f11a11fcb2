"""xacro in a process of its own, and its adapter: what is asked comes as JSON on stdin, the URDF goes to
stdout.

xacro evaluates Python and keeps what it does in its module, so one run must not meet another, nor last. The
operating system bounds its work and its memory and lets it write no file; it is no wall against a hostile file,
which can read and send what the user can. Not for: importing (`xacro_file` starts it).
"""

from __future__ import annotations

import json
import os
import sys
import types
from pathlib import Path
from typing import Any

MOST_TEXT = 64_000_000
"""[characters] Of the URDF."""


class _TooMuch(Exception):
    """The URDF is longer than any robot's."""


class _Arguments(dict[str, str]):
    """The arguments of a file, and which of them it asks for."""

    def __init__(self, given: dict[str, str]) -> None:
        super().__init__(given)
        self.asked: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(str(name))
        return super().__getitem__(name)


class _Packages:
    """Stands in for ROS's index of packages, so that `$(find x)` follows our rules."""

    def __init__(self, folder: Path, package_dirs: list[Path]) -> None:
        self._folder, self._dirs = folder, package_dirs
        self.by_variable: dict[str, dict[str, str]] = {}
        self.found: dict[str, str] = {}

    def find(self, name: str, *_: object, **__: object) -> str:
        """The folder of a package."""
        from clearance.formats.files.mesh_paths import package_folder

        found = package_folder(str(name), self._folder, self._dirs)
        if found.variable:
            self.by_variable.setdefault(found.variable, {})[str(name)] = str(found.path)
        self.found[str(name)] = os.path.abspath(found.path)
        return self.found[str(name)]

    def install(self) -> None:
        """Makes this the module that xacro asks."""
        packages = types.ModuleType("ament_index_python.packages")
        packages.get_package_share_directory = self.find  # type: ignore[attr-defined]
        index = types.ModuleType("ament_index_python")
        index.packages = packages  # type: ignore[attr-defined]
        sys.modules |= {"ament_index_python": index, "ament_index_python.packages": packages}


def _main() -> None:
    asked = json.load(sys.stdin)
    answers, sys.stdout = sys.stdout, sys.stderr
    sys.path[:] = asked["modules"]
    json.dump(_answer(asked), answers)


def _answer(asked: dict[str, Any]) -> dict[str, Any]:
    path = Path(asked["path"])
    packages = _Packages(path.parent, [Path(folder) for folder in asked["package_dirs"]])
    packages.install()
    _limit_work(asked["seconds"], asked["bytes"])
    made = evaluated(path, asked["args"])
    return made | {"variables": packages.by_variable, "packages": packages.found}


def evaluated(path: Path, given: dict[str, str]) -> dict[str, Any]:
    """The URDF, the values of all arguments, and which of them were asked for; or what went wrong, and where. And
    the files that were read.
    """
    import xacro

    arguments = _Arguments(given)
    xacro.all_includes.clear()
    try:
        text = xacro.process_file(str(path), mappings=arguments).toxml()
        if len(text) > MOST_TEXT:
            raise _TooMuch(f"the URDF has more than {MOST_TEXT:,} characters")
        made = {"urdf": text, "args": dict(arguments), "asked": sorted(arguments.asked)}
    except Exception as error:
        made = _fault(error, getattr(xacro, "filestack", None) or [])
    read = [str(path), *(name for name in xacro.all_includes if os.path.isfile(name))]
    return made | {"files": [*dict.fromkeys(map(os.path.abspath, read))]}


def _fault(error: Exception, stack: list[str | None]) -> dict[str, Any]:
    """What went wrong, where: the file that was being read, and the line where the parser knows it."""
    from xacro.substitution_args import ArgException

    inner = _innermost(error)
    problem, valid = _described(error), getattr(inner, "valid", "")
    if isinstance(inner, ArgException):
        problem, valid = (
            f"argument {str(inner)!r} has no value",
            f"robot: {{xacro_args: {{{inner}: VALUE}}}}",
        )
    return {
        "problem": problem,
        "valid": valid,
        "file": next((name for name in reversed(stack) if name), None),
        "line": getattr(error, "lineno", None),
        "missing": _missing(error),
    }


def _innermost(error: Exception) -> Exception:
    """What xacro's own exceptions wrap."""
    inner = getattr(error, "exc", None)
    return _innermost(inner) if isinstance(inner, Exception) else error


def _missing(error: Exception) -> str | None:
    """The file that is named and not there, if that is the fault."""
    inner = _innermost(error)
    if isinstance(inner, FileNotFoundError) and inner.filename:
        return os.path.abspath(os.fsdecode(inner.filename))
    return None


def _described(error: Exception) -> str:
    """The error and what it wraps, each said once."""
    if isinstance(error, RecursionError):
        return "it is nested too deep, or files or macros call each other without end"
    if isinstance(error, MemoryError):
        return "it needs too much memory"
    if isinstance(error, OSError):
        return f"a file cannot be read ({(error.strerror or 'unknown error').lower()})"
    if isinstance(error, KeyError):
        return f"unknown name {error}"
    if hasattr(error, "lineno"):
        return str(error).partition(": line")[0]  # which stands before it
    own = str(getattr(error, "problem", "") or Exception.__str__(error))
    own = "" if own == "None" or own.startswith("<class ") else own
    inner = getattr(error, "exc", None)
    wrapped = _described(inner) if isinstance(inner, Exception) else ""
    parts = (own, "" if wrapped in own else wrapped, getattr(error, "suffix", None) or "")
    return " ".join(part for part in parts if part) or type(error).__name__


def _limit_work(seconds: int, n_bytes: int) -> None:
    """Ends this process after so much work, refuses it more memory, and lets it write no file; not on Windows."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    resource.setrlimit(resource.RLIMIT_DATA, (n_bytes, n_bytes))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))


if __name__ == "__main__":
    _main()
