"""A rule that applies to no measured pair is warned of: its limits are never checked."""

import pytest

import clearance as cl
from tests.formats.making_case import CASE, load_small

OWN = "{name: own, between: [upper, post], fail: 0.2}"
ALL = '{name: all, between: ["*", "*"], fail: 0.001}'


@pytest.mark.parametrize(
    "rules, idle",
    [
        (f"rules: [{OWN}, {ALL}]}}", ["own"]),
        (f"rules: [{ALL}, {OWN}]}}", []),
        (f"rules: [{OWN}]}}\nallow: [[upper, post]]", ["own"]),
    ],
)
def test_a_rule_without_pairs_is_warned_of(tmp_path, rules, idle):
    case = CASE.replace("limits: {fail: 0.005, warn: 0.02}", f"limits: {{fail: 0.005, {rules}")
    record = cl.check(load_small(tmp_path, case), certify=False).record
    told = [one.text for one in record.notices if one.kind == "rules"]
    assert [text.split("'")[1] for text in told] == idle
