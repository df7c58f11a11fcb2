"""A closed concave mesh as a few convex parts, by CoACD.

CoACD cuts a mesh where its hull strays from it and stops where the concavity is below a share of the size.
Its parts approximate the mesh: `convex_parts` says by how much. Not for: convex bodies.
"""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import numpy as np

from clearance.errors import BadPolygon, Unavailable
from clearance.extras import install, is_installed

THRESHOLDS = (0.05, 0.02, 0.01)
"""[-] The concavity that CoACD leaves uncut, its default first: finer costs parts, and depth is sharpened by
distance queries on the bodies themselves. The finer ones are for long slender bodies that it does not cut."""

MOST_WORK = 15
"""[s] of processor time after which CoACD is given up: many times what most links need. On some meshes it
cuts for ever."""

LONGEST = 10.0 * MOST_WORK
"""[s] of the clock, should the other limit fail."""

_PROCESS = Path(__file__).with_name("coacd_process.py")


def available() -> bool:
    """True if CoACD is installed."""
    return is_installed("coacd")


def cut_into_hulls(
    vertices: np.ndarray, triangles: np.ndarray, threshold: float = THRESHOLDS[0]
) -> list[np.ndarray]:
    """The corners (k, 3) [m] of convex parts that together stand for a closed mesh.

    The same mesh gives the same parts: CoACD's search is seeded.

    Raises:
        Unavailable: CoACD is not installed. BadPolygon: it makes nothing of this mesh.

    Source: Wei, Liu, Ling & Su (2022), "Approximate convex decomposition for 3D meshes with
        collision-aware concavity and tree search", as the library CoACD.
    """
    if not available():
        raise Unavailable("CoACD is not installed", valid=install("contact"))
    sent = io.BytesIO()
    np.savez(sent, vertices=vertices, triangles=triangles, threshold=threshold, seconds=MOST_WORK)
    try:
        done = subprocess.run(
            [sys.executable, "-P", str(_PROCESS)],
            input=sent.getvalue(),
            capture_output=True,
            timeout=LONGEST,
            check=True,
        )
        with np.load(io.BytesIO(done.stdout)) as parts:
            hulls = [parts[name] for name in parts.files]
    except (subprocess.SubprocessError, OSError, ValueError) as error:
        raise BadPolygon(f"CoACD came to no end ({_reason(error)})") from None
    if not hulls:
        raise BadPolygon("CoACD makes no parts of the mesh", valid="a closed mesh")
    return hulls


def _reason(error: Exception) -> str:
    code = getattr(error, "returncode", None)
    return type(error).__name__ if code is None else f"exit code {code}"
