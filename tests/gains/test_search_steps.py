"""Which steps a search takes, which pairs it looks at, and which limits of joints a programme is given."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.sparse import csr_array

import clearance as cl
from clearance.gains import shortfalls
from clearance.gains.programme import Box, Inequalities, least_norm, within_reach
from clearance.gains.search import FINE, Search
from clearance.gains.shift import base_shift
from clearance.gains.shortfalls import Rows
from clearance.simulate.measure import inside
from tests.gains.gantries import along_x, gantry, slot, standing


@dataclass(frozen=True)
class Step:
    """A state of a made-up case of one variable: in contact, 0.3 m deep, below 1."""

    x: np.ndarray

    @property
    def touches(self):
        return bool(self.x[0] < 1.0)

    @property
    def worst(self):
        return 0.3 if self.touches else 0.0

    def rows(self, gradient):
        """Rows by which half of it would be enough, too."""
        return Rows(np.array([0.5 - self.x[0]]), np.ones((1, 1)))

    def seen_within(self, beyond):
        return self


class OneVariable:
    """A change of one variable, as large as it is."""

    price, bends, kept = 30.0, False, None
    box = Box(np.full(1, -np.inf), np.full(1, np.inf))
    first_reach = np.ones(1)

    def size(self, x):
        return float(np.abs(x).max())

    def swing(self, reach):
        return float(reach[0])

    def least(self, rows, x, box):
        return least_norm(rows, x, box)

    def gradient(self, approach, timeline=None):
        raise AssertionError


def test_no_step_is_taken_from_a_change_that_keeps_its_limits_into_contact(monkeypatch):
    monkeypatch.setattr(Search, "_state", lambda _, x, reach: Step(x))
    found = Search(OneVariable(), 0.0)._improved(Step(np.array([1.5])))
    assert found.worst == 0.0 and 1.0 <= found.x[0] <= 1.2


def test_a_search_that_ends_where_a_little_is_missing_gives_back_what_kept_all_on_the_way(
    monkeypatch,
):
    """The price is too low: a step to half the size leaves 10 um, and no step mends them."""

    @dataclass(frozen=True)
    class Short(Step):
        touches = False

        @property
        def worst(self):
            return 1e-5 if self.x[0] < 1.0 else 0.0

    monkeypatch.setattr(Search, "_state", lambda _, x, reach: Short(x))
    found = Search(OneVariable(), 0.0)._improved(Short(np.array([1.5])))
    assert found.worst == 0.0 and 1.0 <= found.x[0] <= 1.5


def test_more_is_wanted_of_a_motion_that_is_hardly_not_proven_than_counts_as_kept(monkeypatch):
    """Else as much as is missing might be asked for again and again, and no step be worth it."""
    record = cl.check(slot(fail=0.04, off=0.0)).record
    n_steps = len(record.motions[0].times)
    short = np.zeros(n_steps)
    short[3] = 1e-9
    monkeypatch.setattr(shortfalls, "short_of", lambda _: short.copy())
    wanted = shortfalls.raised(shortfalls.Requirement(0.0, 0.0, np.zeros(0)), record)
    assert np.flatnonzero(wanted.extra).tolist() == [3, 4] and wanted.extra.max() > FINE


def test_only_pairs_that_a_change_may_move_are_looked_at_once_the_case_as_it_is_was_looked_at_whole():
    moving, still = along_x(gantry()), along_x(gantry("other"), base=(0.0, 0.25, 0.0))
    post = standing("post", cl.box((0.1, 0.1, 1.0)), (0.0, -0.13, 0.0))
    case = cl.Case("two", (moving, still), (post,), cl.Limits(fail=0.04))
    search = Search(base_shift(case, "other"), 0.0)
    wide = [
        replace(one, beyond=1.0) for one in (search.first_state(), search.state_at(np.zeros(3)))
    ]
    pairs = [{tuple(b.name_in(one.case) for b in one.pair) for one in state.near} for state in wide]
    assert len(pairs[0]) > len(pairs[1]) and pairs[1] < pairs[0]
    assert all(any(name.startswith("other") for name in pair) for pair in pairs[1])


def test_a_search_ends_where_an_earlier_one_has_been():
    search = Search(base_shift(slot(fail=0.04, off=0.03), "gantry"), 0.0)
    found = search.from_state(search.state_at(np.array([0.0, -0.05, 0.0])))
    assert found.kept
    n_measured = search.n_measured
    again = search.from_state(
        search.state_at(np.array([0.0, -0.04, 0.0])), search.change.size(found.state.x)
    )
    assert not again.kept and search.n_measured <= n_measured + 3
    assert again.state.x == pytest.approx(found.state.x, abs=FINE)


def test_limits_that_no_point_of_a_box_may_break_are_left_out():
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(40, 3)), rng.uniform(-0.5, 3.0, size=40)
    low, high = -rng.uniform(0.1, 1.0, size=3), rng.uniform(0.1, 1.0, size=3)
    found = within_reach(Inequalities(csr_array(a), b), low, high)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, 3)
    broken = (corners @ a.T > b).any(axis=0)
    assert 0 < broken.sum() < 40
    assert np.array_equal(found.a.toarray(), a[broken]) and np.array_equal(found.b, b[broken])


def test_what_is_proposed_tells_whether_an_open_body_may_hold_another_though_no_search_asks(
    monkeypatch,
):
    asked = []
    told = inside.notices
    monkeypatch.setattr(inside, "notices", lambda plan: asked.append(plan) or told(plan))
    found = cl.gain(slot(fail=0.04, off=0.03), "base")
    assert found.kept and found.n_measured > 1 and len(asked) == 2
