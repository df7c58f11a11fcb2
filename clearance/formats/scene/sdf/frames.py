"""The frames of one SDF model or world: links, joints, frames and models by name, and where each is.

Source: SDF specification, "Pose Frame Semantics" (1.7 to 1.11). Not for: reading elements (`scope`).
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadInput, nearest_name

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
                raise BadInput(f"frame {name!r:.60} is relative to itself", valid="no ring")
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
        raise BadInput(f"there is no frame {name!r:.60}", valid=nearest_name(name, self._given))
