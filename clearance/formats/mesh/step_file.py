"""STEP to triangles: facets that Open CASCADE makes, and how far they may be off the surfaces of the file.

Corners of facets lie on the surface, so facets cut through what is round and span what is hollow: the bound holds
either way, and a case takes it off the clearance (`Polyhedron.shortfall`). What cannot be proven of the facets is
asked for twice as fine as it is counted.

Source: Open CASCADE, BRepMesh_IncrementalMesh (linear and angular deflection), RWGltf (metres, single precision).
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import BadDimension, BadSyntax
from clearance.extras import require
from clearance.formats.mesh.gltf_buffers import Buffers, GltfObject
from clearance.formats.mesh.gltf_file import chunks, mesh_pieces, read_glb
from clearance.formats.mesh.placing import Z_FROM_Y_UP
from clearance.formats.mesh.step_text import StepFacts, step_facts
from clearance.formats.mesh.triangles import MeshRequest, Triangles
from clearance.formats.text.notes import counted
from clearance.tolerance import COARSEST_TESSELLATION, FINEST_TESSELLATION
from clearance.world.notice import listed

_PROCESS = Path(__file__).with_name("step_process.py")

MOST_WORK, LONGEST = 300, 1800
"""[s] of processor time, and of time, for a file."""

TURN = 0.5
"""[rad] Neighbouring facets of a round face turn no farther, however small it is."""

_COLOURS = (b"STYLED_ITEM", b"UNREAD_ITEM")
"""Faces of other colours than their solid's come without what is known of them, so none has a colour."""

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
    glb = _tessellated(data.replace(*_COLOURS), tolerance)
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
    return Triangles(
        surface.vertices @ Z_FROM_Y_UP, surface.corners, tuple(_notes(facts, facets)), off
    )


def _notes(facts: StepFacts, facets: Facets) -> Iterator[str]:
    if facts.n_lines:
        yield f"{counted(facts.n_lines, 'set')} of curves, which have no surface: not measured"
    if facts.bare:
        parts = counted(len(facts.bare), "part")
        yield f"{parts} of its assembly without a shape in the file: not measured: {listed(facts.bare)}"
    if facets.n_free:
        yield (
            f"{facets.n_free} of its {facets.n_faces} faces are free-form: how near facets are to them is the "
            "word of Open CASCADE, asked for twice as fine"
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


_EXTENSION = "TM_brep_faces"

_STEPS = 4
"""A triangle is looked at in 15 points: its corners, and where each side is cut into four."""


class Facets(NamedTuple):
    """What is known of the facets of a file.

    Attributes:
        n_faces: faces that have a triangle. n_free: those of them that are of no known kind.
        off: [m] the farthest that a point of a triangle was found from its face.
        reach: [m] the largest coordinate.
    """

    n_faces: int
    n_free: int
    off: float
    reach: float


def facets_of(document: GltfObject, buffers: Buffers) -> Facets:
    """What is known of the facets in a GLB document with faces.

    Raises:
        BadSyntax: a face without a triangle, or triangles of no face.
    """
    found = [Facets(0, 0, 0.0, 0.0)]
    for i in range(len(document.items("meshes"))):
        mesh = document.item("meshes", i)
        pieces = mesh_pieces(mesh, None, buffers)
        for k, piece in enumerate(pieces):
            found.append(
                _of_piece(mesh.item("primitives", k), piece.vertices, piece.corners, buffers)
            )
    n_faces, n_free, off, reach = zip(*found, strict=True)
    return Facets(sum(n_faces), sum(n_free), max(off), max(reach))


def _of_piece(
    primitive: GltfObject, vertices: np.ndarray, corners: np.ndarray, buffers: Buffers
) -> Facets:
    known = primitive.object("extensions").object(_EXTENSION)
    faces = known.items("faces")
    of_face = buffers.read(known.index("faceIndices"), 1)[:, 0].astype(np.int64)
    if len(of_face) != len(corners) or (of_face >= len(faces)).any():
        raise BadSyntax("triangles of no face", valid="a face for each triangle")
    order = np.argsort(of_face, kind="stable")
    ends = np.searchsorted(of_face[order], np.arange(len(faces) + 1))
    n_free, off = 0, 0.0
    for i, face in enumerate(faces):
        own = order[ends[i] : ends[i + 1]]
        if not len(own):
            raise BadSyntax(f"face {i} of {len(faces)} has no facets", valid="a face that is sound")
        kind = face.get("type") if isinstance(face, dict) else None
        if kind not in _DISTANCES:
            n_free += 1
            continue
        points = _lattice(vertices[corners[own]])
        off = max(off, float(np.abs(_DISTANCES[kind](GltfObject(face, f"face {i}"), points)).max()))
    return Facets(len(faces), n_free, off, float(np.abs(vertices).max()))


def _lattice(triangles: np.ndarray) -> np.ndarray:
    """(n, 3) points of (m, 3, 3) triangles."""
    shares = [
        (i / _STEPS, k / _STEPS, (_STEPS - i - k) / _STEPS)
        for i in range(_STEPS + 1)
        for k in range(_STEPS + 1 - i)
    ]
    return np.einsum("pc,mcx->mpx", np.array(shares), triangles).reshape(-1, 3)


def _from_plane(face: GltfObject, points: np.ndarray) -> np.ndarray:
    return (points - face.numbers("origin", (), 3)) @ _unit(face, "normal")


def _from_cylinder(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, _ = _about(face, "origin", points)
    return across - _length(face, "radius")


def _from_cone(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, along = _about(face, "apex", points)
    angle = abs(_length(face, "semi_angle"))
    return across * np.cos(angle) - np.abs(along) * np.sin(angle)


def _from_sphere(face: GltfObject, points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points - face.numbers("center", (), 3), axis=1) - _length(face, "radius")


def _from_torus(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, along = _about(face, "center", points)
    return np.hypot(across - _length(face, "major_radius"), along) - _length(face, "minor_radius")


_DISTANCES: dict[str, Callable[[GltfObject, np.ndarray], np.ndarray]] = {
    "plane": _from_plane,
    "cylinder": _from_cylinder,
    "cone": _from_cone,
    "sphere": _from_sphere,
    "torus": _from_torus,
}
"""[m] the distances of points from a face's surface, inside or outside, by its kind."""


def _about(face: GltfObject, centre: str, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of points from the axis, and along it."""
    axis = _unit(face, "axis")
    seen = points - face.numbers(centre, (), 3)
    along = seen @ axis
    return np.linalg.norm(seen - along[:, None] * axis, axis=1), along


def _unit(face: GltfObject, key: str) -> np.ndarray:
    vector = face.numbers(key, (), 3)
    return vector / np.linalg.norm(vector)


def _length(face: GltfObject, key: str) -> float:
    return float(GltfObject({key: [face.value.get(key)]}, face.place).numbers(key, (), 1)[0])
