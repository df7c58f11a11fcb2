"""A picture of a shared workspace: the robots as shaded solids at three moments, the region over them in red.

Drawn as SVG by sorting faces by depth (the painter's way), because a picture of some thousand flat faces needs
no more. Not for: turning it round (the GLB file is).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from markupsafe import escape

from clearance.geometry.polytope import Polytope
from clearance.record.wording import litres
from clearance.record.workspace import Workspace
from clearance.world.extents import own_floor

WIDTH, HEIGHT, MARGIN = 1000.0, 720.0, 40.0
COLOURS = ((92, 115, 144), (199, 125, 10), (43, 122, 75), (120, 80, 150))
REGION = (224, 16, 16)
LIFT = np.radians(24.0)
LIGHT = np.array([0.3, -0.5, 0.81])


def picture_of(workspace: Workspace) -> str:
    """The SVG text; the same workspace gives the same text."""
    axes = _axes(workspace)
    robots = list(_robot_faces(workspace))
    region = workspace.region.vertices[workspace.region.triangles]
    everything = np.concatenate([*(face for face, _ in robots), *region]) @ axes.T
    low, high = everything.min(axis=0)[:2], everything.max(axis=0)[:2]
    scale = float(
        min((WIDTH - 2 * MARGIN) / (high - low)[0], (HEIGHT - 2 * MARGIN - 40) / (high - low)[1])
    )
    middle = 0.5 * (low + high)

    def polygon(
        face: np.ndarray, colour: tuple[int, int, int], opacity: float
    ) -> tuple[float, str]:
        seen = face @ axes.T
        x = WIDTH / 2 + scale * (seen[:, 0] - middle[0])
        y = HEIGHT / 2 + 20 - scale * (seen[:, 1] - middle[1])
        corners = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        shade = _shade(face, colour)
        text = f'<polygon points="{corners}" fill="{shade}" stroke="{shade}" fill-opacity="{opacity}"/>'
        return float(seen[:, 2].mean()), text

    solid = [polygon(face, colour, 1.0) for face, colour in robots if _faces_us(face, axes)]
    shared = [polygon(face, REGION, 0.5) for face in region if _faces_us(face, axes)]
    drawn = [text for group in (solid, shared) for _, text in sorted(group)]
    return "\n".join([_head(), *drawn, *_words(workspace, scale), "</svg>"]) + "\n"


def _axes(workspace: Workspace) -> np.ndarray:
    """(3, 3) rows right, up, towards us: from the side of the line between the first two robots."""
    feet = [robot.poses(0)[0, :3, 3] for robot in workspace.robots]
    along = (feet[1] - feet[0]) * [1.0, 1.0, 0.0]
    length = np.linalg.norm(along)
    along = along / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])
    turn = np.radians(20.0)
    right = np.array(
        [
            np.cos(turn) * along[0] - np.sin(turn) * along[1],
            np.sin(turn) * along[0] + np.cos(turn) * along[1],
            0.0,
        ]
    )
    back = np.cross(right, [0.0, 0.0, 1.0])
    towards = np.cos(LIFT) * back + [0.0, 0.0, np.sin(LIFT)]
    return np.array([right, np.cross(towards, right), towards])


def _robot_faces(workspace: Workspace) -> Iterator[tuple[np.ndarray, tuple[int, int, int]]]:
    """The faces (k, 3) [m] of the hulls of all links at the first, middle and last step, paler and paler."""
    for i, one in enumerate(workspace.robots):
        robot = one.placed.robot
        hulls = {
            body.name: Polytope(body.shape.vertices[np.unique(body.shape.face_vertices)])
            for body in robot.bodies
            if body.name != own_floor(one.placed)
        }
        for paler, step in enumerate(sorted({0, one.n_steps // 2, one.n_steps - 1})):
            poses = one.poses(step)
            r, g, b = (int(c + (255 - c) * 0.28 * paler) for c in COLOURS[i % len(COLOURS)])
            for name, hull in hulls.items():
                pose = poses[robot.link_names.index(name)]
                for k in range(hull.n_faces):
                    yield hull.face(k) @ pose[:3, :3].T + pose[:3, 3], (r, g, b)


def _normal(face: np.ndarray) -> np.ndarray:
    normal = np.cross(face[1] - face[0], face[2] - face[0])
    return normal / max(float(np.linalg.norm(normal)), 1e-300)


def _faces_us(face: np.ndarray, axes: np.ndarray) -> bool:
    return bool(_normal(face) @ axes[2] > 0.0)


def _shade(face: np.ndarray, colour: tuple[int, int, int]) -> str:
    light = 0.62 + 0.38 * max(0.0, float(_normal(face) @ LIGHT))
    return f"rgb({','.join(str(int(part * light)) for part in colour)})"


def _head() -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" '
        f'width="{WIDTH:.0f}" height="{HEIGHT:.0f}" font-family="sans-serif" stroke-width="0.6" '
        'stroke-linejoin="round"><rect width="100%" height="100%" fill="#fbfaf7"/>'
    )


def _words(workspace: Workspace, scale: float) -> Iterator[str]:
    said = f"Shared workspace: at most {litres(workspace.volume)} litres"
    yield f'<text x="{MARGIN}" y="38" font-size="22" fill="#17202b">{said}</text>'
    for i, name in enumerate(workspace.names):
        r, g, b = COLOURS[i % len(COLOURS)]
        y = 64 + 20 * i
        yield f'<rect x="{MARGIN}" y="{y - 11}" width="12" height="12" fill="rgb({r},{g},{b})"/>'
        yield f'<text x="{MARGIN + 20}" y="{y}" font-size="14" fill="#4a5664">{escape(name)}</text>'
    bar = 10.0 ** np.floor(np.log10(200.0 / scale))
    end = MARGIN + bar * scale
    foot = HEIGHT - 24
    yield f'<path d="M{MARGIN} {foot}H{end:.1f}" stroke="#17202b" stroke-width="2"/>'
    yield f'<text x="{end + 8:.1f}" y="{foot + 5}" font-size="13" fill="#4a5664">{bar:g} m</text>'
