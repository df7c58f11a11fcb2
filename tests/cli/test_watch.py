"""`check --watch`: a change of any file that was read is checked; waits are counted, nobody sleeps."""

import shutil
from pathlib import Path

import pytest

from clearance.cli import ExitCode, run, watch
from tests.formats.making import write_case
from tests.report.browser import chromium, executable


class Edits:
    """Each look at the files comes after the next of some edits; after the last the user interrupts."""

    def __init__(self, *edits):
        self.left = list(edits)

    def __call__(self, seconds):
        if not self.left:
            raise KeyboardInterrupt
        edit = self.left.pop(0)
        if edit is not None:
            edit()


def replaced(path: Path, old: str, new: str):
    def edit():
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))

    return edit


@pytest.mark.slow
def test_every_file_that_was_read_is_watched_also_where_the_case_is_bad(
    tmp_path, monkeypatch, capsys
):
    case, waivers = write_case(tmp_path), tmp_path / "w.yaml"
    waivers.write_text("[]\n")
    path, mesh = tmp_path / "path.csv", tmp_path / "upper.stl"
    edits = Edits(
        None,
        replaced(path, "1,0.5", "1,0.75"), None,
        replaced(case, "fail: 0.005", "fail: five"), None,
        replaced(case, "fail: five", "fail: 0.006"), None,
        lambda: mesh.rename(tmp_path / "away"), None,
        lambda: (tmp_path / "away").rename(mesh), None,
        lambda: waivers.write_text("no list\n"), None,
    )  # fmt: skip
    monkeypatch.setattr("time.sleep", edits)
    command = ["check", str(case), "--watch", "-q", "--waivers", str(waivers)]
    assert run(command) == ExitCode.INTERRUPTED
    told = capsys.readouterr()
    heads = [line[:22] for line in told.out.splitlines() if not line.startswith(" ")]
    assert heads == ["CLEAR  small: least cl"] * 4
    errors = [line for line in told.err.splitlines() if not line.startswith("watching")]
    assert [part in line for part, line in zip(
        ["limits.fail", "upper.stl", "w.yaml", "interrupted"], errors, strict=True
    )] == [True] * 4  # fmt: skip


@pytest.mark.slow
def test_a_file_that_is_still_being_written_is_waited_for(tmp_path, monkeypatch):
    path, seen = tmp_path / "a", []
    path.write_text("")
    parts = [lambda n=n: (path.write_text("x" * n), seen.append(n)) for n in (1, 2, 3)]
    monkeypatch.setattr("time.sleep", Edits(None, *parts, None))
    watch.wait_for_change({path: watch.state_of(path)})
    assert seen == [1, 2, 3]


def test_the_page_is_as_the_report_has_it_once_watching_ends(tmp_path, monkeypatch):
    case, out = write_case(tmp_path), tmp_path / "out"
    pages = []
    script = out / watch.SCRIPT

    def look():
        pages.append(((out / "report.html").read_text(), script.read_text()))

    bad = replaced(case, "fail: 0.005", "fail: five")
    monkeypatch.setattr("time.sleep", Edits(look, bad, None, look))
    assert run(["check", str(case), "--watch", "--out", str(out)]) == ExitCode.INTERRUPTED
    (first, told), (second, told_later) = pages
    for page, name in ((first, told), (second, told_later)):
        assert name.removeprefix("reportIs").strip(";\n()") in page
    assert told != told_later and "what follows is older" in second and not script.exists()
    replaced(case, "fail: five", "fail: 0.005")()
    shutil.rmtree(out)
    assert run(["check", str(case), "--out", str(out)]) == ExitCode.CLEAR
    assert (out / "report.html").read_text() == first.partition("\n<script>/* clearance check")[0]


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_the_page_loads_itself_anew(tmp_path):
    page = tmp_path / "report.html"
    page.write_text("<html><body><p>one</p></body></html>")
    watch.publish(tmp_path)
    with chromium() as tab:
        tab.open(page.as_uri(), "document.querySelector('p')?.textContent === 'one'")
        page.write_text("<html><body><p>two</p></body></html>")
        watch.publish(tmp_path)
        tab.wait("document.querySelector('p')?.textContent === 'two'")
