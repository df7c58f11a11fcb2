"""The adapter of meshcat: a scene in its language, and its viewer, served to any browser that opens the address.

Everything is sent once, before a browser is there; each browser that comes is given all of it, in the same order.
Playing and scrubbing are meshcat's own animation; what jumps to a step is a control of meshcat's viewer. meshcat's
own server is left out: it listens on every address (`server`). Not for: shapes, poses and colours (`playback`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

import meshcat
import meshcat.animation
import meshcat.geometry
import numpy as np
import umsgpack

from clearance.view.server import PageServer

Z_FROM_Y = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
"""Turns meshcat's cylinder, which stands along y, to stand along z."""

_HOLD = 2300
"""three.js `InterpolateDiscrete`: between two frames the first one is shown, never an invented
pose."""


_PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>clearance</title>
<style>body {margin: 0} #meshcat-pane {width: 100vw; height: 100vh; overflow: hidden}</style></head>
<body><div id="meshcat-pane"></div><script src="script.js"></script><script>
var viewer = new MeshCat.Viewer(document.getElementById("meshcat-pane"));
viewer.connect(`ws://${location.host}${location.pathname}scene`);
</script></body></html>
"""


class _HeldTrack(meshcat.animation.AnimationTrack):
    """A track that holds each value until the next."""

    __slots__ = ()

    def lower(self) -> dict:
        return {**super().lower(), "interpolation": _HOLD}


class _Command(Protocol):
    """A command of meshcat's, which knows how its viewer reads it."""

    def lower(self) -> dict: ...


class _Commands:
    """Stands in for meshcat's window: keeps every command as its viewer reads them."""

    def __init__(self) -> None:
        self.packed: list[bytes] = []

    def send(self, command: _Command) -> None:
        self.tell(command.lower())

    def tell(self, command: dict) -> None:
        self.packed.append(umsgpack.packb(command))


POINT = 0.004
"""[m] How large a point of a cloud is drawn, whatever the radius of its ball."""


