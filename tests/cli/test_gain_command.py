"""`clearance gain` as someone at a terminal meets it: lines, exit codes, files."""

import json

import pytest

import clearance as cl
from clearance.cli import run
from tests.gains.making_gain import CROSSING, SLOT, write_cell


@pytest.fixture
def slot(tmp_path):
    return write_cell(tmp_path / "cell", SLOT)


def said(capsys, *arguments):
    code = run(["gain", *map(str, arguments)])
    told = capsys.readouterr()
    return code, told.out, told.err


@pytest.mark.slow
def test_a_change_that_is_enough_is_told_and_written(slot, tmp_path, capsys):
    out = tmp_path / "out"
    code, text, _ = said(capsys, slot, "--kind", "obstacle", "--obstacle", "left", "--out", out)
    assert code == 0
    assert "before    tool and left: 19.99 mm" in text
    assert "changed   obstacle left moved 20.001 mm: x 0, y +20.001, z 0" in text
    assert "bound     at least 19.99 mm is needed; this change is within 0.1 % of the least" in text
    assert run(["check", str(out / "case.yaml")]) == 0


def test_a_shift_keeps_within_its_room(slot, capsys):
    code, text, _ = said(capsys, slot, "--kind", "base", "--within-mm", "0,19,0")
    assert code == 1 and "no change within what is allowed is large enough" in text
    code, text, _ = said(capsys, slot, "--kind", "base", "--within-mm", "0,-21:0,0")
    assert code == 0 and "moved 20.001 mm: x 0, y -20.001, z 0" in text


@pytest.mark.slow
def test_a_turn_is_told_and_written(slot, tmp_path, capsys):
    path, out = slot.parent / "turned.yaml", tmp_path / "out"
    path.write_text(slot.read_text().replace("[0.5, 0.4, 2.0]}\n    pose: {xyz: [0.0, 0.3, 0.0]}",
                    "[0.5, 0.4, 2.0]}\n    pose: {xyz: [0.0, 0.3, 0.0], rpy: [0, 0, 0.1]}"))  # fmt: skip
    options = ("--kind", "obstacle", "--obstacle", "left", "--within-mm", "0,30,0", "--turn", "z")
    code, text, _ = said(capsys, path, *options, "--out", out)
    assert code == 0 and " deg about z through its origin (1 deg counts as 8.73 mm)" in text
    assert "turn about z" in (out / "gain.html").read_text()
    assert run(["check", str(out / "case.yaml")]) == 0


@pytest.mark.slow
def test_what_cannot_be_kept_says_what_blocks(slot, tmp_path, capsys):
    out = tmp_path / "out"
    code, text, _ = said(capsys, slot, "--kind", "waypoints", "--keep", "0.9:1.1", "--out", out)
    assert code == 1 and "that moment is to be kept" in text
    assert "no change of this kind can make every rule hold" in text
    page = (out / "gain.html").read_text()
    assert "case.yaml is the best that was reached, which does not keep every rule" in page
    assert "Least change" not in page and "free-ends" not in text
    code, text, _ = said(capsys, slot, "--kind", "waypoints", "--margin-mm", "20")
    assert code == 1 and "binding   tool and right have no more to give" in text
    assert "can make" not in text and "not written into the changed case" in text
    code, text, _ = said(capsys, slot, "--kind", "all", "--margin-mm", "20", "--within-mm", "0,1,0")
    assert code == 1 and "waypoints" in text


@pytest.mark.slow
def test_a_slow_down_is_told(tmp_path, capsys):
    path = write_cell(tmp_path, CROSSING)
    options = ("--kind", "timing", "--robot", "other", "--slow-down", "--out", tmp_path / "out")
    code, text, _ = said(capsys, path, *options)
    assert code == 0 and " % longer for its path: 0." in text and "bound     at least " in text
    assert "takes longer" in (tmp_path / "out" / "gain.html").read_text()
    assert run(["check", str(tmp_path / "out" / "case.yaml")]) == 0


@pytest.mark.parametrize(
    "options, told",
    [
        (["--kind", "obstacle"], "there are several obstacles; name one with --obstacle; one of left, right"),
        (["--kind", "obstacle", "--obstacle", "lift"], "did you mean 'left'?"),
        (["--kind", "all", "--robot", "bat"], "did you mean 'bar'?"),
        (["--kind", "waypoints", "--keep", "5:6"], "is not in the run; times from 0.5 s to 1.5"),
        (["--kind", "base", "--keep", "1:2"], "keep says nothing with kind base; kind waypoints"),
        (["--kind", "all", "--about-mm", "1,2,3"], "--about-mm says nothing without --turn"),
        (["--kind", "base", "--within-mm", "5,5"], "'5,5' is given; ranges of x, y and z"),
        (["--kind", "waypoints", "--keep-tool", "1=2mm,1deg", "--tool", "toll"], "mean 'tool'?"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(slot, tmp_path, refusal, options, told):
    assert told in refusal("gain", slot, *options, "--out", tmp_path / "out")


@pytest.mark.slow
def test_all_kinds_are_tried_with_each_of_several_robots(tmp_path, refusal, capsys):
    path, out = write_cell(tmp_path, CROSSING), tmp_path / "out"
    code, text, _ = said(capsys, path, "--kind", "all", "--out", out)
    assert code == 0 and "none is named" not in text
    for kind in ("waypoints", "base", "timing"):
        for robot in ("one", "other"):
            assert f"\n{kind}/{robot} " in text
            figures = json.loads((out / kind / robot / "gain.json").read_text())
            assert cl.check(out / kind / robot / "case.yaml").passed == figures["kept"]
            assert figures["who"] == robot and (figures["kept"] or kind == "waypoints")
    assert "--force overwrites it" in refusal("gain", path, "--kind", "all", "--out", out)
    again = ["gain", str(path), "--kind", "all", "--out", str(out), "--force", "--no-such-option"]
    assert run(again) == 2
    assert "Not finished" in (out / "base" / "one" / "gain.html").read_text()


def test_where_no_kind_applies_it_is_bad_input(slot, capsys):
    slot.write_text(slot.read_text().replace("trajectory: {file: path.csv, start: 0.5}",
                    "trajectory: {file: path.csv, after: loop}"))  # fmt: skip
    code, text, _ = said(capsys, slot, "--kind", "all", "--within-mm", "0,0,0")
    assert code == 2 and text.count("does not apply") == 4


@pytest.mark.slow
def test_what_was_found_is_written_before_the_reader_of_its_lines_leaves(
    slot, tmp_path, monkeypatch
):
    def leave(*given, **more):
        raise BrokenPipeError

    monkeypatch.setattr("click.echo", leave)
    out = tmp_path / "out"
    assert run(["gain", str(slot), "--kind", "base", "--out", str(out)]) == 141
    assert {"case.yaml", "gain.json", "gain.html"} <= {path.name for path in out.iterdir()}
