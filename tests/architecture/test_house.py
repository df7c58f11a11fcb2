"""The rules of the house that a program can check: imports, style, docstrings, names, seeded faults."""

from __future__ import annotations

import ast
import functools
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import clearance
from tests import guards
from tests.docs.plain_words import unclear

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "clearance").rglob("*.py"))
BARRED = {"utils", "util", "helpers", "helper", "common", "misc", "manager", "base"}


@pytest.mark.cold
def test_imports_keep_to_the_layers_and_doors():
    lint = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.cold
def test_ruff_finds_nothing():
    passes("ruff", "check", "--output-format", "concise", ".")


@pytest.mark.cold
def test_every_file_has_the_form_that_ruff_gives_it():
    passes("ruff", "format", "--check", ".")


@pytest.mark.cold
@pytest.mark.slow
def test_mypy_finds_nothing_in_the_package():
    """Half a minute on a new checkout, seconds from `.mypy_cache` after that."""
    passes("mypy")


def passes(tool: str, *arguments: str) -> None:
    command = [sys.executable, "-m", tool, *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_pre_commit_asks_with_the_tools_that_are_installed_here():
    (local,) = YAML(typ="safe").load((ROOT / ".pre-commit-config.yaml").read_text())["repos"]
    assert local["repo"] == "local"
    asked = {hook["id"]: hook["entry"].split()[0] for hook in local["hooks"]}
    assert set(asked) == {"ruff", "ruff-format", "lint-imports"}
    assert all(Path(sys.executable).with_name(tool).is_file() for tool in asked.values())


@pytest.mark.slow
def test_every_module_opens_with_what_it_is_for():
    assert faults()["docstring"] == []


@functools.cache
def faults() -> dict[str, list[str]]:
    """By rule. All modules are parsed once, and none is kept: what is alive slows each collection of garbage."""
    rules = {
        "docstring": without_docstring,
        "long": long_ones,
        "assert": kernel_asserts,
        "words": unclear_texts,
    }
    found: dict[str, list[str]] = {name: [] for name in rules}
    for path in MODULES:
        module = ast.parse(path.read_text(encoding="utf-8"))
        for name, rule in rules.items():
            found[name] += rule(path.relative_to(ROOT).as_posix(), module)
    return found


def without_docstring(name: str, module: ast.Module) -> Iterator[str]:
    if not ast.get_docstring(module) and (module.body or not name.endswith("__init__.py")):
        yield name


@pytest.mark.slow
def test_messages_are_plain():
    assert faults()["words"] == []


def unclear_texts(name: str, module: ast.Module) -> Iterator[str]:
    """Texts of a module that a user may read: all but docstrings, and the first lines of those of public names."""
    for node in module.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name in clearance.__all__:
            first = (ast.get_docstring(node) or "").partition("\n")[0]
            yield from (f"{name}, {node.name}: {fault}" for fault in unclear(first))
    texts = {
        node: [node] if isinstance(node, ast.Constant) else node.values
        for node in ast.walk(module)
        if isinstance(node, ast.Constant | ast.JoinedStr)
    }
    joined = {part for node, parts in texts.items() for part in parts if part is not node}
    documented = {node.value for node in ast.walk(module) if isinstance(node, ast.Expr)}
    for node in texts.keys() - joined - documented:
        text = "".join(
            str(part.value) if isinstance(part, ast.Constant) else "VALUE" for part in texts[node]
        )
        if " " in text:
            yield from (f"{name}, line {node.lineno}: {fault}" for fault in unclear(text))


def test_the_guide_and_the_map_name_every_room():
    rooms = {path.parent.name for path in (ROOT / "clearance").glob("*/__init__.py")}
    guide = (ROOT / "scripts" / "docs" / "contributing.md").read_text(encoding="utf-8")
    drawn = set(
        re.findall(r"\w+", guide.partition("The house today")[2].partition("Before kernels")[0])
    )
    listed = set(re.findall(r"\| `clearance/(\w+)` \|", guide))
    mapped = set(re.findall(r"\w+", (ROOT / "README.md").read_text(encoding="utf-8")))
    assert len(rooms) > 20 and (rooms - drawn, rooms - listed, rooms - mapped) == (
        set(),
        set(),
        set(),
    )


def test_no_room_has_a_name_that_says_nothing():
    assert [path for path in MODULES if BARRED & {path.stem, path.parent.name}] == []


COMMANDS = {
    "clearance/cli/profile.py",
}
"""Where click hands over one argument for each option."""

MOST_ARGUMENTS, MOST_LINES = 8, 60

REASON = re.compile(r"^Many arguments: \w.{20,}", re.MULTILINE)


def test_functions_take_few_arguments_and_are_read_at_once():
    """No public function takes more than eight arguments, and a private one says why; none is longer than a page.

    The docstring is left out. A reason is a line `Many arguments: …`.
    """
    assert faults()["long"] == []


def long_ones(name: str, module: ast.Module) -> Iterator[str]:
    """What is too long about the functions of a module."""
    for node in ast.walk(module):
        if not isinstance(node, ast.FunctionDef):
            continue
        given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        own = [argument for argument in given if argument.arg not in ("self", "cls")]
        text = ast.get_docstring(node) or ""
        is_excused = node.name.startswith("_") and REASON.search(text)
        if len(own) > MOST_ARGUMENTS and not is_excused and name not in COMMANDS:
            yield f"{name}: {node.name} takes {len(own)} arguments"
        told = node.body[0] if text else None
        n_told = told.end_lineno - told.lineno + 1 if told else 0
        n_lines = node.end_lineno - node.lineno + 1 - n_told
        if n_lines > MOST_LINES:
            yield f"{name}: {node.name} has {n_lines} lines"


def test_kernels_state_nothing_by_assert():
    """pytest rewrites the asserts of a package that brings a plugin, into what no compiler of ours knows."""
    assert faults()["assert"] == []


def kernel_asserts(name: str, module: ast.Module) -> Iterator[str]:
    if name.startswith("clearance/kernels/"):
        told = (node for node in ast.walk(module) if isinstance(node, ast.Assert))
        yield from (f"{name}, line {node.lineno}: raise AssertionError" for node in told)


def imported(text: str) -> Iterator[str]:
    """The modules that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def ties(room: str, other: str) -> list[str]:
    """The files of a room that import something of another."""
    texts = {path: path.read_text(encoding="utf-8") for path in sorted((ROOT / room).rglob("*.py"))}
    top = other.partition(".")[0]  # to parse all files takes seconds
    return [
        path.relative_to(ROOT).as_posix()
        for path, text in texts.items()
        if top in text and any(f"{name}.".startswith(f"{other}.") for name in imported(text))
    ]


@pytest.mark.parametrize(
    ("room", "other"), [("tests", "scripts.bench"), ("scripts", "tests")], ids=lambda name: name
)
def test_tests_and_benchmarks_import_nothing_of_each_other(room, other):
    """Inputs that both draw are made in `scripts/makers`."""
    assert ties(room, other) == []


FAULTS = {
    f"{table.stem}/{name}": row
    for table in sorted((ROOT / "scripts" / "mutations").glob("*.toml"))
    for name, row in tomllib.loads(table.read_text(encoding="utf-8")).items()
}


def text_of(room: str) -> str:
    return "\0".join(path.read_text(encoding="utf-8") for path in (ROOT / room).rglob("*.py"))


def test_each_fault_is_listed_once_and_says_what_is_wrong():
    assert len(FAULTS) >= 60 and len({name.partition("/")[2] for name in FAULTS}) == len(FAULTS)
    assert [name for name, row in FAULTS.items() if not row["fault"].endswith(".")] == []
    assert [name for name, row in FAULTS.items() if row["before"] == row["after"]] == []


def test_the_text_that_a_fault_replaces_is_in_the_package_once():
    package = text_of("clearance")
    counts = {name: package.count(row["before"]) for name, row in FAULTS.items()}
    assert {name: n for name, n in counts.items() if n != 1} == {}


def test_the_tests_that_find_a_fault_are_there():
    """A test that is renamed is renamed in the tables too; one that goes leaves its faults to another."""
    known = set(re.findall(r"^def (test_\w+)\(", text_of("tests"), re.MULTILINE))
    missing = {name: set(row["killed_by"]) - known for name, row in FAULTS.items()}
    assert {name: tests for name, tests in missing.items() if tests} == {}
    assert all(row["killed_by"] for row in FAULTS.values())


def test_this_test_has_no_mark_and_so_starts_no_process(request):
    """What `guards` does to any test that is not marked; the refusals are taken back, since they are wanted."""
    assert not {mark.name for mark in request.node.iter_markers()}
    start = subprocess.run
    for deed in (lambda: start([sys.executable, "-c", ""]), lambda: os.system("true")):
        with pytest.raises(guards.UnmarkedDeed):
            deed()
    assert len(guards.refused) == 2
    guards.refused.clear()


def test_a_case_beside_the_repository_is_not_read_without_the_mark():
    with pytest.raises(guards.UnmarkedDeed):
        open(guards.SHARED_CASES / "no_such_case")
    guards.refused.clear()
