"""The table of what a clearance changes by: what it says, and what it says where there is none."""

import clearance as cl
from clearance.report.topics.worst import sensitivity_blocks, sensitivity_data
from tests.gains.gantries import along_x, gantry, slot, standing


def table_of(case):
    data = sensitivity_data(cl.check(case).session.sensitivity)
    return data, repr(sensitivity_blocks(data, several_robots=False))


def test_one_number_says_both_ways():
    data, text = table_of(slot(fail=0.04, off=0.03))
    (rate,) = (one for one in data["rates"] if one["kind"] == "joint" and one["name"] == "y")
    assert rate["both_ways"] and "one way" not in text
    assert "+1.000" in text and "-1.000" in text and "obstacle left, y" in text


def test_what_holds_one_way_only_says_so():
    data, text = table_of(slot(fail=0.04, off=0.0))
    assert len(data["pairs"]) == 2
    assert "each holds one way only" in text and "As near are" in text


def test_of_bodies_in_contact_it_is_not_worked_out():
    post = standing("post", cl.box((0.1,) * 3), (0, 0, 0))
    data, text = table_of(cl.Case("hit", (along_x(gantry()),), (post,)))
    assert data["rates"] == [] and "not worked out: the bodies are in contact" in text
