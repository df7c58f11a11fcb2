"""How close a robot's path comes to anything, where, when, and how sure that is.

The public names; each is imported from its room when it is first used.
"""

from importlib import import_module
from typing import Any

from clearance.geometry.file_reader import attach_file_reader

__version__ = "0.2.0"

_ROOM_OF = {
    "BadInput": "errors",
    "Body": "world.body",
    "Case": "world.case",
    "Checker": "simulate.checker",
    "ClearanceError": "errors",
    "Contact": "query.contact",
    "CrossCheck": "simulate.record",
    "Curve": "planar.curve",
    "Fit": "profiles.fit",
    "Intersection": "query.intersection",
    "Limits": "world.case",
    "Nearest": "query.result",
    "Obstacle": "world.body",
    "PlacedRobot": "world.case",
    "Polyhedron": "geometry.polyhedron",
    "Polytope": "geometry.polytope",
    "Profile": "profiles.profile",
    "Query": "query.pair_query",
    "Record": "simulate.record",
    "Robot": "world.robot",
    "Run": "run",
    "Sketch": "sketch",
    "SketchResult": "sketch",
    "Trajectory": "world.trajectory",
    "Undecided": "planar.hausdorff",
    "Workspace": "simulate.workspace",
    "biarcs": "planar.biarcs",
    "box": "geometry.shapes",
    "capsule": "geometry.shapes",
    "check": "run",
    "common_point": "query.common_point",
    "common_point_paper": "query.common_point_paper",
    "contact": "query.contact",
    "cylinder": "geometry.shapes",
    "deviation": "planar.deviation",
    "distance": "query.distance",
    "fit": "profiles.fit",
    "hausdorff": "planar.hausdorff",
    "intersect": "query.intersection",
    "load_case": "load.case_file",
    "load_urdf": "load.urdf",
    "minimum_distance": "planar.minimum",
    "penetration": "query.penetration",
    "pipe": "geometry.shapes",
    "polygon_distance": "query.distance",
    "polygon_distances": "query.distance",
    "read_mesh": "load.mesh",
    "shared_workspace": "simulate.workspace",
    "sphere": "geometry.shapes",
    "swept_profile": "profiles.sweep",
    "within": "planar.hausdorff",
}

__all__ = sorted(["__version__", *_ROOM_OF])


def __getattr__(name: str) -> Any:
    if name not in _ROOM_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_ROOM_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__


def _read_mesh(path, scale=1.0):
    return import_module(f"{__name__}.load.mesh").read_mesh(path, scale)


attach_file_reader(_read_mesh)
