"""Effects of a change that no rule sees: each stands as a warning beside the proof."""

import re

import pytest

import clearance as cl
from clearance.gains.figures import figures_of

ROBOT = """<robot name="gan">
<link name="base"><collision>
  <origin xyz="0 0 0.25"/><geometry><box size="0.3 0.3 0.5"/></geometry></collision></link>
<link name="a1"><collision>
  <origin xyz="0.3 0 0.05"/><geometry><box size="0.7 0.1 0.1"/></geometry></collision></link>
<link name="a2"><collision>
  <origin xyz="0.2 0 0"/><geometry><box size="0.4 0.08 0.08"/></geometry></collision></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="a1"/><origin xyz="0 0 0.52"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="2"/></joint>
<joint name="j2" type="revolute"><parent link="a1"/><child link="a2"/><origin xyz="0.7 0 0.05"/>
  <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" effort="1" velocity="2"/></joint>
</robot>
"""

HEAD = "robot: {urdf: r.urdf}\ntrajectory: t.csv\nscene:\n  obstacles:\n"
BEAM = "  - {name: beam, box: {size: [0.1, 3, 0.1]}, pose: {xyz: [0.8, 0, 0.74]}}\n"
PART = "  - {name: part, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [1.1, 0, 0.38]}}\n"

ON_FLOOR = (
    HEAD
    + BEAM
    + "  - {name: floor, box: {size: [3, 3, 0.02]}, pose: {xyz: [0, 0, -0.01]}}\n"
    + "  - {name: lamp, box: {size: [0.1, 0.1, 0.1]}, pose: {xyz: [0.8, 0, 0.85]}}\n"
    + "allow: [[base, floor]]\nlimits: {fail: 0.1}\n"
)
CARRIES = (
    HEAD
    + PART
    + BEAM
    + "carry: [{part: part, by: a2, from: 1, until: 2, touch: [a2]}]\n"
    + "allow: [{between: [a2, part], from: 2}]\n"
    + "limits: {fail: 0.06, rules: [{between: [a1, beam], fail: 0.11}, "
    + "{between: [a2, beam], from: 0.8, until: 1.3, fail: 0.1}]}\n"
)
ON_TABLE = (
    HEAD
    + PART
    + "  - {name: table, box: {size: [0.4, 0.4, 0.02]}, pose: {xyz: [1.1, 0, 0.32]}}\n"
    + "carry: [{part: part, by: a2, from: 1, until: 2, touch: [a2, table]}]\n"
    + "allow: [[table, part], [a2, part]]\n"
    + "limits: {fail: 0.05, rules: [{between: [a2, table], fail: 0.21}]}\n"
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "kind", "options", "said"),
    [
        (ON_FLOOR, "base", {}, [r"'base' and 'floor', an allowed pair, are 1\d\.\d+ mm deep .*\(0 mm"]),
        (
            CARRIES,
            "base",
            {},
            [
                r"part 'part' is \S+ mm off its old place on a2 at the pick-up \(1 s\)",
                r"part 'part' is put down \S+ mm off its old place \(2 s\)",
            ],
        ),
        (
            ON_TABLE,
            "obstacle",
            {"obstacle": "table"},
            [r"'table' and 'part' touch before the change and are \S+ mm apart after it"],
        ),
    ],
)  # fmt: skip
def test_an_effect_that_no_rule_sees_is_a_warning(text, kind, options, said, tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "t.csv").write_text("time,j1,j2\n0,-1,0\n1,0,0.1\n2,1,0\n3,0.5,0.2\n")
    (tmp_path / "case.yaml").write_text(text)
    found = cl.gain(tmp_path / "case.yaml", kind, **options)
    assert found.kept and found.size > 0.0
    assert len(found.unjudged) == len(said)
    for pattern, line in zip(said, found.unjudged, strict=True):
        assert re.search(pattern, line), line
    assert {*found.unjudged} <= {*figures_of(found)["warnings"]}
