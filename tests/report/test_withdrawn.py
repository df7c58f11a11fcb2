"""An older report is marked while a run into its folder has not come to its end."""

import pytest

from clearance.cli import run
from clearance.files import LAST
from clearance.report.withdrawn import OLDER_SUMMARY, marked_page, withdraw_report
from tests.cart import CASE, files, write_cart


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cart(tmp_path / "in")
    monkeypatch.chdir(tmp_path / "in")
    return tmp_path / "in"


def check():
    return run(["check", "case.yaml", "--out", "report", "--quiet"])


def content(place):
    return {path.name: path.read_bytes() for path in place.iterdir() if path.is_file()}


def stop(*arguments, **named):
    raise KeyboardInterrupt


def test_what_is_stopped_leaves_no_older_answer_to_be_read_as_its_own(folder, monkeypatch):
    code = check()
    assert code in (0, 1)
    first = content(folder / "report")
    monkeypatch.setattr("clearance.run.answer", stop)
    for _ in range(2):
        assert check() == 130
        left = content(folder / "report")
        assert LAST not in left and left[OLDER_SUMMARY] == first[LAST]
        page = left["report.html"].decode()
        assert (
            page.count("A later run into this folder has not come to its end: it was refused, or")
            == 1
        )
        assert "<title>Not finished: " in page and page.index("Not finished</h1>") < 30_000
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert check() == code and content(folder / "report") == first


def test_a_folder_without_a_report_stays_as_it_is(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    withdraw_report(tmp_path)
    assert content(tmp_path) == {"notes.txt": b"mine"}


def test_a_page_is_marked_once_after_the_head():
    marked = marked_page(b"<head><title>a</title></head>\n<body>\n<p>b</p>")
    assert marked.startswith(b"<head><title>Not finished: a</title></head>\n<body>\n<header id=")
    assert marked.endswith(b"</header>\n<p>b</p>") and marked_page(marked) == marked


BAD = CASE.replace("limits: {fail", "limits: {fial")
"""A typing error: refused when it is read."""

GREEN = CASE.replace("{fail: 0.05, warn: 0.3}", "{fail: 0.15}")
"""The cart comes 50 mm too near; the wall can make way."""

STILLS = ["--png", "x.png", "--glb", "x.glb", "--trajectory", "x.csv"]


def stand(folder, name):
    """The case of one more robot, which shares no space with the first."""
    away = CASE.replace("cart.urdf}", "cart.urdf, base: {xyz: [0, 5, 0], rpy: [0, 0, 0]}}")
    (folder / name).write_text(
        away.replace("name: rail", "name: away").replace("wall, b", "fence, b")
    )


GAIN = ["gain", "case.yaml", "--out", "out", "--force", "--kind", "obstacle"]
WORKSPACE = ["workspace", "case.yaml", "away.yaml", "--out", "out"]
REGION = ["workspace.json", "workspace.svg"]
CHECK = ["check", "case.yaml", *STILLS]
COMPARE = ["compare", "report", "report", "--out", "out"]
COMMANDS = {
    "gain": (GAIN, ["gain.json"], ["gain.html"], []),
    "gain, unknown option": (GAIN, ["gain.json"], ["gain.html"], ["--no-such-option"]),
    "workspace": (WORKSPACE, REGION, [], []),
    "workspace, unknown option": (WORKSPACE, REGION, [], ["--no-such-option"]),
    "compare": (COMPARE, [], ["comparison.html"], []),
    "compare, unknown option": (COMPARE, [], ["comparison.html"], ["--no-such-option"]),
    "check": (CHECK, STILLS[1::2], [], []),
    "check, unknown option": (CHECK, STILLS[1::2], [], ["--no-such-option"]),
}  # fmt: skip
"""What answers, the files of its answer, its pages, and what is typed more the second time."""


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_no_older_answer_of_any_command_outlasts_one_that_is_refused(name, folder):
    arguments, names, pages, more = COMMANDS[name]
    (folder / "case.yaml").write_text(GREEN)
    stand(folder, "away.yaml")
    check()
    assert run(arguments) in (0, 1)
    first = files(folder)
    assert {path.rpartition("/")[2] for path in first} > {*names, *pages}

    if not more:
        (folder / "case.yaml").write_text(BAD)
        (folder / "report" / "findings.json").write_text("{")
    assert run([*arguments, *more]) == 2
    for path, text in first.items():
        place = folder / path
        if place.name in names or (LAST in path and "out" in path):
            older = place.with_name(f"{place.stem}.older{place.suffix}")
            assert not place.exists() and older.read_bytes() == text
        if place.name in pages:
            assert b"<title>Not finished: " in place.read_bytes()

    (folder / "case.yaml").write_text(GREEN)
    check()
    assert run(arguments) in (0, 1) and files(folder) == first


@pytest.mark.parametrize(
    ("option", "place", "more"),
    [
        ("--trajectory", "path.csv", []),
        ("--trajectory", "case.yaml", ["--no-such-option"]),
        ("--png", "notes.txt", ["--no-such-option"]),
    ],
)
def test_a_file_that_may_be_an_input_or_anything_else_stays_as_it_is(option, place, more, folder):
    (folder / "notes.txt").write_text("mine")
    (folder / "case.yaml").write_text(BAD)
    first = files(folder)
    assert run(["check", "case.yaml", option, place, *more]) == 2 and files(folder) == first
