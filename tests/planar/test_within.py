"""`within` decides by proven bounds, or says that it cannot; and it goes no further than its limit."""

import numpy as np
import pytest
from click.testing import CliRunner

from clearance.cli.commands import clearance as command
from clearance.errors import ClearanceError
from clearance.planar import hausdorff as searched
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Undecided, hausdorff, within
from tests.planar.unlike import CUBIC, reparametrised

NEAR = [
    (Curve.bezier(CUBIC), Curve.bezier(reparametrised(CUBIC, [0, 0.3, 1]) + [0.0, 2.12e-11])),
    (Curve.bezier(CUBIC), Curve.bezier(reparametrised(CUBIC, [0, 0.2, 1]))),
    (Curve.polyline(CUBIC), Curve.polyline(CUBIC + [0.0, 1e-3])),
    (Curve.circle([0, 0], 1.0), Curve.arc([0, 1e-7], 1.0, 0.3, 0.3 + 2.0 * np.pi)),
]


@pytest.mark.parametrize("budget", [0.0, 3.0, 40.0, 200_000.0])
@pytest.mark.parametrize("pair", NEAR)
def test_no_budget_makes_a_wrong_answer(monkeypatch, pair, budget):
    """Whatever the search may spend: True and False are right, all else is `Undecided`."""
    a, b = pair
    found, slack = hausdorff(a, b), 1e-13 * max(c.size for c in pair)
    monkeypatch.setattr(searched, "BUDGET", budget)
    monkeypatch.setattr(searched, "INTERVALS_A_PIECE", 0.0)
    for share in (0.0, 0.5, 0.727, 0.999, 1.001, 2.0, 1e3, 1e6):
        limit = share * found.distance
        try:
            answer = within(a, b, limit)
        except Undecided as undecided:
            assert undecided.lower <= found.upper and undecided.upper >= found.lower
            assert undecided.lower - slack <= limit <= undecided.upper + slack
        else:
            assert answer or found.upper > limit
            assert not answer or found.lower <= limit + slack


def test_undecided_is_an_error_of_ours_in_one_line(monkeypatch):
    monkeypatch.setattr(searched, "BUDGET", 0.0)
    monkeypatch.setattr(searched, "INTERVALS_A_PIECE", 0.0)
    a, b = NEAR[0]
    with pytest.raises(Undecided, match=r"a distance between .* against the limit 3e-11") as caught:
        within(a, b, 3e-11)
    assert isinstance(caught.value, ClearanceError) and "\n" not in str(caught.value)
    assert caught.value.lower <= 3e-11 <= caught.value.upper


def test_compare_fails_where_the_limit_is_not_decided(tmp_path):
    """A limit that is the distance itself, to the last bit: neither within nor beyond is proven."""
    one, two = tmp_path / "a.yaml", tmp_path / "b.yaml"
    one.write_text("curves:\n  - line: {start: [0, 0], end: [4, 0]}\n")
    two.write_text("curves:\n  - polyline: {points: [[0, 1], [2, 3], [4, 1]]}\n")
    for limit, code, said in [("2", 1, "beyond"), ("4", 0, "within"), ("3", 1, "undecided")]:
        out = CliRunner().invoke(
            command, ["profile", "compare", str(one), str(two), "--limit", limit]
        )
        assert out.exit_code == code and f"limit {limit}: {said}" in out.output
    assert "which counts as beyond" in out.output
