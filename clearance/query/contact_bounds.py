"""Proven bounds on an overlap where the effort is spent: a few products per corner of both bodies."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.envelope import TWENTY_SIX
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.contact import Contact

ROUNDING = 1e-13
"""[-] Of the greatest coordinate: what is added to a bound for its own rounding."""

_extents: WeakKeyDictionary[Polyhedron, np.ndarray] = WeakKeyDictionary()


def bounded_contact(
    a: Polyhedron, b: Polyhedron, b_from_a: np.ndarray, witness: np.ndarray, why: str
) -> Contact:
    """The overlap of two bodies in the frame of b, from above: 26 ways out, and the boxes of both.

    Args:
        witness: (3,) a common point. why: a note says why no more is known.

    Exactness: moved by `penetration * direction` no corner of a is below one of b along that direction, so the
        bodies are separate whether they are closed or not. Their common region lies in both boxes.
    """
    here = a.vertices @ b_from_a[:3, :3].T + b_from_a[:3, 3]
    supports = _extent_of(b) - (here @ TWENTY_SIX.T).min(axis=0)
    least = int(supports.argmin())
    low = np.maximum(here.min(axis=0), b.bounds[0])
    high = np.minimum(here.max(axis=0), b.bounds[1])
    slack = ROUNDING * float(np.abs([here.min(axis=0), here.max(axis=0), *b.bounds]).max())
    volume = float(np.prod(np.maximum(0.0, high - low + slack)))
    return Contact(
        penetration=max(0.0, float(supports[least]) + slack),
        penetration_at_least=0.0,
        direction=TWENTY_SIX[least].copy(),
        volume=volume,
        volume_at_least=0.0,
        centroid=witness,
        region=ClosedMesh.empty(),
        exact=(False, False),
        notes=(why,),
    )


def _extent_of(body: Polyhedron) -> np.ndarray:
    """(26,) [m] how far the body reaches along the 26 directions."""
    if body not in _extents:
        _extents[body] = (body.vertices @ TWENTY_SIX.T).max(axis=0)
    return _extents[body]
