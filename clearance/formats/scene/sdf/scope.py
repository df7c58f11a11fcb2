"""The collisions of an SDF world or model, nested and included models among them, each where its frames put it;
and whether a saved `<state>` of the world says the same.

Source: SDF specification 1.11, "Pose Frame Semantics" and "Composition". Not for: finding included files
(`include`), nor the shapes (`geometry`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from clearance.errors import BadScene, at, nearest_name
from clearance.formats.scene.sdf.document import (
    base_of,
    name_of,
    numbers_of,
    pose_of,
    text_of,
)
from clearance.formats.scene.sdf.geometry import geometry_of
from clearance.geometry.pose import inverse

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

DEEPEST = 40
"""Models within models, included or not."""

MOST_SHAPES = 20_000
"""Collisions of one file; included files may each be included again and again."""


class SdfShape(NamedTuple):
    """A collision.

    Attributes:
        name: model/link/collision. pose: (4, 4) [m] in the world or model that is read.
        row: its shape as in a YAML scene. folder: of the file that it is in.
    """

    name: str
    pose: np.ndarray
    row: dict[str, Any]
    folder: Path


class IncludedModel(NamedTuple):
    """The model in an included file: none where that holds only lights or actors."""

    model: Element | None
    folder: Path
    shown: str


@dataclass(frozen=True)
class Scope:
    """Reads a world or a model.

    Attributes:
        folder: of the file. include: finds the file that an `<include>` names. chain: the files that include one
            another, the outermost first.
    """

    folder: Path
    include: Callable[[Element, Path, tuple[str, ...]], IncludedModel]
    chain: tuple[str, ...]
    depth: int = 0
    n_shapes: list[int] = field(default_factory=lambda: [0])

    def read(self, element: Element, root: str) -> tuple[NamedFrames, list[SdfShape]]:
        """The frames of a world or model, and its collisions.

        Args:
            root: what its own frame is called in it.

        Raises:
            BadInput: with the element.
        """
        frames = NamedFrames(root)
        placed = [*self._models(element, frames)]
        links = [*element.iterfind("link")]
        for link in links:
            with at(f"link {link.get('name')!r}"):
                frames.add(name_of(link), base_of(link), pose_of(link))
        _add_frames(element, frames)
        shapes = [shape for link in links for shape in self._link(link, frames)]
        for prefix, base, pose, inner in placed:
            with at(f"model {prefix!r}"):
                world_from_model = frames.pose(base) @ pose
            shapes += [
                one._replace(name=f"{prefix}{one.name}", pose=world_from_model @ one.pose)
                for one in inner
            ]
        return frames, shapes

    def _models(
        self, element: Element, frames: NamedFrames
    ) -> Iterator[tuple[str, str, np.ndarray, list[SdfShape]]]:
        """What stands before the names of a model within, what it is placed in and where, and its collisions."""
        for child in element:
            if child.tag == "model":
                with at(f"model {child.get('name')!r}"):
                    name = name_of(child)
                    yield self._model(child, name, _Place.of(child), frames)
            elif child.tag == "include":
                with at(f"include {(child.findtext('uri') or '').strip()!r:.80}"):
                    yield from self._included(child, frames)
            elif child.tag == "population":
                raise BadScene(
                    "<population> places models at random", valid="models at their poses"
                )

    def _model(
        self, model: Element, name: str, place: _Place, frames: NamedFrames, *, merged: bool = False
    ) -> tuple[str, str, np.ndarray, list[SdfShape]]:
        if self.depth >= DEEPEST:
            raise BadScene(f"models lie {DEEPEST} deep in each other", valid="fewer")
        inner, shapes = replace(self, depth=self.depth + 1).read(model, "__model__")
        pose = place.pose
        if place.frame:
            pose = pose @ inverse(inner.pose(place.frame))
        frames.add_model(name, inner, place.base, pose, merged=merged)
        return "" if merged else f"{name}/", place.base, pose, shapes

    def _included(
        self, include: Element, frames: NamedFrames
    ) -> Iterator[tuple[str, str, np.ndarray, list[SdfShape]]]:
        found = self.include(include, self.folder, self.chain)
        if found.model is None:
            return
        with at(found.shown):
            inner = replace(self, folder=found.folder, chain=(*self.chain, found.shown))
            name = text_of(include, "name", name_of(found.model))
            place = _Place.of(found.model)
            if include.find("pose") is not None:
                place = _Place(base_of(include), pose_of(include), place.frame)
            place = place._replace(frame=text_of(include, "placement_frame", place.frame))
            merged = (include.get("merge") or "").strip() in ("true", "1")
            yield inner._model(found.model, name, place, frames, merged=merged)

    def _link(self, link: Element, frames: NamedFrames) -> Iterator[SdfShape]:
        for collision in link.iterfind("collision"):
            with at(f"link {link.get('name')!r}"), at(f"collision {collision.get('name')!r}"):
                shape = geometry_of(collision)
                base = base_of(collision)
                if base:
                    pose = frames.pose(base)
                else:
                    pose = frames.pose(base_of(link)) @ pose_of(link)
                pose = pose @ pose_of(collision)
                name = f"{name_of(link)}/{name_of(collision)}"
            self.n_shapes[0] += 1
            if self.n_shapes[0] > MOST_SHAPES:
                raise BadScene(f"more than {MOST_SHAPES} collisions", valid="fewer")
            if shape is not None:
                yield SdfShape(name, pose @ shape.pose, shape.row, self.folder)


class _Place(NamedTuple):
    """Where a model is: its `frame`, or its own if that is empty, at `pose` in `base`."""

    base: str
    pose: np.ndarray
    frame: str = ""

    @classmethod
    def of(cls, model: Element) -> _Place:
        return cls(base_of(model), pose_of(model), model.get("placement_frame") or "")


def _add_frames(element: Element, frames: NamedFrames) -> None:
    """The frames that are only named: `<frame>`, and joints, which are in their child link."""
    for frame in element.iterfind("frame"):
        with at(f"frame {frame.get('name')!r}"):
            base = base_of(frame) or frame.get("attached_to") or ROOT
            frames.add(name_of(frame), base, pose_of(frame))
    for joint in element.iterfind("joint"):
        with at(f"joint {joint.get('name')!r}"):
            base = base_of(joint) or text_of(joint, "child", ROOT)
            frames.add(name_of(joint), base, pose_of(joint))


ROOT = ""
"""The frame of the model or world itself."""


class NamedFrames:
    """Frames by name, each given in another; `a::b` is b in the model a.

    Args:
        root: what files call the frame of the model or world itself: `__model__` or `world`.
    """

    def __init__(self, root: str) -> None:
        self._given: dict[str, tuple[str, np.ndarray]] = {}
        self._inner: dict[str, NamedFrames] = {}
        self._merged: list[str] = []
        self._found = {ROOT: np.eye(4), root: np.eye(4)}

    def add(self, name: str, base: str, pose: np.ndarray) -> None:
        """A frame at `pose` (4, 4) [m] in the frame `base`; of two of one name the first counts."""
        self._given.setdefault(name, (base, pose))

    def add_model(
        self, name: str, frames: NamedFrames, base: str, pose: np.ndarray, *, merged: bool = False
    ) -> None:
        """A model within, its frames seen as `name::frame`, and, if it is merged, as this one's own."""
        self.add(name, base, pose)
        self._inner.setdefault(name, frames)
        if merged:
            self._merged.append(name)

    def pose(self, name: str) -> np.ndarray:
        """The (4, 4) pose [m] of a frame in the model or world.

        Raises:
            BadInput: there is no such frame, or frames that refer to each other in a ring.
        """
        way: dict[str, np.ndarray] = {}
        while name not in self._found:
            if name in way:
                raise BadScene(f"frame {name!r:.60} is relative to itself", valid="no ring")
            base, way[name] = self._step(name)
            name = base
        pose = self._found[name]
        for step, local in reversed(way.items()):
            pose = self._found[step] = pose @ local
        return pose

    def _step(self, name: str) -> tuple[str, np.ndarray]:
        """The frame in which a frame is given, and its pose there."""
        if name in self._given:
            return self._given[name]
        head, _, rest = name.partition("::")
        if rest and head in self._inner:
            return head, self._inner[head].pose(rest)
        for model in self._merged:
            if name in self._inner[model]._given:
                return model, self._inner[model].pose(name)
        raise BadScene(f"there is no frame {name!r:.60}", valid=nearest_name(name, self._given))