class LiveScene:
    """A scene, and a server that gives it to browsers."""

    def __init__(self) -> None:
        self._commands = _Commands()
        self._root = meshcat.Visualizer(window=self._commands)
        self._opening = "this.gui.open()"
        self._clips: dict[meshcat.path.Path, meshcat.animation.AnimationClip] = {}
        self._root["/Background"].set_property("top_color", [0.93, 0.945, 0.96])
        self._root["/Background"].set_property("bottom_color", [0.99, 0.99, 0.985])
        self._root["/Axes"].set_property("visible", False)
        self._server: PageServer | None = None

    @property
    def url(self) -> str:
        """The address to open in a browser, once the scene is finished."""
        assert self._server is not None
        return self._server.url

    def mesh(
        self, path: str, vertices: np.ndarray, triangles: np.ndarray, colour: int, opacity: float
    ) -> None:
        """Puts a surface at `path`: (n, 3) [m], (m, 3) vertex indices, colour 0xRRGGBB."""
        material = meshcat.geometry.MeshLambertMaterial(
            color=colour, opacity=opacity, flatShading=True
        )
        self._root[path].set_object(
            meshcat.geometry.TriangularMeshGeometry(vertices, triangles), material
        )

    def points(self, path: str, points: np.ndarray, colour: int) -> None:
        """Puts a cloud of points (n, 3) [m] at `path`."""
        self._root[path].set_object(
            meshcat.geometry.PointsGeometry(points.T),
            meshcat.geometry.PointsMaterial(size=POINT, color=colour),
        )

    def ball(self, path: str, radius: float, colour: int) -> None:
        """Puts a sphere [m] at `path` that is drawn over everything else."""
        self._root[path].set_object(meshcat.geometry.Sphere(radius), _over_all(colour))
        self._last(path)

    def rod(self, path: str, radius: float, colour: int) -> None:
        """Puts a cylinder of unit length along z at `path` that is drawn over everything else."""
        upright = self._root[path]["rod"]
        upright.set_object(meshcat.geometry.Cylinder(1.0, radius), _over_all(colour))
        upright.set_transform(Z_FROM_Y)
        self._last(f"{path}/rod")

    def region(self, path: str, vertices: np.ndarray, triangles: np.ndarray, colour: int) -> None:
        """Puts a surface (n, 3) [m], (m, 3) at `path` that is seen through whatever is before it."""
        material = _over_all(colour)
        material.opacity = 0.5
        self._root[path].set_object(
            meshcat.geometry.TriangularMeshGeometry(vertices, triangles), material
        )
        self._last(path)

    def arrow(
        self, path: str, foot: np.ndarray, tip: np.ndarray, radius: float, colour: int
    ) -> None:
        """Puts an arrow from `foot` to `tip`, both (3,) [m], at `path`, drawn over everything else."""
        length = float(np.linalg.norm(tip - foot))
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = _frame_along((tip - foot) / length), foot
        parts = {
            "shaft": (meshcat.geometry.Cylinder(0.75 * length, radius), 0.375 * length),
            "head": (
                meshcat.geometry.Cylinder(0.25 * length, radiusTop=0.0, radiusBottom=3.0 * radius),
                0.875 * length,
            ),
        }
        for name, (shape, along) in parts.items():
            upright = np.eye(4)
            upright[2, 3] = along
            self._root[path][name].set_object(shape, _over_all(colour))
            self._root[path][name].set_transform(pose @ upright @ Z_FROM_Y)
            self._last(f"{path}/{name}")

    def _last(self, path: str) -> None:
        """Draws what is at `path` after everything else, also after what is transparent and
        nearer."""
        self._root[path]["<object>"].set_property("renderOrder", 10)

    def place(self, path: str, world_from_body: np.ndarray) -> None:
        """Sets the pose (4, 4) [m] of whatever is at `path`."""
        self._root[path].set_transform(world_from_body)

    def animate(
        self, path: str, kind: str, type_: str, times: Sequence[float], values: Sequence
    ) -> None:
        """Adds a track: property `kind` of three.js type `type_`, one value a time [s from the
        start]."""
        clip = self._clips.setdefault(self._root[path].path, meshcat.animation.AnimationClip(fps=1))
        clip.tracks[kind] = _HeldTrack(kind, type_, list(times), list(values))

    def finish(self) -> None:
        """Makes all tracks one animation, which starts at once and repeats, and lets browsers come."""
        self._root.set_animation(meshcat.animation.Animation(self._clips), repetitions=1000)
        script = Path(meshcat.viewer_assets_path(), "dist", "main.min.js").read_bytes()
        self._server = PageServer(_PAGE, script, tuple(self._commands.packed))

    def look(self, target: np.ndarray, eye: np.ndarray) -> None:
        """Puts the camera at `eye` and lets it orbit around `target`, both (3,) [m] in the world.

        To be called before the controls: meshcat has no property for the target, so they set it.
        """
        camera = self._root["/Cameras/default/rotated/<object>"]
        camera.set_property("position", _y_up(eye))
        camera.set_property("fov", 40.0)
        self._opening = f"this.controls.target.set(...{_y_up(target)}), this.gui.open()"

    def button(self, name: str, script: str) -> None:
        """A button in the viewer's panel; `script` is a function in which `this` is meshcat's
        viewer."""
        self._control({"name": name, "callback": f"({self._opening}, {script})"})

    def slider(self, name: str, script: str, n: int) -> None:
        """A slider from 0 to n - 1 in the viewer's panel; `script` is a function of its value."""
        bounds = {"value": 0, "min": 0, "max": n - 1, "step": 1}
        self._control({"name": name, "callback": f"({self._opening}, {script})", **bounds})

    def _control(self, control: dict) -> None:
        """meshcat's viewer knows controls, its Python side does not."""
        self._commands.tell({"type": "set_control", "path": "/clearance", **control})

    def close(self) -> None:
        """Ends the server."""
        if self._server is not None:
            self._server.close()


def _frame_along(direction: np.ndarray) -> np.ndarray:
    """(3, 3) a rotation whose third column is the unit `direction`."""
    aside = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    aside /= np.linalg.norm(aside)
    return np.column_stack([aside, np.cross(direction, aside), direction])


def _y_up(point: np.ndarray) -> list[float]:
    """A point of our world, where z is up, as three.js's camera sees it, where y is up."""
    x, y, z = point.tolist()
    return [x, z, -y]


def _over_all(colour: int) -> meshcat.geometry.Material:
    return meshcat.geometry.MeshBasicMaterial(color=colour, depthTest=False, transparent=True)
