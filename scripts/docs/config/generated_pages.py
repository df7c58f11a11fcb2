"""The guide's pages that are made of the repository: pictures, design notes, reference of all public names.

A hook of mkdocs. Not for: pages that somebody writes; they lie beside this folder.
"""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import clearance
from clearance.codes import entries
from clearance.gains.request import Request
from clearance.options import Option, flag_of, options_in
from clearance.run import CheckOptions

ROOT = Path(__file__).resolve().parents[3]

PICTURES = (
    "scenes/iiwa_pipe_rack/report.png",
    "scenes/welding_cell/welding.png",
    "scenes/palletising_cell/palletising.png",
    "scenes/profiles/keep_in.svg",
    "scripts/bench/results/trajectory.svg",
    "scripts/bench/results/growth.svg",
    "scripts/bench/results/error_time.svg",
)
"""Shown on the guide's pages as `pictures/NAME`."""

LIBRARY_ORDER = (
    "run",
    "simulate",
    "world",
    "case",
    "formats",
    "query",
    "geometry",
    "planar",
    "sketch",
    "profiles",
)
"""Rooms of the reference, the first asked for first; others follow by name."""


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Adds the generated pages to the navigation."""
    pages = {title: part for section in config.nav for title, part in section.items()}
    pages["Reference"].append({"Python": list(_reference_pages())})
    pages["Contribute"].append({"Design notes": [{_title(page): page} for page in _design_notes()]})
    return config


def on_page_markdown(markdown: str, **_: object) -> str:
    """A page with tables in place of marks: `<!-- options of NAME -->`, `<!-- codes -->`."""
    for name, kind in (("check", CheckOptions), ("gain", Request)):
        markdown = markdown.replace(f"<!-- options of {name} -->", option_table(kind))
    return markdown.replace("<!-- codes -->", code_sections())


def code_sections() -> str:
    """All codes by their hundreds: meaning, why it matters, what to do, an example."""
    parts, group = [], ""
    for entry in entries().values():
        if entry.group != group:
            group = entry.group
            parts.append(f"## {group}")
        parts += [f"### {entry.code}: {entry.title}", f"{entry.means} {entry.matters}"]
        parts += [
            f"**What to do:** {entry.remedy}",
            f"```text\n{entry.example} [{entry.code}]\n```",
        ]
    return "\n\n".join(parts)


def option_table(kind: type) -> str:
    """The options of a dataclass: name, spelling on the command line, help and default."""
    rows = (_option_row(name, one) for name, one in options_in(kind).items())
    return "\n".join(["| option | command line | meaning |", "|---|---|---|", *rows])


def _option_row(name: str, one: Option) -> str:
    flags = [flag_of(name, one), *([one.off.replace("_", "-")] if one.off else [])]
    spelled = ", ".join(f"`--{flag}`" for flag in flags) if one.said else "Python only"
    usual = "" if one.default in (None, (), False) else f" Default: `{one.default!r}`."
    return f"| `{name}` | {spelled} | {one.help}{usual} |"


def _title(page: str) -> str:
    """What a design note is called in the navigation: its room, and its file unless that is NOTES."""
    _, *rooms, file = page.removesuffix(".md").split("/")
    return "/".join(rooms) + ("" if file == "NOTES" else f": {file.lower().replace('_', ' ')}")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds pictures and generated pages to what is built."""
    for path in PICTURES:
        name = f"pictures/{Path(path).name}"
        files.append(File.generated(config, name, abs_src_path=str(ROOT / path)))
    for page, text in _reference_pages().items():
        files.append(File.generated(config, page, content=text))
    for page, source in _design_notes().items():
        files.append(File.generated(config, page, abs_src_path=str(source)))
    return files


def _reference_pages() -> dict[str, str]:
    """One page a room: each public name with its docstring."""
    names: dict[str, list[str]] = defaultdict(list)
    for name in clearance.__all__:
        value = getattr(clearance, name)
        home = getattr(value, "__module__", None)
        if home is not None:
            names[home.split(".")[1]].append(f"{home}.{value.__qualname__}")
    return {
        f"reference/{room}.md": _reference_page(room, names[room])
        for room in sorted(names, key=_place)
    }


def _place(room: str) -> tuple[int, str]:
    return (LIBRARY_ORDER.index(room) if room in LIBRARY_ORDER else len(LIBRARY_ORDER), room)


def _reference_page(room: str, names: list[str]) -> str:
    entries = "\n\n".join(f"::: {name}" for name in names)
    return f"# {room}\n\nEach name is imported as `clearance.NAME`.\n\n{entries}\n"


def _design_notes() -> dict[str, Path]:
    """The notes of each room, NOTES first."""
    package = ROOT / "clearance"
    notes = [path for path in package.rglob("*.md") if path.name != "CHANGELOG.md"]
    notes.sort(key=lambda path: (path.parent, path.name != "NOTES.md", path))
    return {f"design/{path.relative_to(package)}": path for path in notes}
