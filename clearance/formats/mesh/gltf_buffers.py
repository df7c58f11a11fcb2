"""Accessors of a glTF document, sparse and quantized ones too, to arrays; nothing is read beyond its data.

Source: Khronos, glTF 2.0, chapter 3.6 (buffers, accessors, sparse accessors); KHR_mesh_quantization.
"""

from __future__ import annotations

import base64
import binascii
from typing import Any

import numpy as np

from clearance.errors import BadSyntax, MissingKey
from clearance.formats.mesh.gltf_object import GltfObject

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
