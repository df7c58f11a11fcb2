"""The clearance of every pair at every step, and its table. Not for: measuring it (`measure`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.record.names import LINK_AND_OBSTACLE, SIDES
from clearance.record.rows.blocks import BLOCK
from clearance.record.table import pa
from clearance.world.rules import DEFAULT


@dataclass(frozen=True, eq=False)
class EveryPair:
    """The clearance of every pair at every step.

    Attributes:
        links, obstacles: (p,) names of the two bodies of each pair.
        clearance: (n, p) [m]; NaN where a pair is not measured at a step.
        sides: what the first columns of the run's tables call the two bodies.
        by_rule: (n, p) [m] of each rule, by its name, the clearances that it judges, NaN elsewhere.
    """

    links: list[str]
    obstacles: list[str]
    clearance: np.ndarray
    sides: tuple[str, str] = LINK_AND_OBSTACLE
    by_rule: tuple[tuple[str, np.ndarray], ...] = ()

    @cached_property
    def table(self) -> pa.Table:
        """One row a step and pair: step, link and obstacle (where all steps have them), clearance [m] (null where
        the pair is not measured), body_a, body_b, and the rule that judges it."""
        return pa.concat_tables(self.batches()).combine_chunks()

    def batches(self) -> Iterator[pa.Table]:
        """The rows of `table`, a block of steps at a time."""
        n_steps, n_pairs = self.clearance.shape
        size = max(1, BLOCK // n_pairs)
        for start in range(0, n_steps, size):
            part = self.clearance[start : start + size]
            names = [_repeated(each, len(part)) for each in (self.links, self.obstacles)]
            columns = {
                "step": pa.array(np.repeat(np.arange(start, start + len(part)), n_pairs)),
                self.sides[0]: names[0],
                self.sides[1]: names[1],
                "clearance": pa.array(part.reshape(-1), from_pandas=True),
            }
            columns |= dict(zip(SIDES, names, strict=True))
            yield pa.table(columns | {"rule": self._rules(slice(start, start + len(part)))})

    def _rules(self, steps: slice) -> pa.DictionaryArray:
        """What judges each row of some steps; of two the one of less clearance; null where nothing does."""
        names = [name for name, _ in self.by_rule] or [DEFAULT]
        part = self.clearance[steps]
        codes = np.zeros(part.shape, dtype=np.int32)
        if len(names) > 1:
            own = np.array([clearance[steps] for _, clearance in self.by_rule])
            codes = np.argmin(np.where(np.isnan(own), np.inf, own), axis=0).astype(np.int32)
        indices = pa.array(codes.reshape(-1), mask=np.isnan(part).reshape(-1))
        return pa.DictionaryArray.from_arrays(indices, pa.array(names, pa.string()))


def _repeated(names: Sequence[str], times: int) -> pa.DictionaryArray:
    """All names, so many times over.

    Each is in the dictionary once: pyarrow writes one that has a name twice with room for both, and what it leaves
    empty is whatever lay in memory there.
    """
    codes = {name: code for code, name in enumerate(dict.fromkeys(names))}
    indices = np.array([codes[name] for name in names], dtype=np.int32)
    return pa.DictionaryArray.from_arrays(
        pa.array(np.tile(indices, times)), pa.array([*codes], pa.string())
    )
