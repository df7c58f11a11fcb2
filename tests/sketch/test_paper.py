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
    assert len(numeric) == 1
    assert set(numeric[0].uses) == {"P0_on_bottom", "P1_on_right", "P3_on_left"}
    before = steps[: steps.index(numeric[0])]
    assert [step.places for step in before] == [
        ("near", "far"),
        ("P0",),
        ("P3",),
        ("P1",),
    ]  # a body
    assert [step.assumptions for step in steps] == [2, 1, 0, 0, 0, 0]  # where the body lies


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
    assert numeric == [result.plan[-1]]  # the bodies first, then the line and they at once
    assert len(numeric[0].uses) == 8 and "L6" in numeric[0].places
    assert [step.assumptions for step in result.plan] == [2, 1, 0] * 3 + [0]


@pytest.mark.parametrize("name", ["", "_cycles", "_prism"])
def test_under_constrained_sketches_of_figures_12_to_16(name):
    sketch = load(f"under_constrained{name}")
    result = sketch.solve()
    assert len(sketch.entities) == 18 and len(sketch.constraints) == 30  # 36 - 30 = 6 freedoms left
    assert result.status == "under" and result.freedom == 3 and result.residual <= 1e-12 * 5.0
    assert sum(step.assumptions for step in result.plan if step.method == "numeric") == 3


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
    assert any(step.method == "numeric" for step in result.plan)
    changes = {"B": 16.6, "D": 19.4, "h": 2.2, "w": 2.5, "r": 1.9, "t": 11.2}
    for name, value in changes.items():
        sketch.set(name, value)
    changed = sketch.solve()
    assert changed.status == "well" and changed.residual <= 1e-12 * 19.0
    assert sketch.entity("deck_edge").position == pytest.approx([16.6, 19.4])
    assert sketch.entity("deck_edge_p").position == pytest.approx([-16.6, 19.4])
    assert sketch.entity("bilge_p").radius == pytest.approx(1.9)
