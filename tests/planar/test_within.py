"""Hausdorff distances within a limit, by the paper and without trimming: proven, or said not to be."""

import numpy as np
import pytest
from click.testing import CliRunner

from clearance.cli.commands import clearance as command
from clearance.errors import ClearanceError
from clearance.planar import hausdorff as searched
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff, Undecided, greater_of, hausdorff, within
from clearance.planar.systems import directed, directions, empty_state, solved, whole
from tests.examples import some_slow
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
    assert isinstance(caught.value, ClearanceError)
    assert caught.value.lower <= 3e-11 <= caught.value.upper


@pytest.mark.slow
def test_compare_fails_where_the_limit_is_not_decided_and_draws_the_same_bytes(tmp_path):
    """A limit that is the distance itself, to the last bit: neither within nor beyond is proven."""
    pytest.importorskip("matplotlib")
    one, two = tmp_path / "a.yaml", tmp_path / "b.yaml"
    one.write_text("curves:\n  - line: {start: [0, 0], end: [4, 0]}\n")
    two.write_text("curves:\n  - polyline: {points: [[0, 1], [2, 3], [4, 1]]}\n")
    for limit, code, said, name in [
        ("2", 1, "beyond", "x.svg"), ("4", 0, "within", "y.svg"), ("3", 1, "undecided", "z.png")
    ]:  # fmt: skip
        asked = ["profile", "compare", str(one), str(two), "--out", str(tmp_path / name)]
        out = CliRunner().invoke(command, [*asked, "--limit", limit])
        assert out.exit_code == code and out.output.startswith(f"{said} {limit} (")
        assert "the outlines differ by 3 " in out.output
    assert "which counts as beyond" in out.output
    drawn, again, picture = ((tmp_path / name).read_bytes() for name in ("x.svg", "y.svg", "z.png"))
    assert drawn == again and b"<svg" in drawn and picture.startswith(b"\x89PNG")


def waves(n, seed):
    """Two cubic B-splines of `n` control points that wave side by side, as in the paper's experiment."""
    random = np.random.default_rng(seed)
    c = np.stack([np.arange(n) * 1.0, np.cumsum(random.normal(size=n))], axis=1)
    return Curve.bspline(c), Curve.bspline(c + [0.0, 0.3] + 0.8 * random.normal(size=(n, 2)))


PAIRS = [(n, seed) for n in (5, 10, 15, 30) for seed in range(4)]


@pytest.mark.parametrize(("n", "seed"), PAIRS)
def test_the_papers_answer_is_never_below_and_its_bounds_hold(n, seed):
    a, b = waves(n, seed)
    true, published = hausdorff(a, b), hausdorff(a, b, method="paper")
    assert published.distance >= true.distance - true.error_bound - 1e-13 * a.size
    assert published.lower <= true.upper and true.lower <= published.upper
    assert abs(published.distance - true.distance) <= published.error_bound + true.error_bound
    assert np.hypot(*(published.point_a - published.point_b)) == pytest.approx(published.distance)


def test_the_greatest_of_all_roots_is_not_the_distance():
    """A bump beside one leg of an arch: its tip has a common normal with the other leg, three times as long."""
    arch = Curve.polyline([[-1, 0], [-1, 4], [1, 4], [1, 0]])
    bump = Curve.bezier([[-0.9, 1], [-0.4, 1.2], [-0.4, 1.8], [-0.9, 2]])
    true = hausdorff(bump, arch).directed["a_to_b"]
    published = hausdorff(bump, arch, method="paper").directed["a_to_b"]
    tip = bump.point(0.5)[0]
    assert true.distance == pytest.approx(tip + 1.0) and published.distance >= 1.0 - tip - 1e-12
    assert published.lower <= true.distance <= published.upper < 0.5


HARD = {
    "the same curve": (Curve.bspline([[0, 0], [1, 2], [3, 1], [4, 4]]),) * 2,
    "one straight and doubled back": (
        Curve.bezier([[0, 0], [2, 0], [-1, 0], [1, 0]]),
        Curve.bezier([[0, 1], [0.3, 0.2], [0.6, 0.3], [1, 1]]),
    ),
    "concentric circles": (Curve.circle([0, 0], 1), Curve.circle([0, 0], 1.25)),
}


def untrimmed(a: Curve, b: Curve) -> Hausdorff:
    """The Hausdorff distance from the systems solved on whole curves: it shares no bound with trimming."""
    both = [
        directed(way, solved(way, whole(way.one), whole(way.two), empty_state()))
        for way in directions(a, b)
    ]
    return greater_of(*both)


@pytest.mark.parametrize("name", some_slow(HARD, {"the same curve", "concentric circles"}))
def test_systems_without_end_stop_with_a_true_bound(name):
    """Infinitely many roots, or too many to tell apart: the budget ends it, and the bound says what is left."""
    a, b = HARD[name]
    one, two = hausdorff(a, b), untrimmed(a, b)
    assert two.lower <= one.upper and one.lower <= two.upper
    assert two.error_bound <= 0.05 * a.size and two.tally.given_up > 0
    assert two.tally.systems <= 40_000 and two.tally.intervals <= 900_000
