"""The paper's examples from their files: plans, verdicts, roots, the midship section in its
stages."""

from pathlib import Path

import numpy as np
import pytest

from clearance.sketch import Sketch
from tests.examples import first_fast

SKETCHES = Path(__file__).parents[2] / "scenes" / "sketches"


def load(name):
    return Sketch.load(SKETCHES / f"{name}.yaml")


def test_bar_in_the_box_plan_of_figures_7_and_9():
    result = load("bar_in_box").solve()
    assert result.status == "well"
    steps = result.plan
    numeric = [step for step in steps if step.method == "numeric"]
    assert [step.kind for step in numeric] == ["c"]
    assert set(numeric[0].uses) == {"P0_on_bottom", "P1_on_right", "P3_on_left"}
    before = steps[: steps.index(numeric[0])]
    assert [step.kind for step in before] == ["preprocess", "initial", "initial", "a", "b"]
    assert before[2].places == ("P0",) and before[3].places == ("P3",)  # P0, G0, P3: the body R0
    assert numeric[0].figure == "Fig. 8 (c)"
    assert all(step.cluster == 1 for step in before if step.kind != "preprocess")


def test_bar_of_unknown_length_has_both_roots():
    sketch = load("bar_length")
    result = sketch.solve()
    lengths = [sketch.value("length")]
    lengths += [float(np.linalg.norm(a["P1"] - a["P0"])) for a in result.alternatives]
    assert sorted(round(v, 4) for v in lengths) == [10.8149, 12.5679]


def test_extended_cluster_of_figure_11():
    result = load("extended_cluster").solve()
    assert result.status == "well"
    numeric = [step for step in result.plan if step.method == "numeric"]
    assert [step.kind for step in numeric] == ["extended"] and numeric[0].figure == "Fig. 11"
    assert numeric[0] is result.plan[-1]  # the bodies first, then the line and they at once
    assert len(numeric[0].uses) == 8 and "L6" in numeric[0].places
    assert sum(step.kind == "a" for step in result.plan) == 3


def test_under_constrained_sketch_of_figures_12_to_16():
    sketch = load("under_constrained")
    result = sketch.solve()
    assert len(sketch.entities) == 18 and len(sketch.constraints) == 30
    assert result.status == "under" and result.freedom == 3
    assumed = [step.assumptions for step in result.plan if step.assumptions]
    assert assumed == [1, 1, 1]
    assert result.residual <= 1e-12 * 5.0
    merged = [step for step in result.plan if step.method == "numeric"]
    assert [step.figure for step in merged] == ["Fig. 13 (d)"] * 3 + ["Fig. 8 (d)"]


def test_the_course_of_figure_16():
    """Three times a body begins in the cycle of least freedom (steps 2, 4 and 6, each with one assumption,
    Fig. 13 a, as Fig. 17 shows it for P1, P2, P3) and takes in what hangs on it; then all is one (step 7)."""
    sketch = load("under_constrained_cycles")
    result = sketch.solve()
    assert len(sketch.entities) == 18 and len(sketch.constraints) == 30  # 36 - 30 = 6 freedoms left
    assert result.status == "under" and result.freedom == 3 and result.residual <= 1e-12 * 8.0
    steps = result.plan
    course = ["", "", "Fig. 13 (a)", "Fig. 8 (b)", "Fig. 8 (b)", "Fig. 8 (b)"]
    assert [step.figure for step in steps] == [*course, *course, *course, "Fig. 8 (d)"]
    assert [step.assumptions for step in steps if step.assumptions] == [1, 1, 1]
    assert len({step.cluster for step in steps[:18]}) == 3
    for k in (0, 6, 12):  # a cycle of four points: 8 - 4 freedoms, the least there is
        cycle = {p for step in steps[k : k + 4] for p in step.places}
        spans = [c for c in sketch.constraints.values() if {e.name for e in c.entities} <= cycle]
        assert len(cycle) == 4 and len(spans) == 4
    assert len(steps[-1].uses) == 6 and steps[-1].assumptions == 0


def test_rule_b_begins_bodies_in_cycles_without_one():
    """Two rings with spokes: two bodies begin in a cycle each; what is left takes an extended cluster."""
    sketch = load("under_constrained_prism")
    result = sketch.solve()
    assert len(sketch.entities) == 18 and len(sketch.constraints) == 30
    assert result.status == "under" and result.freedom == 3 and result.residual <= 1e-12 * 5.0
    steps = result.plan
    assert [step.assumptions for step in steps if step.assumptions] == [1, 1, 1]
    begun = [step.figure for step in steps if step.assumptions]
    assert begun == ["Fig. 13 (a)", "Fig. 13 (b)", "Fig. 13 (a)"]
    assert steps[-1].figure == "Fig. 11" and steps[-1].assumptions == 0


FREEDOM = {"e": 0, "b": 2, "c": 2, "d": 3}
"""Of each stage of the midship section."""


@pytest.mark.parametrize("stage", first_fast(FREEDOM, 1))
def test_midship_section_stages(stage):
    sketch = load(f"midship_{stage}")
    result = sketch.solve()
    assert result.solved and result.freedom == FREEDOM[stage]
    assert result.status == ("well" if stage == "e" else "under")
    assert result.residual <= 1e-12 * 19.0


def test_midship_section_and_its_design_changes():
    sketch = load("midship_e")
    assert len(sketch.entities) == 106 and len(sketch.constraints) == 173
    result = sketch.solve()
    kinds = {step.kind for step in result.plan if step.method == "numeric"}
    assert kinds == {"c", "extended"}
    changes = {"B": 16.6, "D": 19.4, "h": 2.2, "w": 2.5, "r": 1.9, "t": 11.2}
    for name, value in changes.items():
        sketch.set(name, value)
    changed = sketch.solve()
    assert changed.status == "well" and changed.residual <= 1e-12 * 19.0
    assert sketch.entity("deck_edge").position == pytest.approx([16.6, 19.4])
    assert sketch.entity("deck_edge_p").position == pytest.approx([-16.6, 19.4])
    assert sketch.entity("bilge_p").radius == pytest.approx(1.9)
