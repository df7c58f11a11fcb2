"""MoveIt's `.scene` files, of either version, to a scene. Strict: what is left over, or missing, is refused.

Source: MoveIt, planning_scene.cpp (loadGeometryFromStream), shape_operations.cpp (constructShapeFromText).
Not for: messages (`planning_scene`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.errors import BadSyntax, at
from clearance.formats.scene.moveit.objects import Row, SceneMeshes, named_rows, primitive
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.formats.text.numbers import floats, integers
from clearance.geometry.pose import pose_from_quaternion
from clearance.world.names import checked_name

_N_WORDS = {"sphere": 1, "box": 3, "cylinder": 2, "cone": 2, "plane": 4}


def read_moveit_scene(asked: SceneRequest) -> SceneContent:
    """The obstacles in a `.scene` file.

    Raises:
        BadSyntax: no such file, cut off, or with more than it says; with the line. BadInput: a cone or plane.
    """
    with at(asked.shown):
        lines = _Lines(asked.files.read(asked.path))
        rows = list(_objects(lines, SceneMeshes(asked)))
    return SceneContent({"obstacles": rows})


class _Lines:
    """The lines of a file, read one after the other."""

    def __init__(self, data: bytes) -> None:
        try:
            self._lines = data.decode("utf-8-sig").splitlines()
        except UnicodeDecodeError as error:
            raise BadSyntax(f"byte {error.start} is not UTF-8 text", valid="a text file") from None
        self.n_read = 0

    def peek(self) -> str:
        """The next line that is not empty; nothing at the end."""
        while self.n_read < len(self._lines) and not self._lines[self.n_read].strip():
            self.n_read += 1
        return self._lines[self.n_read].strip() if self.n_read < len(self._lines) else ""

    def take(self, wanted: str) -> str:
        """The next line, which is gone.

        Raises:
            BadSyntax: the file ends.
        """
        line = self.peek()
        if not line:
            raise BadSyntax("the file ends", valid=f"{wanted} is needed")
        self.n_read += 1
        return line

    def _words(self, n: int, wanted: str) -> list[str]:
        words = self.take(wanted).split()
        if len(words) != n:
            raise BadSyntax(f"{' '.join(words)!r:.60} is given", valid=f"{wanted}: {n} numbers")
        return words

    def numbers(self, n: int, wanted: str) -> list[float]:
        """The numbers of a line."""
        return floats(self._words(n, wanted)).tolist()

    def whole(self, n: int, wanted: str) -> list[int]:
        """The whole numbers of a line, none below 0."""
        words = self._words(n, wanted)
        values = integers(words).tolist()
        if min(values) < 0 or max(values) > len(self._lines) * 10:
            raise BadSyntax(
                f"{' '.join(words)!r:.60} is given", valid=f"{wanted}, as many as there are"
            )
        return values

    def pose(self) -> np.ndarray:
        """(4, 4) [m] a line with a place, and one with a quaternion xyzw."""
        return pose_from_quaternion(self.numbers(3, "a place"), self.numbers(4, "a quaternion"))


def _objects(lines: _Lines, meshes: SceneMeshes) -> Iterator[Row]:
    lines.take("the scene's name")
    while True:
        line = lines.take("an object (* name), or a point at the end")
        if line == ".":
            break
        if not line.startswith("*") or not line[1:].strip():
            raise _at_line(lines, f"{line!r:.60} is given", "* and the object's name")
        name = checked_name(line[1:].strip())
        try:
            yield from _object(name, lines, meshes)
        except BadSyntax as error:
            raise _at_line(lines, error.problem, error.valid, name) from None
    if lines.peek():
        raise _at_line(lines, "there is more behind the point", "nothing")


def _object(name: str, lines: _Lines, meshes: SceneMeshes) -> list[Row]:
    """The second version has the object's pose before its shapes, and its subframes behind them."""
    with at(repr(name)):
        has_pose = len(lines.peek().split()) > 1
        from_object = lines.pose() if has_pose else np.eye(4)
        shapes = []
        for _ in range(lines.whole(1, "how many shapes")[0]):
            row = _shape(lines, meshes)
            shapes.append((row, from_object @ lines.pose()))
            lines.numbers(4, "a colour")
        if has_pose and not lines.peek().startswith(("*", ".")):
            for _ in range(lines.whole(1, "how many subframes")[0]):
                lines.take("a subframe")
                lines.pose()
    return named_rows(name, shapes)


def _shape(lines: _Lines, meshes: SceneMeshes) -> Row:
    kind = lines.take("a shape")
    if kind == "mesh":
        n_vertices, n_triangles = lines.whole(2, "numbers of vertices and triangles")
        vertices = [lines.numbers(3, "a vertex") for _ in range(n_vertices)]
        return meshes.inline(vertices, [lines.whole(3, "a triangle") for _ in range(n_triangles)])
    if kind not in _N_WORDS:
        raise BadSyntax(f"{kind!r:.60} is no shape", valid=f"{', '.join(_N_WORDS)} or mesh")
    numbers = lines.numbers(_N_WORDS[kind], f"the dimensions of a {kind}")
    return primitive(kind, numbers[::-1] if kind == "cylinder" else numbers)


def _at_line(lines: _Lines, problem: str, valid: str, name: str = "") -> BadSyntax:
    where = f"line {lines.n_read}" + (f": {name!r}" if name else "")
    return BadSyntax(problem, where=where, valid=valid)
