"""Searches for evidence stretch by stretch, and foresees how much it will be before all of it is found.

Not for: what is done with an item (`fronts`); deciding (`receipt.proof`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadInput
from clearance.progress import Progress
from clearance.receipt.fronts import EvidenceList, Front, LowerableClaims
from clearance.receipt.proof.halving import Halves
from clearance.receipt.proof.motion_data import Shape, Stretch
from clearance.receipt.proof.stage import Stage

MOST_ITEMS = 8_000_000
"""Of a receipt: about 10 MB."""

WIDE = 2**14
"""Items from which on it is foreseen how many they lead to."""

FOLLOWED = 256
"""Items of that many which are followed to their end."""

TOO_MANY = 1.5
"""Times as many as may be are not looked for: what is foreseen is not exact."""


class TooManyProofs(BadInput):
    """More than a receipt may have."""


class EvidenceSearch:
    """The search for what proves all that is claimed, first as far as it takes to foresee how long it will be.

    Args:
        lowest: as `claims`, which are then lowered, no further than this, where evidence would be without end.
    """

    def __init__(
        self,
        stretches: Sequence[Stretch],
        shapes: Sequence[Shape],
        halves: Halves,
        claims: np.ndarray,
        lowest: np.ndarray | None = None,
    ) -> None:
        self._shapes, self._halves = shapes, halves
        self._claims = LowerableClaims(claims, lowest)
        self._fronts = [Front(Stage(one, shapes, halves, claims)) for one in stretches]
        self.n_foreseen = 0

    @property
    def n_found(self) -> int:
        """How many proofs are found so far."""
        return sum(front.found.n_items for front in self._fronts)

    def foresee(self, most_items: int) -> int:
        """About how many proofs there will be: where many are to be expected, some are followed to their end.

        Raises:
            TooManyProofs: far more than so many. BadInput: it cannot be proven so.
        """
        total, most = 0.0, TOO_MANY * most_items
        for front in self._fronts:
            while front.n_open and front.n_open < WIDE:
                front.advance(self._claims)
            total += front.found.n_items + self._ahead_of(front, most - total)
            if total > most:
                raise too_many(total, most_items)
        self.n_foreseen = round(total)
        return self.n_foreseen

    def _ahead_of(self, front: Front, most: float) -> float:
        """About how many proofs a front leads to, or more than `most`."""
        if not front.n_open:
            return 0.0
        rows = np.linspace(0, front.n_open - 1, min(FOLLOWED, front.n_open)).astype(np.int64)
        share, claims = len(rows) / front.n_open, self._claims.copy()
        stage = Stage(front.stage.stretch, self._shapes, self._halves, claims.claims)
        some = Front(stage, front.items.of(rows), front.hints[:, rows])
        while some.n_open and some.found.n_items < most * share:
            some.advance(claims)
        return (some.found.n_items + some.n_open) / share

    def finish(self, most_items: int, progress: Progress | None = None) -> EvidenceList:
        """All that is to be said, in the order in which it will be asked for.

        Args:
            progress: called in thousandths of the proofs that are foreseen.

        Raises:
            TooManyProofs: not in so many. BadInput: it cannot be proven so.
        """
        found, n, before = EvidenceList(), self.n_found, self.n_found
        ahead = max(1, self.n_foreseen - before)
        for front in self._fronts:
            while front.n_open:
                n += front.n_open
                front.advance(self._claims)
                if n > most_items:
                    raise too_many(n, most_items)
                if progress is not None:
                    progress(min(999, 1000 * (n - before) // ahead), 1000)
            front.require_outside()
            found = found.and_then(front.found)
        if progress is not None:
            progress(1000, 1000)
        return found


def too_many(n: float, most: int) -> TooManyProofs:
    """That a receipt would be too large: so many proofs were found or are foreseen, rounded to one digit."""
    about = int(round(n, 1 - len(str(int(n)))))
    return TooManyProofs(
        f"a full receipt takes about {about:,} proofs or more, of {most:,} at most",
        valid="--receipt sampled",
    )