SAME = 1e-4
"""[m], and of entries of a rotation: states are written with six digits."""


def require_state_as_placed(world: Element, frames: NamedFrames) -> None:
    """Nothing, if a saved state has every model and link where the world itself places them.

    Raises:
        BadInput: a model or link elsewhere, or one that the world does not have.
    """
    for state in world.iterfind("state"):
        for model in state.iterfind("model"):
            with at(f"state: model {model.get('name')!r}"):
                _require_same(model, name_of(model), frames)
                for link in model.iterfind("link"):
                    with at(f"link {link.get('name')!r}"):
                        _require_same(link, f"{name_of(model)}::{name_of(link)}", frames)
        if state.find("insertions") is not None:
            raise BadScene("<insertions> add models", where="state", valid="models in the world")


def _require_same(element: Element, name: str, frames: NamedFrames) -> None:
    scale = text_of(element, "scale", "1 1 1")
    if any(factor != 1.0 for factor in numbers_of(element, "scale", 3, "1 1 1")):
        raise BadScene(f"it was saved with a scale of {scale:.60}", valid="shapes of that size")
    if element.find("pose") is None:
        return
    if not np.abs(pose_of(element) - frames.pose(name)).max() <= SAME:
        raise BadScene(
            "it was saved elsewhere than it is placed",
            valid="its saved pose in <model>, or no <state>",
        )
