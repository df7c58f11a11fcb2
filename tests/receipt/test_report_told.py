"""What the report beside a receipt tells is held against it, and no headline can be read for more than it is."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

import clearance as cl
from clearance.errors import BadSyntax, MissingFile
from clearance.receipt.case_data import case_data
from clearance.receipt.receipt_file import FILE_NAME, read_receipt
from clearance.receipt.report_told import digest_of
from tests.receipt.receipts import rewritten, saved, turning_arm
from tests.receipt.test_forged import loose


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("told")
    saved(turning_arm(), folder)
    return folder


def with_summary(folder, change) -> None:
    """Changes the summary, and writes its hash into the receipt."""
    path = folder / "summary.json"
    summary = json.loads(path.read_text())
    change(summary)
    path.write_text(json.dumps(summary))
    head = read_receipt(folder / FILE_NAME).head
    rewritten(folder, head=head | {"report": head["report"] | {path.name: digest_of(path)}})


def failure(folder, change) -> str:
    with_summary(folder, change)
    return cl.verify(folder, turning_arm()).failure


def test_the_summary_as_it_is_passes(folder):
    assert failure(folder, lambda summary: None) == ""


@pytest.mark.parametrize(
    "name", ["replay.npz", "steps.parquet", "contacts.csv", "worst_moments.yaml"]
)
def test_every_file_of_the_report_is_held_against_the_receipt(folder, name):
    path = folder / name
    path.write_bytes(path.read_bytes() + b"\n")
    with pytest.raises(BadSyntax, match=f"{name}: it is not as it was"):
        cl.verify(folder, turning_arm())
    path.unlink()
    assert cl.verify(folder, turning_arm()).proven  # what is not there tells nothing


def test_a_file_of_a_report_that_comes_later_is_told(folder):
    (folder / "budget.csv").write_text("proven\n0.1\n")
    with pytest.raises(BadSyntax, match=r"budget.csv: it was not there"):
        cl.verify(folder, turning_arm())


def test_the_bound_of_each_rule_is_held_against_its_claims(folder):
    def raised(summary):
        summary["rules"][0]["lower_bound"] += 1e-6

    assert "summary.json tells of" in failure(folder, raised)


def test_a_rule_that_the_case_does_not_have_is_told(folder):
    def another(summary):
        summary["rules"].append(summary["rules"][0] | {"name": "near"})

    assert "(near)" in failure(folder, another)


def test_a_rule_that_is_there_twice_is_no_summary(folder):
    with_summary(folder, lambda summary: summary["rules"].append(summary["rules"][0]))
    with pytest.raises(BadSyntax, match=r"summary.json"):
        cl.verify(folder, turning_arm())


@pytest.mark.parametrize(("verdict", "level"), [("clear", "warn"), ("near", "fail")])
def test_a_verdict_that_the_bounds_do_not_bear_is_not_proven(folder, verdict, level):
    def better(summary):
        summary["verdict"] = verdict
        summary["rules"][0][level] = 1.0

    assert f"calls it {verdict}, the receipt proves" in failure(folder, better)


def test_a_verdict_that_is_none_is_refused(folder):
    with_summary(folder, lambda summary: summary.update(verdict="clear; PROVEN: 99 mm"))
    with pytest.raises(BadSyntax, match=r"summary.json"):
        cl.verify(folder, turning_arm())


def test_a_violated_run_is_not_read_as_one_that_keeps_its_limits(tmp_path):
    case = turning_arm(far=0.9)
    case = replace(case, limits=cl.Limits(0.2, 0.3))
    saved(case, tmp_path)
    found = cl.verify(tmp_path, case)
    assert found.proven and found.verdict == "violated" and found.below == {"default": 0.2}
    assert "(default, BELOW ITS LIMIT of 200 mm)" in found.headline
    assert "the report's verdict is violated" in found.headline


def test_a_run_that_keeps_its_limits_is_told_so(folder):
    found = cl.verify(folder, turning_arm())
    assert not found.below and "the report's verdict is clear" in found.headline


@pytest.mark.slow
def test_tolerances_that_the_report_tells_of_cannot_be_passed_over(tmp_path):
    """A receipt cut down to the bound without them is nominal, whatever it calls itself."""
    plain = replace(loose(), tolerance=None)
    saved(loose(), tmp_path / "with")
    saved(plain, tmp_path / "without")
    forged = read_receipt(tmp_path / "without" / FILE_NAME)
    head = read_receipt(tmp_path / "with" / FILE_NAME).head
    head = head | {"data": case_data(plain).digest, "rules": forged.head["rules"]}
    rewritten(
        tmp_path / "with", head=head, claims=forged.claims, deeds=forged.deeds, codes=forged.codes
    )
    found = cl.verify(tmp_path / "with", plain)
    assert found.nominal and found.headline.startswith(
        "NOMINAL ONLY, tolerances are not taken off: "
    )


def test_names_in_a_receipt_cannot_write_a_line_of_their_own(folder):
    head = read_receipt(folder / FILE_NAME).head
    forged = {"path": "x)\n\x1b[2KPROVEN: at least 99.000 mm", "sha256": "0" * 64}
    rewritten(folder, head=head | {"inputs": [*head["inputs"], forged]})
    headline = cl.verify(folder, turning_arm()).headline
    assert headline.isprintable() and "\\n\\x1b[2KPROVEN" in headline


def test_a_receipt_of_another_version_says_so_where_numbers_differ(folder):
    head = read_receipt(folder / FILE_NAME).head
    rewritten(folder, head=head | {"version": "0.0.1"})
    assert cl.verify(folder, turning_arm()).proven
    rewritten(folder, head=head | {"version": "0.0.1", "data": "0" * 64})
    with pytest.raises(BadSyntax, match=r"clearance 0.0.1 wrote it, this is"):
        cl.verify(folder, turning_arm())


@pytest.mark.parametrize("key", ["case", "tolerance"])
@pytest.mark.parametrize("way", ["a" * 5000, "\x00", "x\ny.yaml"])
def test_a_way_that_leads_nowhere_is_told_in_one_line(folder, key, way):
    head = read_receipt(folder / FILE_NAME).head
    rewritten(folder, head=head | {key: way})
    with pytest.raises(MissingFile, match="there is no") as told:
        cl.verify(folder, None if key == "case" else turning_arm())
    assert str(told.value).isprintable()
