"""Tables as columns in memory, and the same as tables of pyarrow for who asks for those.

Not for: what stands in them (`steps`, `every_pair`), nor files (`report.tables`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import TYPE_CHECKING, Any

import numpy as np

from clearance.extras import Library

if TYPE_CHECKING:
    import pyarrow as pa
else:
    pa = Library("pyarrow", "tables", "a table of steps or pairs")

FEW = 100_000
"""Rows that take less time one by one than the import of `pyarrow.compute` does."""


@dataclass(frozen=True, eq=False)
class Names:
    """A column of names.

    Attributes:
        codes: (n,) int which of `names` each row has; negative where it has none.
    """

    codes: np.ndarray
    names: Sequence[str]

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, rows: slice | np.ndarray) -> Names:
        return Names(self.codes[rows], self.names)

    def tolist(self) -> list[str | None]:
        """The name of each row, or None."""
        known = [*self.names, None]  # of which -1 is the last
        return [*map(known.__getitem__, np.maximum(self.codes, -1).tolist())]

    def places_in(self, names: Iterable[str]) -> np.ndarray:
        """(n,) int64 which of other names each row has; -1 where it has none of them."""
        place = {name: i for i, name in enumerate(names)}
        places = np.array([*map(place.get, self.names, repeat(-1)), -1], dtype=np.int64)
        return places[np.maximum(self.codes, -1)]

    def arrow(self) -> pa.Array:
        """The names as pyarrow has them."""
        if len(self) < FEW:
            return pa.array(self.tolist(), pa.string())
        return pa.array(self.names, pa.string()).take(pa.array(self.codes, mask=self.codes < 0))


Column = np.ndarray | Names


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of one length, by name; a number that is not known is NaN."""

    columns: Mapping[str, Column]

    @property
    def n_rows(self) -> int:
        """How many rows there are."""
        return len(next(iter(self.columns.values())))

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def numbers(self, name: str) -> np.ndarray:
        """(n,) a column of numbers."""
        column = self.columns[name]
        assert isinstance(column, np.ndarray)
        return column

    def names(self, name: str) -> Names:
        """(n,) a column of names."""
        column = self.columns[name]
        assert isinstance(column, Names)
        return column

    def at(self, rows: slice | np.ndarray) -> Table:
        """Some of the rows."""
        return Table({name: column[rows] for name, column in self.columns.items()})

    def row(self, i_row: int) -> dict[str, Any]:
        """One row as plain data, None where nothing is known."""
        one = {k: column[i_row : i_row + 1].tolist()[0] for k, column in self.columns.items()}
        return {name: None if value != value else value for name, value in one.items()}

    def with_columns(self, columns: Mapping[str, Column]) -> Table:
        """The table with some columns in place of its own, or behind them."""
        return Table({**self.columns, **columns})

    def arrow(self) -> pa.Table:
        """The table as pyarrow has it, null where nothing is known: an infinite bound is of no pair.

        Raises:
            Unavailable: pyarrow is not installed.
        """
        return pa.table(
            {
                name: column.arrow()
                if isinstance(column, Names)
                else pa.array(np.where(np.isinf(column), np.nan, column), from_pandas=True)
                if np.issubdtype(column.dtype, np.floating)
                else pa.array(column)
                for name, column in self.columns.items()
            }
        )
