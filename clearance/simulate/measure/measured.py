"""A run as it was measured: the data of its record, with what can measure more of it.

The classes here are those of the record with what measures; `plain` gives the data alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from clearance.record.certificate import Certificate
from clearance.record.measurement import Measurement, Minima
from clearance.record.moment import Moment

Plain = TypeVar("Plain")


def plain(kind: type[Plain], given: Any) -> Plain:
    """The fields of a data class alone, from an object of it that can do more."""
    return kind(**{one.name: getattr(given, one.name) for one in fields(kind)})  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class MeasuredSteps(Measurement):
    """The clearances of a motion, and what finds those of each pair.

    Attributes:
        measure_pair_minima: the least clearance of each pair, or of those that come nearest, of which there are at
            least so many; not measured until it is called. None if it was not asked for.
    """

    measure_pair_minima: Callable[[int | None], Minima] | None = field(kw_only=True)

    @cached_property
    def data(self) -> Measurement:
        """The clearances alone."""
        return plain(Measurement, self)


@dataclass(frozen=True, eq=False)
class ProvenMotion(Certificate):
    """The bounds of a motion, and what measures the moments that they were seen at.

    Attributes:
        moment_of: measures the pair of an interval at that moment.
    """

    moment_of: Callable[[int], Moment] = field(kw_only=True)

    @cached_property
    def data(self) -> Certificate:
        """The bounds alone, with the moment of the least distance seen between steps."""
        return replace(plain(Certificate, self), worst=self.nearest_moment)

    @cached_property
    def nearest_moment(self) -> Moment | None:
        """The moment of the least distance seen between steps; None if all were nearest at a step."""
        return None if self.nearest_between is None else self.moment_of(self.nearest_between)


def no_minima(n_pairs: int) -> Minima:
    """The minima of pairs of which nothing is measured yet."""
    steps = np.full(n_pairs, -1, dtype=np.int64)
    return Minima(np.full(n_pairs, np.inf), steps, np.full((n_pairs, 2, 3), np.nan))
