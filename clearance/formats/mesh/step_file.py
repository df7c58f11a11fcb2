"""STEP to triangles: facets that Open CASCADE makes, and how far they may be off the surfaces of the file.

Corners of facets lie on the surface, so facets cut through what is round and span what is hollow: the bound holds
either way, and a case takes it off the clearance (`Polyhedron.shortfall`). What cannot be proven of the facets is
asked for twice as fine as it is counted. Not for: what the file's text says (`step_text`).

Source: Open CASCADE, BRepMesh_IncrementalMesh (linear and angular deflection), RWGltf (metres, single precision).
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from clearance.errors import BadDimension, BadSyntax
from clearance.extras import require
from clearance.formats.mesh.gltf_buffers import Buffers
from clearance.formats.mesh.gltf_file import chunks, read_glb
from clearance.formats.mesh.placing import Z_FROM_Y_UP
from clearance.formats.mesh.request import MeshRequest
from clearance.formats.mesh.step_facets import Facets, facets_of
from clearance.formats.mesh.step_text import step_facts
from clearance.formats.mesh.triangles import Triangles
from clearance.tolerance import COARSEST_TESSELLATION, FINEST_TESSELLATION

_PROCESS = Path(__file__).with_name("step_process.py")

MOST_WORK, LONGEST = 300, 1800
"""[s] of processor time, and of time, for a file."""

TURN = 0.5
"""[rad] Neighbouring facets of a round face turn no farther, however small it is."""

_SINGLE = 2.0**-24 * 3.0**0.5
"""[-] How far rounding to single precision moves a point, relative to its largest coordinate."""


def read_step(asked: MeshRequest) -> Triangles:
    """All faces of a STEP file as facets, in metres, in the file's own axes.

    Raises:
        Unavailable: cascadio is missing. BadDimension: a tolerance that cannot be asked for. BadSyntax: not STEP,
        cut off, of a kind that is not read, or faces that come to no facets or to facets that are farther off.

    Exactness: `off` = tolerance + the accuracy that the file states + rounding to single precision. Open CASCADE
        is asked for half the tolerance; planes, cylinders, cones, spheres and tori are held against it in 15
        points of each facet. Of free-form faces, and of the edges of all, it is the tessellator's word.
    """
    data, tolerance = asked.data, asked.tolerance
    if not FINEST_TESSELLATION <= tolerance <= COARSEST_TESSELLATION:
        valid = f"{FINEST_TESSELLATION:g} to {COARSEST_TESSELLATION:g} m"
        raise BadDimension(f"tolerance {tolerance:g} m is given", valid=valid)
    require("cad", "reading STEP")
    facts = step_facts(data)
    glb = _tessellated(data, tolerance)
    document, binary = chunks(glb)
    facets = facets_of(document, Buffers(document, binary))
    if facets.n_faces < facts.n_faces:
        raise BadSyntax(
            f"{facets.n_faces} of its {facts.n_faces} faces come to facets",
            valid="a file whose faces are all sound",
        )
    off = tolerance + facts.accuracy + _SINGLE * facets.reach
    if facets.off > off:
        raise BadSyntax(
            f"facets are {facets.off * 1e3:.3g} mm off their face, where {off * 1e3:.3g} mm is asked for",
            valid="a larger tolerance, or a file whose edges lie on its faces",
        )
    surface = read_glb(MeshRequest(glb))
    return Triangles(surface.vertices @ Z_FROM_Y_UP, surface.corners, _notes(facets), off)


def _notes(facets: Facets) -> tuple[str, ...]:
    if not facets.n_free:
        return ()
    return (
        f"{facets.n_free} of its {facets.n_faces} faces are free-form: how near facets are to them is the word of "
        "Open CASCADE, asked for twice as fine",
    )


def _tessellated(data: bytes, tolerance: float) -> bytes:
    """The file as GLB, by a process of its own."""
    arguments = [str(0.5e3 * tolerance), str(TURN), str(MOST_WORK)]
    try:
        done = subprocess.run(
            [sys.executable, "-P", str(_PROCESS), *arguments],
            input=data,
            capture_output=True,
            timeout=LONGEST,
            check=True,
        )
    except (subprocess.SubprocessError, OSError) as error:
        code = getattr(error, "returncode", None)
        reason = type(error).__name__ if code is None else f"exit code {code}"
        raise BadSyntax(
            f"Open CASCADE came to no end with it ({reason})", valid="a smaller or a sound file"
        ) from None
    if not done.stdout:
        raise BadSyntax("Open CASCADE cannot read it", valid="a STEP file of AP203, AP214 or AP242")
    return done.stdout
