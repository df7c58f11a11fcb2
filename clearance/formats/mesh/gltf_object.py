"""Objects of a glTF document, whose fields are checked as they are asked for.

Not for: what the fields mean (`gltf_file`, `gltf_mesh`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

import numpy as np

from clearance.errors import BadSyntax, MissingKey, NotFinite


class GltfObject:
    """A JSON object whose fields are checked as they are asked for."""

    def __init__(self, value: Any, place: str) -> None:
        if not isinstance(value, dict):
            raise BadSyntax(f"{place} is {value!r:.40}", valid="an object")
        self.value: dict[str, Any] = value
        self.place = place

    def items(self, key: str) -> list[Any]:
        """The list at `key`; empty where there is none."""
        found = self.value.get(key, [])
        if not isinstance(found, list):
            raise BadSyntax(f"{key} of {self.place} is {found!r:.40}", valid="a list")
        return found

    def object(self, key: str) -> GltfObject:
        """The object at `key`."""
        if key not in self.value:
            raise MissingKey(f"{self.place} has no {key!r}")
        return GltfObject(self.value[key], f"{key} of {self.place}")

    def item(self, key: str, index: int) -> GltfObject:
        """The object `index` of the list at `key`."""
        items = self.items(key)
        if index >= len(items):
            raise BadSyntax(f"{key}[{index}] is referred to", valid=f"there are {len(items)}")
        return GltfObject(items[index], f"{key}[{index}]")

    def index(self, key: str, default: int | None = None) -> int:
        """The whole number at `key`, 0 or more."""
        found = self.value.get(key, default)
        if found is None:
            raise MissingKey(f"{self.place} has no {key!r}")
        if isinstance(found, bool) or not isinstance(found, int) or not 0 <= found < 2**53:
            raise BadSyntax(f"{key} of {self.place} is {found!r:.40}", valid="a whole number")
        return found

    def indices(self, key: str) -> list[int]:
        """The whole numbers of the list at `key`."""
        return [GltfObject({key: found}, self.place).index(key) for found in self.items(key)]

    @overload
    def numbers(
        self, key: str, default: Sequence[float], length: int | None = None
    ) -> np.ndarray: ...
    @overload
    def numbers(self, key: str, default: None, length: int | None = None) -> np.ndarray | None: ...
    def numbers(
        self, key: str, default: Sequence[float] | None, length: int | None = None
    ) -> np.ndarray | None:
        """The numbers of the list at `key`; `default` where there is none."""
        if key not in self.value:
            return None if default is None else np.array(default)
        found = self.items(key)
        plain = all(isinstance(x, int | float) and not isinstance(x, bool) for x in found)
        if not plain or length not in (None, len(found)):
            raise BadSyntax(
                f"{key} of {self.place} is {found!r:.40}", valid=f"{length or 'only'} numbers"
            )
        try:
            values = np.array(found, dtype=np.float64)
        except OverflowError:
            values = np.array([np.inf])
        if not np.isfinite(values).all():
            raise NotFinite(f"{key} of {self.place} has a number that is not finite")
        return values

    def refuse_extension(self, *names: str) -> None:
        """Refuses the extensions by which this would be another surface."""
        extensions = self.object("extensions").value if "extensions" in self.value else {}
        for name in names:
            if name in extensions:
                raise BadSyntax(f"{self.place} has the extension {name}, which is not read")
