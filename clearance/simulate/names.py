"""What tables and reports call the bodies of a pair."""

from __future__ import annotations

from collections.abc import Sequence

from clearance.world.case import Case
from clearance.world.pairs import Pair


def pair_names(case: Case, pairs: Sequence[Pair]) -> tuple[list[str], list[str]]:
    """The two bodies of each pair; links carry their robot's name where there are several."""
    return [pair.a.name_in(case) for pair in pairs], [pair.b.name_in(case) for pair in pairs]
