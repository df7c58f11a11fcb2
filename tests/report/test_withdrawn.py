"""An older report is marked while a run into its folder has not come to its end."""

import pytest

from clearance.cli import run
from clearance.files import LAST
from clearance.report.withdrawn import OLDER_SUMMARY, marked_page, withdraw_report
from tests.cart import write_cart


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cart(tmp_path / "in")
    monkeypatch.chdir(tmp_path / "in")
    return tmp_path / "in"


def check():
    return run(["check", "case.yaml", "--out", "report", "--quiet"])


def content(place):
    return {path.name: path.read_bytes() for path in place.iterdir()}


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
