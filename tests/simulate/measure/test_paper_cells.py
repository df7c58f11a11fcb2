"""The first paper's method where everything moves: with rules, padding and phases as the exact one, or refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, NothingToMeasure
from clearance.world.case import Clock, Limits
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests import cells


def answered(case, **asked):
    return cl.answer(cl.Question(case, certify=False, **asked)).record


def variants(case):
    rule = Rule(("left/*", "door"), Window(1.0, 4.0), name="at the door", fail=0.02)
    padded = tuple(replace(o, padding=0.01) if o.name == "post" else o for o in case.obstacles)
    return {
        "phases": case,
        "rules": replace(case, limits=Limits(0.01, 0.05, rules=(rule,))),
        "padding": replace(case, obstacles=padded),
    }


@pytest.mark.parametrize("kind", ["phases", "rules", "padding"])
@pytest.mark.parametrize("seed", [0])
def test_it_says_what_the_exact_method_says_where_it_is_right(seed, kind):
    case = variants(cells.cell(seed))[kind]
    exact, paper = answered(case), answered(case, method="paper")
    apart = exact.steps["clearance"].to_numpy() > 0.02
    assert apart.sum() > 10
    for column in ("clearance", *exact.sides[:2]):
        found, wanted = (record.steps[column].to_numpy()[apart] for record in (paper, exact))
        same = (
            found == pytest.approx(wanted, abs=1e-12) if column == "clearance" else found == wanted
        )
        assert np.all(same)
    assert [rule.name for rule in paper.rules] == [rule.name for rule in exact.rules]


def test_a_step_of_which_it_says_nothing_is_named_as_the_run_counts_it():
    case = cells.cell(0)
    with pytest.raises(
        NothingToMeasure, match=r"method 'paper' says nothing of step \d+: its rules"
    ) as caught:
        answered(case, method="paper", paper_tolerance=0.056)
    step = int(str(caught.value).split("step ")[1].split(":")[0])
    assert answered(case).steps["clearance"].to_numpy()[step] > 0.056
    assert "a tolerance above 0.056 m may do" in str(caught.value)


def test_clocks_that_are_not_tied_are_refused():
    case = replace(cells.cell(0), clock=Clock(np.inf), carries=())
    with pytest.raises(BadInput, match="method 'paper' asks about one time"):
        cl.Question(case, method="paper")
