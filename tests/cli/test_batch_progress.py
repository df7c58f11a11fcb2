"""How far a batch is, on a pipe: a line now and then, which names the worst, of contacts the deepest."""

from clearance.batch.item import Item
from clearance.batch.measuring import Fault, ItemResult
from clearance.batch.run import BatchWatch

ITEMS = [Item(i, name, f"{name}.yaml", None, None) for i, name in enumerate("abcd")]


def result(number, status, exit_code, clearance, penetration=None):
    told = {"status": status, "measured": status, "exit_code": exit_code, "clearance": clearance}
    return ItemResult(number, "key", "[]", told | {"penetration": penetration, "reasons": []})


def test_a_line_says_how_far_it_is_and_names_the_deepest_contact():
    watch = BatchWatch()
    watch.begin(ITEMS)
    assert watch.line == "0 of 4 cases measured"
    watch.note([result(0, "clear", 0, 0.4)], [])
    assert watch.line.endswith("0 failed, worst clear 400.0 mm, a")
    watch.note([result(1, "contact", 1, 0.0, 0.01), result(2, "contact", 1, 0.0, 0.03)], [])
    watch.note([], [Fault(3, "unreadable")])
    assert watch.line.startswith("4 of 4 cases measured, ")
    assert watch.line.endswith(" 0 s left, 3 failed, worst contact 30.00 mm deep, c")
