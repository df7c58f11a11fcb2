"""The search for the least change: linear programmes, each step measured anew, proven at the end.

A step is taken where the linear rows have a least solution within the trust region, else to where they are missed
by least. What is measured decides: a step that makes it worse shrinks the region. Not for: what may be changed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.gains.interval_moments import refined
from clearance.gains.path_change import PathChange
from clearance.gains.programme import least_missing
from clearance.gains.shift import Shift
from clearance.gains.shortfalls import (
    Requirement,
    Rows,
    State,
    keeps,
    measured,
    proven,
    raised,
    with_moments_within,
)
from clearance.record.record import Record

MOST_STEPS = 40
"""Of one search; most need 4 to 10."""

PATIENCE, LESS = 6, 0.9
"""A search ends where so many steps have left more than this share of what was missing."""

BLIND = 8
"""Steps from contact to contact that are taken whatever comes of them: depths jump where their vectors do."""

BENDS = 8
"""Most times that a step is aimed again, with the rows that need no measuring as they are where it leads."""

MOST_PROOFS = 12
"""Times that the motion between the steps may ask for more."""

ALMOST, MENDING = 1e-4, 4
"""[m] Where a search ends with less missing, so many steps go on to keep all: its price was too low."""

NEARBY = 0.005
"""[-] Of the first reach, how far these steps go: no more curvature is met then than may be missed."""

AGAIN = 0.2
"""[-] Of the first reach, how far a step may go at first where little more is wanted than is kept."""

FINE = 2e-7
"""[m] A pair that is less below what is wanted is at it: as much more is wanted, and proofs are as fine."""

PATH_GAP = 1e-5
"""[m] How far below what occurs a second proof of a bent path may be, which says how much more is wanted."""

SAME_PLACE = 0.01
"""[-] Of the size of a change: where an earlier search was so near, another would go the same way."""

SMALLER = 1e-5
"""[-] A change that is smaller by less than this share is no better."""

SURELY = 1.0 - 1e-9
"""[-] A size is below another if it is by more than rounding."""

NEARLY, HALVINGS = 0.99, 8
"""[-] If so much of a change is enough, it is shortened by so many halvings."""

LEAST_SHARE, GOOD_SHARE = 0.05, 0.5
"""[-] Of what is foretold: with less a step is not taken, with more the next goes farther."""

WIDER, NARROWER = 2.0, 0.4
"""[-] What the trust region is multiplied by then."""


Change = Shift | PathChange
"""What may be changed, by m variables that are 0 for no change."""


@dataclass(frozen=True, eq=False)
class SearchResult:
    """Where a search ended.

    Attributes:
        state: the least change that keeps what is wanted, else the one that misses it by least.
        record: the proof; None where the steps do not keep it.
        n_measured: how many cases were measured.
    """

    state: State
    record: Record | None
    n_measured: int

    @property
    def kept(self) -> bool:
        """True if every rule is proven to hold."""
        return self.record is not None and keeps(self.record)


class Search:
    """One search for a change.

    Args:
        margin: [m] above the fail limits.
    """

    def __init__(self, change: Change, margin: float) -> None:
        self.change, self.margin, self.price = change, margin, change.price
        self.wanted = Requirement(margin, 2.0 * FINE, np.zeros(0))
        self.n_measured = 0
        self.known: list[np.ndarray] = []
        self.places: list[np.ndarray] = []
        self.below = np.inf
        self.least: State | None = None

    def first_state(self, known: State | None = None) -> State:
        """The case as it is, measured, with what comes near though no change moves it.

        Args:
            known: it as it was measured for other variables of the same bodies; None to measure it.
        """
        x = np.zeros(len(self.change.first_reach))
        if known is None:
            return replace(self.state_at(x), moved=None, bounded=True)
        return known.about(x, self.change.other_rows(x, self.wanted.beyond))

    def state_at(self, x: np.ndarray) -> State:
        """The case of some variables (m,), measured."""
        return self._state(x, self.change.first_reach)

    def from_state(self, state: State, below: float = np.inf) -> SearchResult:
        """The search from a case that is measured; what is not smaller than `below` is not proven."""
        record = None
        self.known, self.places, self.below = self.known + self.places, [state.x], below * SURELY
        for i in range(MOST_PROOFS):
            state = self._improved(state, AGAIN if i else 1.0)
            if self._is_known(state):
                break
            if state.worst > FINE or self.change.size(state.x) >= self.below:
                break
            record = proven(state.case, self.margin)
            if keeps(record):
                break
            state, record = self._wanting_more(state, record), None
        return SearchResult(state, record, self.n_measured)

    def shortened(self, found: SearchResult) -> SearchResult:
        """The least share of a change that is proven to be enough: a long interval may have asked for too much."""
        least, low, share, high = found, 0.0, NEARLY, 1.0
        for _ in range(HALVINGS if found.kept and found.state.x.any() else 0):
            state = self.state_at(share * found.state.x)
            record = proven(state.case, self.margin)
            others = state.other_rows
            if keeps(record) and (others is None or others.missing.max(initial=0.0) <= FINE):
                least, high = SearchResult(state, record, self.n_measured), share
            elif share == NEARLY:
                break
            else:
                low = share
            share = 0.5 * (low + high)
        return least

    def _wanting_more(self, state: State, unproven: Record) -> State:
        """The same variables, measured by what is wanted so that the motion between the steps is proven too."""
        if self.change.bends:
            finer = proven(state.case, self.margin, PATH_GAP)
            # The finer one may hold where that of a plain check does not.
            unproven = unproven if keeps(finer) else finer
            self.wanted = refined(self.wanted, unproven, state)
            return self._state(state.x, self.change.first_reach)
        self.wanted = raised(self.wanted, unproven)
        state = self._state(state.x, self.change.first_reach)
        if state.worst <= FINE:
            self.wanted = with_moments_within(self.wanted, unproven)
            state = self._state(state.x, self.change.first_reach)
        return state

    def _state(self, x: np.ndarray, reach: np.ndarray) -> State:
        self.n_measured += 1
        beyond = self.change.swing(reach) + FINE
        found = measured(self.change.case_of(x), x, self.wanted, beyond, self.change.moves)
        return replace(found, other_rows=self.change.other_rows(x, self.wanted.beyond))

    def _improved(self, state: State, share: float = 1.0) -> State:
        """The best state that steps from one lead to: one on the way that keeps all, where the last does not.

        Args:
            share: [-] of the first reach, how far the first step may go.
        """
        self.least = None
        self._note(state)
        end = self._end_of_steps(state, share)
        if FINE < end.worst < ALMOST:
            end = self._mended(end, NEARBY * self.change.first_reach)
        return end if end.worst <= FINE or self.least is None else self.least

    def _mended(self, state: State, reach: np.ndarray) -> State:
        """The state that steps from one that misses little lead to, whatever they cost."""
        for _ in range(MENDING):
            x, _ = self._aim_with_bends(state, state.rows(self.change.gradient), reach)
            tried = self._state(x, reach)
            if tried.worst > 0.5 * state.worst:
                return state
            state = tried.seen_within(self.change.swing(reach) + FINE)
            if state.worst <= FINE:
                break
        return state

    def _end_of_steps(self, state: State, share: float) -> State:
        """The state that steps from one end at."""
        if not len(state.x):
            return state
        reach, missing, blind = share * self.change.first_reach, [state.worst], BLIND
        rows = state.rows(self.change.gradient)
        for _ in range(MOST_STEPS):
            late = missing[-PATIENCE:]
            if len(missing) > PATIENCE and min(late) > FINE and late[-1] > LESS * late[0]:
                return state
            x, bent = self._aim_with_bends(state, rows, reach)
            foretold = _foretold(bent, x - state.x)
            gain = self._merit(state.x, state.worst) - self._merit(x, foretold)
            if gain <= 0.0 and state.worst - foretold > FINE:
                self._raise_price(state, x, foretold)
                gain = self._merit(state.x, state.worst) - self._merit(x, foretold)
            if gain <= SMALLER * self.change.size(state.x):
                return state
            tried = self._state(x, reach)
            done = self._merit(state.x, state.worst) - self._merit(x, tried.worst)
            in_contact = tried.touches and state.touches
            blind -= in_contact
            if done < LEAST_SHARE * gain and not (in_contact and blind >= 0):
                reach = NARROWER * np.minimum(reach, np.abs(x - state.x).max())
                if (reach < 1e-6 * self.change.first_reach).all():
                    return state
                continue
            if done > GOOD_SHARE * gain:
                reach = self._next_reach(reach, x - state.x)
            state = tried.seen_within(self.change.swing(reach) + FINE)
            self._note(state)
            if self._is_known(state):
                return state
            self.places.append(state.x)
            rows = state.rows(self.change.gradient)
            missing.append(state.worst)
        return state

    def _note(self, state: State) -> None:
        """Keeps the smallest change that keeps all."""
        if state.worst <= FINE and (
            self.least is None or self.change.size(state.x) < self.change.size(self.least.x)
        ):
            self.least = state

    def _next_reach(self, reach: np.ndarray, step: np.ndarray) -> np.ndarray:
        """(m,) how far the next step may go after one that did what was foretold.

        Farther after one that went as far as it could, else no farther than leads well past where it ended.
        """
        first = self.change.first_reach
        if (np.abs(step) >= (1.0 - SMALLER) * reach).any():
            return np.minimum(WIDER * reach, 8.0 * first)
        far = WIDER * float((np.abs(step) / first).max())
        return np.minimum(reach, max(far, 1.0) * first)

    def _is_known(self, state: State) -> bool:
        """True if an earlier search has passed here: this one would end where that did.

        What is kept and smaller than all before goes on all the same.
        """
        size = self.change.size(state.x)
        if state.worst <= FINE and size < self.below:
            return False
        near = SAME_PLACE * size
        return any(self.change.size(state.x - place) <= near for place in self.known)

    def _aim(self, state: State, rows: Rows, reach: np.ndarray) -> np.ndarray:
        """Where the next step goes: the least change that keeps all rows, or misses them by least.

        Whether a path can keep them is asked first: HiGHS may take minutes to find that no least change is there.
        """
        box, x = self.change.box.about(state.x, reach), None
        if not self.change.bends or (rows.missing <= 0.0).all():
            x = self.change.least(rows, state.x, box)
        if x is None:
            nearest, missing = least_missing(rows, state.x, box, self.change.inequalities)
            more = missing * (1.0 + 1e-6) + FINE if missing > 0.01 * FINE else 0.0
            relaxed = rows._replace(missing=rows.missing - more)
            x = self.change.least(relaxed, state.x, box)
            x = nearest if x is None else x
        return np.clip(x, box.low, box.high)

    def _aim_with_bends(
        self, state: State, rows: Rows, reach: np.ndarray
    ) -> tuple[np.ndarray, Rows]:
        """Where the next step goes, and the rows that say so.

        Rows that need no measuring bend with the joints: they are taken again where the step leads, until it keeps
        them (cutting planes).
        """
        x = self._aim(state, rows, reach)
        if state.other_rows is None:
            return x, rows
        measured = Rows(*(one[: len(one) - len(state.other_rows.missing)] for one in rows))
        cuts: list[Rows] = []
        for _ in range(BENDS):
            there = self.change.other_rows(x, self.wanted.beyond)
            if there is None or there.missing.max(initial=0.0) <= FINE:
                break
            missing = there.missing + there.gradients @ (x - state.x)
            cuts.append(there._replace(missing=missing))
            rows = Rows(*map(np.concatenate, zip(measured, *cuts, strict=True)))
            x = self._aim(state, rows, reach)
        return x, rows

    def _merit(self, x: np.ndarray, missing: float) -> float:
        """What a step is to lower: the size of the change, and what is missing at its price."""
        return self.change.size(x) + self.price * max(0.0, missing - FINE)

    def _raise_price(self, state: State, x: np.ndarray, foretold: float) -> None:
        """Makes what a step is to mend worth twice what it costs: some clearances hardly grow with any change."""
        costs = self.change.size(x) - self.change.size(state.x)
        self.price = max(self.price, 2.0 * costs / (state.worst - max(foretold, FINE)))


def _foretold(rows: Rows, step: np.ndarray) -> float:
    """[m] What is missing after a step (m,), as the rows foretell it."""
    return max(0.0, float((rows.missing - rows.gradients @ step).max(initial=0.0)))
