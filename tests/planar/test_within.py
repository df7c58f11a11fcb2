"""`within` decides by proven bounds, or says that it cannot; and it goes no further than its limit."""

import numpy as np
import pytest
from click.testing import CliRunner

from clearance.cli.commands import clearance as command
from clearance.errors import ClearanceError
from clearance.kernels.hausdorff.state import SearchGoal
from clearance.planar import hausdorff as searched
from clearance.planar.curve import Curve
from clearance.planar.directed import placed
from clearance.planar.hausdorff import Undecided, hausdorff, within
from clearance.profiles.compare import compare
from clearance.profiles.outline_file import DrawnOutline
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


def test_within_does_not_refine_beyond_the_limit():
    """The same cubic as degree 6: a limit of 1e-3 is settled in a hundredth of what the distance takes."""
    a, b = NEAR[1]
    shift, size = placed(a, b)
    aims = [SearchGoal(2.0**-50 * size, 0.0, np.inf, enough, np.inf, 1e5) for enough in (1e-3, 0.0)]
    few, many = (int(searched._solve(a, b, shift, aim)[0]["n_cuts"].sum()) for aim in aims)
    assert few <= 24 and few * 8 < many
    assert within(a, b, 1e-3) and within(a, b, 1e-9)


@pytest.mark.slow
def test_compare_calls_what_is_undecided_by_its_name(monkeypatch, tmp_path):
    a, b = NEAR[0]
    for budget, limit, verdict in [
        (200_000.0, 1e-10, "within"), (200_000.0, 1e-11, "beyond"), (0.0, 1e-9, "undecided"),
    ]:  # fmt: skip
        monkeypatch.setattr(searched, "BUDGET", budget)
        monkeypatch.setattr(searched, "INTERVALS_A_PIECE", 0.0)
        found = compare(DrawnOutline("a", a), DrawnOutline("b", b), limit=limit)
        assert found.verdict == verdict and found.within_limit == (verdict == "within")
    assert found.found.lower <= 1e-9 < found.found.upper


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
