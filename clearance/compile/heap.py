"""What Python has of structures that kernels keep on the heap. Not for: how they lie there (`numba_private`)."""

from __future__ import annotations

import pickle
from typing import Any


class HeapHandle:
    """Holds one structure: a subclass for each kind of it.

    Attributes:
        form: names the type of its fields.
    """

    __slots__ = ("_meminfo", "_type", "form")

    form: str

    def __init__(self, told: tuple[str, bytes], meminfo: object) -> None:
        """A handle of what lies at `meminfo`, of the compiler's type whose name and pickle are `told`."""
        self.form, self._type = told
        self._meminfo = meminfo

    @property
    def _numba_type_(self) -> Any:
        if self._type not in _types:
            _types[self._type] = pickle.loads(self._type)
        return _types[self._type]


_types: dict[bytes, Any] = {}
