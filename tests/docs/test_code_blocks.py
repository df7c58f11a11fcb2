"""What the README and the guide show works: Python runs, commands parse, files load, paths and pages exist."""

from __future__ import annotations

import re
import shlex
import shutil
import tomllib
from pathlib import Path

import click
import pytest
from ruamel.yaml import YAML

from clearance.batch.manifest_file import manifest_of
from clearance.case.waiver_file import load_waivers
from clearance.cli import run
from clearance.cli.commands import clearance
from clearance.formats.schema.case import Case
from clearance.formats.schema.tolerance import Tolerance
from tests.docs.code_blocks import PAGES, ROOT, CodeBlock, blocks_of

LANGUAGES = {"python", "bash", "console", "yaml", "csv", "dockerfile", "text"}
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]


def name_of(page: Path) -> str:
    return str(page.relative_to(ROOT))


def blocks(*languages: str) -> list:
    return [
        pytest.param(block, id=f"{name_of(page)}:{block.line}")
        for page in PAGES
        for block in blocks_of(page)
        if block.language in languages
    ]


def with_blocks(*languages: str) -> list:
    return [
        pytest.param(page, id=name_of(page))
        for page in PAGES
        if any(block.language in languages for block in blocks_of(page))
    ]


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_every_block_says_what_it_is(page):
    assert {block.language for block in blocks_of(page)} <= LANGUAGES


@pytest.mark.cold
@pytest.mark.slow
@pytest.mark.peer
@pytest.mark.parametrize("page", with_blocks("python", "bash"))
def test_what_a_page_runs_runs(page, tmp_path, monkeypatch):
    """Blocks of a page follow each other: files are written, Python shares its names, commands end well.

    As long as the page takes its reader: what is shown is run whole, reports and all.
    """
    for folder in ("scenes", "robots"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    names: dict = {"__name__": "page"}
    for block in blocks_of(page):
        if block.title:
            (tmp_path / block.title).write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            exec(compile(block.text, f"{page}:{block.line}", "exec"), names)
        elif block.language == "bash":
            for command in block.commands:
                require_ends_well(command)


def require_ends_well(command: str) -> None:
    """Runs a command of ours; a check may find a violated limit."""
    program, *arguments = shlex.split(command)
    assert program == "clearance", command
    assert run(arguments) in (0, 1), command


@pytest.mark.parametrize("block", blocks("console", "bash"))
def test_commands_are_valid(block: CodeBlock):
    for command in block.commands:
        require_valid(shlex.split(command))


def require_valid(words: list[str]) -> None:
    """Fails where a command, option or file that is ours is not there."""
    program, *arguments = words
    if program == "clearance":
        require_parses(clearance, "clearance", arguments)
    elif program.startswith("scripts/"):
        assert (ROOT / program).stat().st_mode & 0o100, f"{program} cannot be run"
        require_paths(argument for argument in arguments if argument.startswith("tests/"))
    elif program == "python" and arguments[0] != "-m":
        require_paths(arguments[:1])
    elif program == "pip":
        assert arguments[0] == "install"
        for extra in re.findall(r"\[(\w+)\]", " ".join(arguments)):
            assert extra in EXTRAS, f"no extra {extra}"
    else:
        assert program in {"python", "pytest", "ruff", "lint-imports"}, f"unknown program {program}"


def require_parses(command: click.Command, name: str, arguments: list[str], parent=None) -> None:
    """Hands the arguments to the command line's own parser, down to the last subcommand; nothing is run."""
    with command.make_context(name, list(arguments), parent=parent) as context:
        if isinstance(command, click.Group):
            rest = [*context._protected_args, *context.args]
            name, below, rest = command.resolve_command(context, rest)
            require_parses(below, name, rest, context)


def require_paths(paths) -> None:
    for path in paths:
        assert (ROOT / path).exists(), f"{path} is not there"


@pytest.mark.parametrize("block", blocks("yaml"))
def test_case_files_keep_to_the_schema(block: CodeBlock, tmp_path):
    content = YAML(typ="safe").load(block.text)
    if block.title == "waivers.yaml":
        (tmp_path / block.title).write_text(block.text)
        assert load_waivers(tmp_path / block.title)
    elif block.title == "tolerances.yaml":
        Tolerance.model_validate(content)
    elif isinstance(content, list):  # steps of a job
        assert all(set(step) <= {"uses", "with", "run"} for step in content)
    elif {"robot", "robots"} & content.keys():
        Case.model_validate(content)
    elif {"cases", "cell"} & content.keys():
        manifest_of(content, tmp_path / "batch.yaml")
    else:
        assert set(content) <= {*Case.model_fields, "jobs", "cases", "repos", "clearance"}


MENTIONED = re.compile(r"`((?:clearance|scripts|tests|scenes|robots)/[\w./]+)`")
LINKED = re.compile(r"\]\(([^)#]+)(?:#[^)]*)?\)")


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_what_a_page_names_is_there(page):
    text = page.read_text(encoding="utf-8")
    assert [path for path in MENTIONED.findall(text) if not (ROOT / path).exists()] == []
    links = [link for link in LINKED.findall(text) if "://" not in link and "pictures/" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []
