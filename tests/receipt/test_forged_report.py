"""Reports that somebody has changed, hashes and all, differ from a fresh run, or are not called verified."""

from __future__ import annotations

import functools
import hashlib
import json
import lzma
import operator
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

import clearance as cl
from clearance.errors import BadInput, BadSyntax, MissingFile
from clearance.findings.comparison import compared
from clearance.receipt import remade_report, verifying
from clearance.receipt.receipt_file import FILE_NAME, read_receipt
from clearance.run import Run
from clearance.world.rules import Waiver
from tests.receipt.receipts import rewritten, saved, turning_arm
from tests.receipt.test_forged import loose

OTHER = {"numpy": "1.0"}


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("told")
    saved(turning_arm(), folder)
    return folder


@pytest.fixture(scope="module")
def report_with_tolerances(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loose")
    saved(loose(), folder)
    return folder


@pytest.fixture
def answered_once(monkeypatch, tmp_path):
    """A case is answered, proven and reported once, however often one asks: it is the same each time."""
    made = tmp_path / "made"
    monkeypatch.setattr(tempfile, "TemporaryDirectory", lambda: nullcontext(made))
    monkeypatch.setattr(lzma, "compress", functools.cache(lzma.compress))
    monkeypatch.setattr(Run, "save", once(Run.save))
    monkeypatch.setattr(remade_report, "maker", once(remade_report.maker))
    for name in ("answer", "proven", "case_data"):
        monkeypatch.setattr(verifying, name, once(getattr(verifying, name)))


def once(function):
    """A function that is called once, and gives the same ever after."""
    answers = []

    def same(*args):
        if not answers:
            answers.append(function(*args))
        return answers[0]

    return same


def hashed(folder: Path, *names: str, **head) -> None:
    """Writes the hashes of files of the report into its receipt, and what else of the head is given."""
    own = read_receipt(folder / FILE_NAME).head
    new = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names}
    rewritten(folder, head=own | {"report": own["report"] | new} | head)


def with_summary(folder: Path, change) -> None:
    """Changes the summary, and writes its hash into the receipt."""
    path = folder / "summary.json"
    summary = json.loads(path.read_text())
    change(summary)
    path.write_text(json.dumps(summary, indent=2, sort_keys=True, ensure_ascii=False) + "\n")
    hashed(folder, path.name)


def first_line(folder: Path, case=None) -> str:
    """What a reader sees first, be it refused or not."""
    try:
        return cl.verify(folder, case or turning_arm()).headline
    except BadInput as error:
        return f"refused: {error}"


def forged(value):
    """A value that could stand in the place of another one."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + (1 if isinstance(value, int) else 0.05)
    if isinstance(value, str):
        return {"clear": "near", "near": "clear"}.get(value, f"{value}1")
    return 0.5 if value is None else ["1"] if value == [] else {"one": 1}


def leaves(told, way=()) -> Iterator[tuple]:
    """The ways to all values in a summary, and to what is empty."""
    if not isinstance(told, dict | list) or not told:
        yield way
        return
    for key, value in told.items() if isinstance(told, dict) else enumerate(told):
        yield from leaves(value, (*way, key))


def part_of(key: str, value) -> str:
    """A key of a summary as its file has it."""
    return json.dumps({key: value}, indent=2, sort_keys=True, ensure_ascii=False)[1:-2]


def forgeries(told: str) -> Iterator[tuple[tuple, str]]:
    """The text of a summary with each of its values changed, and with each key of it left out."""
    summary = json.loads(told)
    parts = {key: part_of(key, summary[key]) for key in sorted(summary)}

    def text_of(parts: dict[str, str]) -> str:
        return "{" + ",".join(parts.values()) + "\n}\n"

    assert text_of(parts) == told
    for way in list(leaves(summary)):
        *above, key = way
        place = functools.reduce(operator.getitem, above, summary)
        own = place[key]
        place[key] = forged(own)
        yield way, text_of(parts | {way[0]: part_of(way[0], summary[way[0]])})
        place[key] = own
    for key in parts:
        yield ("without", key), text_of({name: one for name, one in parts.items() if name != key})


@pytest.mark.slow
def test_the_report_as_it_is_passes(folder):
    with_summary(folder, lambda summary: None)
    found = cl.verify(folder, turning_arm())
    assert found.proven and not found.not_verified and found.verdict == "clear"
    assert "matches a fresh run" in found.headline


@pytest.mark.slow
def test_no_value_of_the_summary_can_be_changed(report_with_tolerances, tmp_path, answered_once):
    folder = Path(shutil.copytree(report_with_tolerances, tmp_path / "report"))
    path, case = folder / "summary.json", loose()
    told, n = path.read_text(), 0
    for way, text in forgeries(told):
        path.write_text(text)
        hashed(folder, path.name)
        line = first_line(folder, case)
        assert line.startswith("NOT PROVEN: summary.json differs from a fresh run"), way
        n += 1
    assert n > 500
    path.write_text(told)
    hashed(folder, path.name)
    assert first_line(folder, case).startswith("PROVEN: at least 48.")


@pytest.mark.slow
def test_no_value_of_the_summary_passes_as_made_elsewhere(report, tmp_path, answered_once):
    """Who calls another program the maker has the files named, in the first line, as not verified."""
    folder = Path(shutil.copytree(report, tmp_path / "report"))
    path, case = folder / "summary.json", turning_arm()
    maker = read_receipt(folder / FILE_NAME).head["maker"] | OTHER
    seen = set()
    for way, text in forgeries(path.read_text()):
        keys = tuple(key for key in way if isinstance(key, str))
        if keys in seen:  # of each list its first
            continue
        seen.add(keys)
        path.write_text(text)
        hashed(folder, path.name, maker=maker)
        line = first_line(folder, case)
        is_refused = line.startswith("NOT PROVEN: summary.json says")
        told = line.startswith("PROVEN, NOT VERIFIED: summary.json (made by numpy 1.0, here")
        decides = way[-1] in ("verdict", "clearance", "lower_bound") and way[0] != "versions"
        assert is_refused or (told and not decides), way


TABLES = ("steps.csv", "contacts.csv", "budget.csv", "findings.json", "worst_moments.yaml")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*TABLES, "report.html"])
def test_a_table_or_page_that_says_something_else_is_found(name, report_with_tolerances, tmp_path):
    folder = Path(shutil.copytree(report_with_tolerances, tmp_path / "report"))
    path = folder / name
    text = path.read_text(encoding="utf-8")
    last = list(re.finditer(r"[0-8]|[a-y](?=,)", text))[-1]
    other = chr(ord(last.group()) + 1)
    path.write_text(text[: last.start()] + other + text[last.end() :], encoding="utf-8")
    hashed(folder, name)
    assert re.match(
        rf"NOT PROVEN: {name} differs from a fresh run: line \d+ is ", first_line(folder, loose())
    )


@pytest.mark.slow
def test_data_that_is_not_that_of_the_case_is_found(folder):
    name = "steps.parquet"
    content = bytearray((folder / name).read_bytes())
    content[len(content) // 2] ^= 1
    (folder / name).write_bytes(content)
    hashed(folder, name)
    assert first_line(folder).startswith(f"NOT PROVEN: {name} differs from a fresh run: its")


def test_a_page_of_its_own_is_found(folder):
    (folder / "report.html").write_text("<h1>CLEAR: 500 mm</h1>\n")
    hashed(folder, "report.html")
    assert first_line(folder).startswith("NOT PROVEN: report.html differs from a fresh run")
    hashed(folder, compared=True)
    assert first_line(folder).startswith(
        "PROVEN, NOT VERIFIED: report.html (it shows a comparison with another run): at least"
    )


def test_a_table_that_no_run_of_the_case_writes_is_found(folder):
    (folder / "budget.csv").write_text("proven\n0.1\n")
    with pytest.raises(BadSyntax, match=r"budget.csv: it was not there"):
        cl.verify(folder, turning_arm())
    hashed(folder, "budget.csv")
    told = "NOT PROVEN: budget.csv differs from a fresh run: the fresh run has no such file"
    assert first_line(folder) == told


@pytest.mark.parametrize("named", [True, False])
def test_a_file_that_was_taken_away_is_not_called_verified(named, folder):
    """Whether the receipt still names it or not."""
    (folder / "contacts.csv").unlink()
    told = read_receipt(folder / FILE_NAME).head["report"]
    if not named:
        del told["contacts.csv"]
        rewritten(folder, head=read_receipt(folder / FILE_NAME).head | {"report": told})
    line = first_line(folder)
    assert line.startswith("PROVEN, NOT VERIFIED: contacts.csv (not in the folder): at least")
    assert "every byte" not in line


def test_what_lies_beside_the_report_is_not_called_verified(folder):
    (folder / "junit.xml").write_text('<testsuite tests="1" failures="0"/>')
    (folder / "index.html").write_text("<h1>CLEAR: 500 mm</h1>\n")
    line = first_line(folder)
    told = "PROVEN, NOT VERIFIED: index.html, junit.xml (not part of the report): at least"
    assert line.startswith(told) and "every byte" not in line
    for word in ("a\x1b[2K", "b" * 200, "c", "d"):
        (folder / word).mkdir()
    line = first_line(folder)
    assert "c, and 3 more (not part of the report)" in line and line.isprintable()


def violated() -> cl.Case:
    return replace(turning_arm(), limits=cl.Limits(0.15, 0.3))


@pytest.fixture(scope="module")
def violated_report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("violated")
    saved(violated(), folder)
    return folder


@pytest.mark.slow
def test_a_violated_run_whose_limits_were_lowered_is_found(violated_report, tmp_path):
    shutil.copytree(violated_report, tmp_path, dirs_exist_ok=True)

    def lowered(summary):
        summary["limits"] |= {"fail": 0.001, "warn": 0.002}
        summary["rules"][0] |= {"fail": 0.001, "warn": 0.002, "status": "clear"}
        summary |= {"verdict": "clear", "verdict_text": "clear", "measured": "clear"}
        summary |= {"passed": True, "exit_code": 0}

    with_summary(tmp_path, lowered)
    assert first_line(tmp_path, violated()).startswith(
        "NOT PROVEN: summary.json differs from a fresh run"
    )
    hashed(tmp_path, maker=read_receipt(tmp_path / FILE_NAME).head["maker"] | OTHER)
    told = "NOT PROVEN: summary.json says 'clear', a fresh run says violated"
    assert first_line(tmp_path, violated()) == told


def test_a_clearance_that_was_raised_is_found_whatever_made_the_report(folder):
    def raised(summary):
        summary["worst"]["clearance"] += 0.8

    with_summary(folder, raised)
    hashed(folder, maker=read_receipt(folder / FILE_NAME).head["maker"] | OTHER)
    told = r"NOT PROVEN: summary\.json says \S+ for worst\.clearance, a fresh run says \S+"
    assert re.fullmatch(told, first_line(folder))


@pytest.mark.slow
def test_a_violated_run_is_not_read_as_one_that_keeps_its_limits(violated_report):
    found = cl.verify(violated_report, violated())
    assert found.proven and found.verdict == "violated" and found.below == {"default": 0.15}
    assert "(default, BELOW ITS LIMIT of 150 mm)" in found.headline
    assert "; verdict violated; self-collision not checked [CL531]; every byte" in found.headline


@pytest.mark.slow
def test_limits_that_are_not_those_of_the_case_are_told(tmp_path):
    """A run that was asked with lower limits is right, and its first line says what was asked."""
    asked = replace(violated(), limits=cl.Limits(0.001, 0.002))
    saved(asked, tmp_path)
    found = cl.verify(tmp_path, violated())
    told = "verdict clear (fail 1 mm, not the case's 150 mm; warn 2 mm, not the case's 300 mm)"
    assert found.proven and told in found.headline
    assert "not the case's" not in cl.verify(tmp_path, asked).headline


def waived() -> cl.Case:
    waiver = Waiver(
        ("bar", "block"), at_least=0.04, reason="by eye", by="A. Bee", until=date(2900, 1, 1)
    )
    return replace(violated(), waivers=(waiver,))


@pytest.mark.slow
def test_waivers_that_a_report_tells_of_and_the_case_does_not_have_are_found(
    violated_report, tmp_path
):
    shutil.copytree(violated_report, tmp_path, dirs_exist_ok=True)

    def one_waiver(summary):
        summary |= {"verdict": "clear", "n_waivers": 1}

    with_summary(tmp_path, one_waiver)
    assert first_line(tmp_path, violated()).startswith(
        "NOT PROVEN: summary.json differs from a fresh run"
    )


@pytest.mark.slow
def test_a_verdict_that_rests_on_waivers_says_so_and_of_which_day(tmp_path):
    saved(waived(), tmp_path)
    asked = read_receipt(tmp_path / FILE_NAME).head["asked"]
    line = first_line(tmp_path, waived())
    assert "BELOW ITS LIMIT of 150 mm" in line
    assert f"with 1 waiver (waivers as of {asked['today']})" in line
    hashed(tmp_path, asked=asked | {"today": "2900-01-02"})
    assert first_line(tmp_path, waived()).startswith(
        "NOT PROVEN: summary.json differs from a fresh run"
    )


@pytest.mark.slow
def test_a_page_that_shows_a_comparison_is_not_called_verified(tmp_path):
    run = cl.check(turning_arm())
    findings = run.finding_list
    run.save(tmp_path, compared(findings, findings))
    cl.write_receipt(run, tmp_path)
    found = cl.verify(tmp_path, turning_arm())
    assert found.proven and found.headline.startswith("PROVEN, NOT VERIFIED: report.html (it ")


def test_no_receipt_is_written_beside_the_report_of_another_run(tmp_path):
    cl.check(violated()).save(tmp_path)
    with pytest.raises(BadInput, match=r"not the report of this run: line \d+ is .*run.save"):
        cl.write_receipt(cl.check(turning_arm()), tmp_path)


@pytest.mark.parametrize(
    "change",
    [
        {"need": "most"},
        {"today": 5},
        {"levels": [0.02]},
        {"levels": [0.02, 0.01]},
        {"accept": None},
        {"certify": False},
        {"inside": False},
        {"method": "paper"},
        {"motion": "simulated"},
        {"certify_gap": "0"},
    ],
)
def test_a_question_that_is_none_or_proves_nothing_is_refused(folder, change):
    head = read_receipt(folder / FILE_NAME).head
    rewritten(folder, head=head | {"asked": head["asked"] | change})
    with pytest.raises(BadInput) as told:
        cl.verify(folder, turning_arm())
    assert str(told.value).isprintable()


def test_another_question_has_another_report(folder):
    head = read_receipt(folder / FILE_NAME).head
    rewritten(folder, head=head | {"asked": head["asked"] | {"need": "limit"}})
    assert first_line(folder).startswith("NOT PROVEN: summary.json differs from a fresh run")


def test_inputs_of_which_the_case_knows_nothing_are_refused(folder):
    head = read_receipt(folder / FILE_NAME).head
    forged = {"path": "x)\n\x1b[2KPROVEN: at least 99.000 mm", "sha256": "0" * 64}
    rewritten(folder, head=head | {"inputs": [*head["inputs"], forged]})
    with pytest.raises(BadSyntax, match="was an input of the run") as told:
        cl.verify(folder, turning_arm())
    assert str(told.value).isprintable() and "\\n\\x1b[2KPROVEN" in str(told.value)


@pytest.mark.slow
def test_an_input_is_told_once_and_with_the_hash_that_was_compared(tmp_path):
    case = cl.load_case(Path(__file__).parents[2] / "scenes" / "box_box" / "case.yaml")
    saved(case, tmp_path)
    inputs = read_receipt(tmp_path / FILE_NAME).head["inputs"]
    hashed(tmp_path, inputs=[{**inputs[0], "sha256": "0" * 64}, *inputs])
    found = cl.verify(tmp_path, case)
    assert found.inputs == tuple((one["path"], one["sha256"]) for one in inputs)


@pytest.mark.parametrize("word", ["x\n\x1b[2KPROVEN: at least 99.000 mm", "9" * 5000])
def test_names_in_a_receipt_cannot_write_a_line_of_their_own(folder, word):
    path = folder / "summary.json"
    path.write_text(path.read_text() + " ")
    maker = read_receipt(folder / FILE_NAME).head["maker"]
    hashed(folder, path.name, maker=maker | {"numpy": word, word: word})
    line = first_line(folder)
    assert line.startswith("PROVEN, NOT VERIFIED: summary.json") and line.isprintable()
    assert len(line) < 1000


def test_a_receipt_of_another_version_says_so_where_numbers_differ(folder):
    head = read_receipt(folder / FILE_NAME).head
    maker = head["maker"] | {"clearance": "0.0.1"}
    rewritten(folder, head=head | {"maker": maker})
    assert cl.verify(folder, turning_arm()).proven
    rewritten(folder, head=head | {"maker": maker, "data": "0" * 64})
    with pytest.raises(BadSyntax, match=r"clearance 0.0.1, here"):
        cl.verify(folder, turning_arm())


@pytest.mark.parametrize("key", ["case", "tolerance", "waivers"])
@pytest.mark.parametrize("way", ["a" * 5000, "\x00", "x\ny.yaml"])
def test_a_way_that_leads_nowhere_is_told_in_one_line(folder, key, way):
    hashed(folder, **{key: [way] if key == "waivers" else way})
    with pytest.raises(MissingFile, match="there is no") as told:
        cl.verify(folder, None if key == "case" else turning_arm())
    assert str(told.value).isprintable()
