"""Builds the wheel, installs it into empty environments, and prints seconds and MB: alone, and with `all`.

    python scripts/bench/install_sizes.py [--wheel FILE] [--write]

MB is of 1,000,000 bytes, with compiled Python, as pip records it. A library has what only it brings, an extra what
it adds to the required libraries. `--write` puts the sizes into the tables of the page Installing, with libraries
and extras as the project file names them. It needs an index for pip; seconds are those of pip with its cache.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterable, Mapping
from importlib.metadata import Distribution, distributions
from pathlib import Path

from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAGE = ROOT / "scripts" / "docs" / "installing.md"

MORE = "all,cad,jit,mujoco"
"""The extras whose sizes are told."""

NOT_MEASURED = ("test", "bench", "docs")

ROW = re.compile(r"^\| `([\w.-]+)` \|(.*)\|$", re.MULTILINE)


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    asked.add_argument("--wheel", type=Path, help="Install this wheel, and build none.")
    asked.add_argument("--write", action="store_true", help="Put the sizes into the guide's page.")
    given = asked.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        wheel = given.wheel or built(folder)
        print(f"wheel: {wheel.stat().st_size / 1e6:.1f} MB")
        installed(folder / "alone", f"{wheel}")
        place = installed(folder / "all", f"{wheel}[all]")
        pip(folder / "all", f"{wheel}[{MORE}]")
        tell(Sizes(place), write_too=given.write)


def tell(sizes: Sizes, *, write_too: bool) -> None:
    """Prints the sizes, and puts them into the page."""
    required, extras = sizes.required(), sizes.extras()
    for title, table in (("required", required), ("extra", extras)):
        for key, size in table.items():
            print(f"{title:10}{key:14}{size:8.1f} MB")
    print("largest of all:", ", ".join(f"{k} {v:.0f} MB" for k, v in sizes.largest("all")))
    if write_too:
        write(required, extras)


def built(folder: Path) -> Path:
    """A wheel of this repository; kernels that are compiled are not compiled again."""
    start = time.monotonic()
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    print(f"building: {time.monotonic() - start:.0f} s")
    return next(folder.glob("*.whl"))


def pip(place: Path, what: str) -> None:
    """Installs into an environment; libraries come as wheels, or as pip's cache has them."""
    command = [sys.executable, "-m", "pip", "--python", str(place / "bin" / "python"), "install"]
    subprocess.run([*command, "--quiet", "--disable-pip-version-check", what], check=True)


def installed(place: Path, what: str) -> Path:
    """The folder of libraries of a new environment; prints what it took."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(place)], check=True)
    start = time.monotonic()
    pip(place, what)
    seconds = time.monotonic() - start
    (found,) = place.glob("lib/python*/site-packages")
    n_bytes = sum(path.stat().st_size for path in found.rglob("*") if path.is_file())
    print(f"pip install {Path(what).name}: {seconds:.0f} s, {n_bytes / 1e6:.0f} MB")
    return found


class Sizes:
    """What libraries in a folder need and take."""

    def __init__(self, place: Path) -> None:
        self._found = {
            canonicalize_name(one.metadata["Name"]): one for one in distributions(path=[str(place)])
        }
        self._bytes = {name: _n_bytes(one) for name, one in self._found.items()}

    def named(self, owner: str, extra: str = "") -> dict[str, set[str]]:
        """The libraries that a library names, with the extras of each."""
        environment = {**default_environment(), "extra": extra}
        found: dict[str, set[str]] = {}
        for text in self._found[owner].requires or ():
            one = Requirement(text)
            plain = one.marker is None or one.marker.evaluate({**environment, "extra": ""})
            if (plain and not extra) or (not plain and one.marker.evaluate(environment)):
                found.setdefault(canonicalize_name(one.name), set()).update(one.extras)
        return found

    def closed(self, named: dict[str, set[str]]) -> set[str]:
        """All that these libraries need, with themselves; without our own package."""
        seen: set[tuple[str, str]] = set()
        open_ = [(name, extra) for name, extras in named.items() for extra in ("", *extras)]
        while open_:
            one = open_.pop()
            if one in seen or one[0] not in self._found:
                continue
            seen.add(one)
            further = self.named(*one)
            open_ += [(name, extra) for name, extras in further.items() for extra in ("", *extras)]
        return {name for name, _ in seen} - {"clearance"}

    def megabytes(self, names: Iterable[str]) -> float:
        """[MB] of some libraries together."""
        return sum(self._bytes[name] for name in names) / 1e6

    def required(self) -> dict[str, float]:
        """[MB] of each required library with what only it brings, the largest first."""
        named = self.named("clearance")
        others = {k: self.closed({n: v for n, v in named.items() if n != k}) for k in named}
        sizes = {k: self.megabytes(self.closed({k: v}) - others[k] | {k}) for k, v in named.items()}
        spelled = {canonicalize_name(k): k for k in map(_name, PROJECT["dependencies"])}
        return {spelled[k]: sizes[k] for k in sorted(sizes, key=lambda name: -sizes[name])}

    def extras(self) -> dict[str, float]:
        """[MB] that each extra adds."""
        base = self.closed(self.named("clearance"))
        return {
            extra: self.megabytes(self.closed(self.named("clearance", extra)) - base)
            for extra in PROJECT["optional-dependencies"]
        }

    def largest(self, extra: str) -> list[tuple[str, float]]:
        """The five largest libraries of an extra, each alone."""
        names = self.closed(self.named("clearance", extra))
        return sorted(((k, self.megabytes([k])) for k in names), key=lambda one: -one[1])[:5]


def _name(requirement: str) -> str:
    return Requirement(requirement).name


def _n_bytes(one: Distribution) -> int:
    paths = [Path(str(one.locate_file(file))) for file in one.files or ()]
    return sum(path.stat().st_size for path in paths if path.is_file())


def write(required: Mapping[str, float], extras: Mapping[str, float]) -> None:
    """Puts names and sizes into the rows of the page's two tables; what a row says it is for stays."""
    text = PAGE.read_text(encoding="utf-8")
    for title, sizes in (("Required libraries", required), ("Extras", extras)):
        head, mark, rest = text.partition(f"\n## {title}\n")
        section, end, tail = rest.partition("\n## ")
        words = {key: cells.strip(" |").split("|") for key, cells in ROW.findall(section)}
        order = sizes if title != "Extras" else sorted(sizes, key=[*words, *sizes].index)
        rows = "".join(_row(title, key, sizes[key], words.get(key, ["", ""])) for key in order)
        first = section.index("| `")
        below = ROW.sub("", section[first:]).lstrip("\n")
        text = head + mark + section[:first] + rows + (below and f"\n{below}") + end + tail
    PAGE.write_text(text, encoding="utf-8")


def _row(title: str, key: str, size: float, cells: list[str]) -> str:
    told = "not measured" if key in NOT_MEASURED else f"{max(1.0, size):,.0f}"
    if title != "Extras":
        return f"| `{key}` | {told} | {cells[1].strip()} |\n"
    named = [Requirement(text) for text in PROJECT["optional-dependencies"][key]]
    names = [
        n for one in named for n in (sorted(one.extras) if one.name == "clearance" else [one.name])
    ]
    return f"| `{key}` | {', '.join(f'`{n}`' for n in names)} | {cells[1].strip()} | {told} |\n"


if __name__ == "__main__":
    main()
