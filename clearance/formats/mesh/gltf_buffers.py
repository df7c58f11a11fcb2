"""Objects of a glTF document, whose fields are checked as they are asked for, and its accessors to arrays.

Sparse and quantized accessors are read too; nothing is read beyond the data. Not for: what the fields mean
(`gltf_file`). Source: Khronos, glTF 2.0, chapter 3.6 (buffers, accessors, sparse accessors);
KHR_mesh_quantization.
"""

from __future__ import annotations

import base64
import binascii
from collections.abc import Sequence
from typing import Any

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

    def numbers(
        self, key: str, default: Sequence[float] = (), length: int | None = None
    ) -> np.ndarray:
        """The numbers of the list at `key`; `default` where there is none."""
        if key not in self.value:
            return np.array(default)
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


_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}

MOST_SPARSE = 1_000_000
"""Elements that a sparse accessor without data of its own may have: it need not be as long as its file."""


class Buffers:
    """Reads a document's accessors out of its binary chunk and embedded buffers."""

    def __init__(self, document: GltfObject, binary: bytes) -> None:
        self.document = document
        self.binary = binary

    def read(self, index: int, n_columns: int) -> np.ndarray:
        """(n, n_columns) an accessor's elements, sparse ones put in, normalized ones divided.

        Raises:
            BadSyntax, MissingKey: it has no data, or reaches beyond them, or is of another type.
        """
        accessor = self.document.item("accessors", index)
        count, kind = accessor.index("count"), {1: "SCALAR", 3: "VEC3"}[n_columns]
        if accessor.value.get("type") != kind:
            raise BadSyntax(f"{accessor.place} is {accessor.value.get('type')!r:.20}", valid=kind)
        if not count:
            raise BadSyntax(f"{accessor.place} has no elements")
        component = _component(accessor)
        if "bufferView" in accessor.value:
            values = self._elements(accessor, count, component, n_columns)
        elif "sparse" in accessor.value:
            if count > MOST_SPARSE:
                raise BadSyntax(
                    f"{accessor.place} has {count} elements", valid=f"up to {MOST_SPARSE:,}"
                )
            values = np.zeros((count, n_columns), dtype=component)
        else:
            raise MissingKey(f"{accessor.place} has no data", valid="a bufferView")
        if "sparse" in accessor.value:
            values = self._with_sparse(accessor, values, component)
        return _divided(values, component) if accessor.value.get("normalized") is True else values

    def _with_sparse(
        self, accessor: GltfObject, values: np.ndarray, component: np.dtype
    ) -> np.ndarray:
        sparse = accessor.object("sparse")
        count = sparse.index("count")
        where = sparse.object("indices")
        rows = self._elements(where, count, _component(where), 1)[:, 0]
        if rows.dtype.kind != "u" or not (rows < len(values)).all():
            raise BadSyntax(f"sparse indices of {accessor.place}", valid=f"0 to {len(values) - 1}")
        changed = values.copy()
        changed[rows] = self._elements(sparse.object("values"), count, component, values.shape[1])
        return changed

    def _elements(
        self, holder: GltfObject, count: int, component: np.dtype, n_columns: int
    ) -> np.ndarray:
        """(count, n_columns) what a bufferView has from the holder's `byteOffset` on."""
        view = self.document.item("bufferViews", holder.index("bufferView"))
        view.refuse_extension("EXT_meshopt_compression", "KHR_meshopt_compression")
        size = component.itemsize * n_columns
        stride = view.index("byteStride", size)
        begin, length = view.index("byteOffset", 0), view.index("byteLength")
        data = self._buffer(view.index("buffer"))
        first = holder.index("byteOffset", 0)
        if (
            stride < size
            or begin + length > len(data)
            or first + stride * (count - 1) + size > length
        ):
            raise BadSyntax(f"{holder.place} reaches beyond the {length} bytes of {view.place}")
        shape, strides = (count, n_columns), (stride, component.itemsize)
        return np.ndarray(shape, component, data, begin + first, strides)

    def _buffer(self, index: int) -> bytes:
        buffer = self.document.item("buffers", index)
        uri = buffer.value.get("uri")
        data = self.binary if uri is None and index == 0 else _embedded(uri, buffer.place)
        length = buffer.index("byteLength")
        if length > len(data):
            raise BadSyntax(f"{buffer.place} has {length} bytes, and {len(data)} are there")
        return data[:length] if length < len(data) else data


def _embedded(uri: Any, place: str) -> bytes:
    head, comma, text = uri.partition(",") if isinstance(uri, str) else ("", "", "")
    if not (comma and head.startswith("data:") and head.endswith(";base64")):
        raise BadSyntax(
            f"the data of {place} are not in the file", valid="one .glb with its buffers"
        )
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise BadSyntax(f"the data of {place} are not base64") from None


def _component(holder: GltfObject) -> np.dtype:
    kind = holder.index("componentType")
    if kind not in _COMPONENTS:
        raise BadSyntax(
            f"componentType {kind} of {holder.place}", valid=", ".join(map(str, _COMPONENTS))
        )
    return np.dtype(_COMPONENTS[kind])


def _divided(values: np.ndarray, component: np.dtype) -> np.ndarray:
    """Normalized whole numbers as parts of one."""
    if component.kind == "f":
        return values
    return np.maximum(values.astype(np.float64) / np.iinfo(component).max, -1.0)
