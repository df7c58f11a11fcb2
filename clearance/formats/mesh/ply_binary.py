"""Rows of a binary PLY file: at once where all lists are equally long, else one by one."""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.mesh.ply_rows import Element, PlyRows


class BinaryRows:
    """Rows of a binary file, one after the other."""

    def __init__(self, body: bytes) -> None:
        self.body = body
        self.place = 0

    def rows(self, element: Element) -> PlyRows:
        """The next rows."""
        lists = [item for item in element.properties if item.length_kind is not None]
        sizes = [(item.length_kind or item.kind).itemsize for item in element.properties]
        if element.n_rows * sum(sizes) > len(self.body) - self.place:
            raise BadSyntax(f"{element.n_rows} rows do not fit in the file: it is cut off")
        if element.n_rows and not element.properties:
            raise BadSyntax(f"{element.n_rows} rows without properties")
        lengths = self._first_lengths(element) if element.n_rows and lists else {}
        same = self._block(element, lengths) if lengths is not None else None
        return same if same is not None else self._one_by_one(element)

    def _first_lengths(self, element: Element) -> dict[str, int] | None:
        """How long the lists of the first row are, if all rows fit in the file with lists as long."""
        lengths, place = {}, self.place
        for item in element.properties:
            if item.length_kind is None:
                place += item.kind.itemsize
                continue
            found = self._take(item.length_kind, 1, place)
            lengths[item.name] = int(found[0])
            place += item.length_kind.itemsize + max(0, lengths[item.name]) * item.kind.itemsize
        fits = (
            min(lengths.values()) >= 0
            and (place - self.place) * element.n_rows <= len(self.body) - self.place
        )
        return lengths if fits else None

    def _block(self, element: Element, lengths: dict[str, int]) -> PlyRows | None:
        """All rows at once, if all lists are of the given lengths; else None."""
        fields: list[tuple[str, np.dtype] | tuple[str, np.dtype, tuple[int]]] = []
        for k, item in enumerate(element.properties):
            if item.length_kind is None:
                fields.append((f"v{k}", item.kind))
            else:
                fields += [
                    (f"n{k}", item.length_kind),
                    (f"v{k}", item.kind, (lengths.get(item.name, 0),)),
                ]
        kind = np.dtype(fields)
        table = self._take(kind, element.n_rows, self.place)
        columns, lists = {}, {}
        for k, item in enumerate(element.properties):
            if item.length_kind is None:
                columns[item.name] = table[f"v{k}"]
                continue
            counts = table[f"n{k}"].astype(np.int64)
            if (counts != lengths.get(item.name, 0)).any():
                return None
            lists[item.name] = (table[f"v{k}"].reshape(-1), counts)
        self.place += element.n_rows * kind.itemsize
        return PlyRows(element.n_rows, columns, lists)

    def _one_by_one(self, element: Element) -> PlyRows:
        found: dict[str, list[np.ndarray]] = {item.name: [] for item in element.properties}
        counts: dict[str, list[int]] = {item.name: [] for item in element.properties}
        for _ in range(element.n_rows):
            for item in element.properties:
                count = 1
                if item.length_kind is not None:
                    count = int(self._next(item.length_kind, 1)[0])
                found[item.name].append(self._next(item.kind, count))
                counts[item.name].append(count)
        columns, lists = {}, {}
        for item in element.properties:
            flat = np.concatenate(found[item.name])
            if item.length_kind is None:
                columns[item.name] = flat
            else:
                lists[item.name] = (flat, np.array(counts[item.name]))
        return PlyRows(element.n_rows, columns, lists)

    def _next(self, kind: np.dtype, count: int) -> np.ndarray:
        values = self._take(kind, count, self.place)
        self.place += count * kind.itemsize
        return values

    def _take(self, kind: np.dtype, count: int, place: int) -> np.ndarray:
        if count < 0 or place + count * kind.itemsize > len(self.body):
            raise BadSyntax(
                f"a list or row of {count} numbers does not fit in the file: it is cut off"
            )
        return np.frombuffer(self.body, kind, count, place) if count else np.empty(0, kind)

    def refuse_rest(self) -> None:
        """Refuses bytes that no element has."""
        rest = self.body[self.place :]
        if rest.strip(b" \t\r\n\0"):
            raise BadSyntax(f"the PLY file has {len(rest)} bytes more than its header says")
