"""The rules of the house that a program can check: imports, style, docstrings, names."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "clearance").rglob("*.py"))
BARRED = {"utils", "util", "helpers", "helper", "common", "misc", "manager", "base"}


def test_imports_keep_to_the_layers_and_doors():
    lint = Path(sys.executable).with_name("lint-imports")
    done = subprocess.run([lint, "--no-cache"], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_ruff_finds_nothing():
    passes("ruff", "check", "--output-format", "concise", ".")


def test_every_file_has_the_form_that_ruff_gives_it():
    passes("ruff", "format", "--check", ".")


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


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_module_opens_with_what_it_is_for(path):
    source = path.read_text(encoding="utf-8")
    if not source.strip():
        assert path.name == "__init__.py"
        return
    assert ast.get_docstring(ast.parse(source)), f"{path} has no docstring"


def test_no_room_has_a_name_that_says_nothing():
    assert [path for path in MODULES if BARRED & {path.stem, path.parent.name}] == []


COMMANDS = {
    "clearance/cli/batch.py",
    "clearance/cli/check.py",
    "clearance/cli/new.py",
    "clearance/cli/profile_sweep.py",
}
"""Where click hands over one argument for each option."""

MOST_ARGUMENTS, MOST_LINES = 8, 60


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_functions_take_few_arguments_and_are_read_at_once(path):
    """No public function takes more than eight arguments; none has more lines than a page, docstring aside."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.FunctionDef):
            continue
        given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        own = [argument for argument in given if argument.arg not in ("self", "cls")]
        if not node.name.startswith("_") and str(path.relative_to(ROOT)) not in COMMANDS:
            assert len(own) <= MOST_ARGUMENTS, f"{path}: {node.name} takes {len(own)} arguments"
        told = node.body[0] if ast.get_docstring(node) else None
        n_told = told.end_lineno - told.lineno + 1 if told else 0
        n_lines = node.end_lineno - node.lineno + 1 - n_told
        assert n_lines <= MOST_LINES, f"{path}: {node.name} has {n_lines} lines"


def test_kernels_state_nothing_by_assert():
    """pytest rewrites the asserts of a package that brings a plugin, into what no compiler of ours knows."""
    for path in sorted((ROOT / "clearance" / "kernels").rglob("*.py")):
        told = [node.lineno for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
                if isinstance(node, ast.Assert)]  # fmt: skip
        assert not told, f"{path}: raise AssertionError in lines {told}"
