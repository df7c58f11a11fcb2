"""The `<state>` of a saved SDF world: where models were then. Not for: where they are placed (`scope`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadInput, at
from clearance.formats.scene.sdf.document import name_of, pose_of
from clearance.formats.scene.sdf.frames import NamedFrames

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

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
            raise BadInput("<insertions> add models", where="state", valid="models in the world")


def _require_same(element: Element, name: str, frames: NamedFrames) -> None:
    if element.find("pose") is None:
        return
    if not np.abs(pose_of(element) - frames.pose(name)).max() <= SAME:
        raise BadInput(
            "it was saved elsewhere than it is placed",
            valid="its saved pose in <model>, or no <state>",
        )
