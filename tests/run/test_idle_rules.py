"""A rule that applies to no measured pair is warned of: its limits are never checked."""

import pytest

import clearance as cl
from tests.formats.making_case import CASE, load_small

OWN = "{name: own, between: [upper, post], fail: 0.2}"
ALL = '{name: all, between: ["*", "*"], fail: 0.001}'


@pytest.mark.parametrize(
    "rules, idle, why",
    [
        (f"rules: [{OWN}, {ALL}]}}", ["own"], "pair: its pairs are judged by later rules"),
        (f"rules: [{ALL}, {OWN}]}}", [], ""),
        (
            f"rules: [{OWN}]}}\nallow: [[upper, post]]",
            ["own"],
            "pair: upper - post is not measured (allowed by ['upper', 'post'])",
        ),
    ],
)
def test_a_rule_without_pairs_is_warned_of(tmp_path, rules, idle, why):
    case = CASE.replace("limits: {fail: 0.005, warn: 0.02}", f"limits: {{fail: 0.005, {rules}")
    record = cl.check(load_small(tmp_path, case), certify=False).record
    told = [one.text for one in record.notices if one.kind == "rules"]
    assert [text.split("'")[1] for text in told] == idle
    assert all(why in text for text in told)


def test_a_rule_of_neighbours_alone_says_that_they_are_excused(tmp_path):
    case = CASE.replace("urdf: arm.urdf", "urdf: arm.urdf, self_clearance: true")
    rule = "rules: [{between: [base, upper], fail: 0.2}]}"
    case = case.replace("limits: {fail: 0.005, warn: 0.02}", f"limits: {{fail: 0.005, {rule}")
    record = cl.check(load_small(tmp_path, case), certify=False).record
    (text,) = [one.text for one in record.notices if one.kind == "rules"]
    assert text.endswith("pair: upper - base is not measured (excused: Adjacent)")
