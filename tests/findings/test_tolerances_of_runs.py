"""Tolerances of whole runs: kept, not proven, and with waivers, whose levels their pairs are held against."""

from dataclasses import replace
from datetime import date

import pytest

import clearance as cl
from clearance.findings.finding import NOT_PROVEN, TOLERANCES, WAIVED_TOLERANCES
from clearance.world.rules import Waiver
from tests.findings.gates import load_gates
from tests.report.made import printed, write_junit

GATES = {"left": (-0.5, 0.003), "right": (0.5, 0.008)}
WAIVER = Waiver(("*", "left"), at_least=0.002, reason="known", by="J. Doe", until=date(2999, 1, 1))


def asked(folder, xyz, *, gates=GATES, waivers=(WAIVER,), **others):
    case = replace(load_gates(folder, gates), waivers=tuple(waivers))
    return cl.check(case, tolerance={"base": {"xyz": xyz}, **others})


def kinds(run):
    return [one.kind for one in run.findings if one.status == NOT_PROVEN]


@pytest.mark.parametrize(
    ("xyz", "status", "found"),
    [
        (0.0005, "near", []),
        (0.0015, "not proven", [WAIVED_TOLERANCES]),
        (0.0035, "not proven", [WAIVED_TOLERANCES, TOLERANCES]),
    ],
)
def test_waived_pairs_are_held_against_their_waiver(tmp_path, xyz, status, found):
    run = asked(tmp_path, xyz)
    assert (run.status, sorted(kinds(run)), run.passed) == (status, sorted(found), not found)
    assert run.verdict.n_waivers == 1


def test_what_is_proven_of_a_waiver_is_that_of_its_pairs(tmp_path):
    run = asked(tmp_path, 0.0015)
    (finding,) = [one for one in run.findings if one.kind == WAIVED_TOLERANCES]
    assert (finding.body_a, finding.body_b) == ("*", "left")
    assert finding.proven == pytest.approx(0.0015, abs=1e-4)
    assert "not proven to keep the 2 mm of its waiver with the tolerances" in run.verdict.reasons[0]
    assert "mm proven, 2 mm required by a waiver)" in run.verdict.headline()
    write_junit(run, tmp_path / "junit.xml")
    assert 'classname="tolerances"' in (tmp_path / "junit.xml").read_text()


def test_what_waived_pairs_keep_is_told_against_their_waiver(tmp_path):
    run = asked(tmp_path, 0.0005)  # 3 mm less 0.5 mm, waived to 2 mm; 8 mm less 0.5 mm, of 5 mm
    rows = run.summary["tolerances"]["rules"]
    keys = ("waived", "fail", "keeps", "proven")
    assert [[row[key] for key in keys] for row in rows] == [
        [None, 0.005, True, pytest.approx(0.0075, abs=1e-4)],
        [["*", "left"], 0.002, True, pytest.approx(0.0025, abs=1e-4)],
    ]
    (base,) = rows[1]["worst"][0]["sources"]
    assert 0.0009 < base["largest"][0] <= 0.001  # a proof is off by 0.1 mm at most
    lines = printed(run)
    assert any("keeps the 2 mm of its waiver, others as given: base of" in one for one in lines)
    assert not any("not enough" in one for one in lines)
