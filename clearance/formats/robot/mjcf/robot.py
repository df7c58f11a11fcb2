"""MJCF to a robot: one body for each body of the model that has a shape, in the body's frame; and the pairs of
bodies that the model filters from collision, with a reason each.

MuJoCo tests two geoms if a `<pair>` names them. Else it tests them if no `<exclude>` names their bodies,
neither body is the parent of the other, and the bits of contype and conaffinity meet. Bodies welded together
count as one; a body welded to the world is no parent. Not for: what the pairs do (`world.self_pairs`); where
the robot stands, or how it moves; models that are scenes (`scene.mjcf`).

Source: MuJoCo, Computation, "Collision detection: selection"; engine_collision_driver.c (`filterBodyPair`).
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from clearance.errors import at
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.compound_joints import notes_on_parts
from clearance.formats.robot.mjcf.document import MjcfDocument, mjcf_document
from clearance.formats.robot.mjcf.joints import joints_of, reference_of, states_of, with_followers
from clearance.formats.robot.mjcf.mujoco_adapter import MjcfGeom, MjcfModel
from clearance.formats.robot.mjcf.shapes import MjcfShapes, compiled
from clearance.formats.robot.request import Geometry, RobotRequest
from clearance.formats.robot.shape_kinds import (
    chosen_kind,
    note_on_planes,
    notes_on_bare,
    refuse_other_geometry,
    unseen,
)
from clearance.formats.robot.tree import links_from_root
from clearance.formats.text.notes import counted
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from clearance.world.collision_matrix import ADJACENT, PARENT, CollisionMatrix
from clearance.world.names import checked_name, require_own_names
from clearance.world.notice import Notice, Severity, naming
from clearance.world.robot import WORLD_LINK, Robot
from clearance.world.self_pairs import neighbours


def read_mjcf(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in an MJCF file; its root link is the world, to which the model's own static geoms belong.

    Raises:
        BadInput: with the file and the body, joint, geom or mesh. Unavailable: MuJoCo is not installed.
        NothingToMeasure: no body has a shape of the kind that is asked for, though there are others.
    """
    with at(meshes.files.shown(request.path)):
        document = mjcf_document(request.path, meshes.files)
        model, shapes = compiled(document, request.package_dirs, meshes)
        names = [body.name for body in model.bodies]
        known = frozenset(names)
        joints, notes, notices = with_followers(joints_of(model), model)
        frames = [joint.child for joint in joints if joint.child not in known]
        require_own_names("link", [*names, *frames])
        checked_name(model.name)
        link_names, ordered = links_from_root((*names, *frames), joints)
        kinds = _kinds(model)
        refuse_other_geometry(kinds, request.geometry)
        measured = _measured(model, kinds, request.geometry)
        bodies = [_body(name, measured[name], shapes) for name in link_names if measured.get(name)]
    lines = [*notes, *notes_on_parts(ordered), *_notes(model, kinds, measured)]
    robot = Robot(
        model.name or "robot",
        link_names,
        ordered,
        tuple(bodies),
        (),
        (*notices, *_notices(document, model, measured), *unseen(kinds, request.geometry)),
        states=states_of(model),
        reference=reference_of(model),
    )
    filters = _filters(model, kinds, request.geometry, robot)
    lines = [f"{request.path.name}: {note}" for note in (*lines, *filters.notes())]
    return replace(robot, notes=(*shapes.notes(), *lines), own_matrix=filters.matrix)


def _filters(
    model: MjcfModel, kinds: dict[str, frozenset[str]], geometry: Geometry, robot: Robot
) -> MjcfFilters:
    """What keeps bodies from colliding; one that has planes alone is among those that collide."""
    names = [body.name for body in robot.bodies]
    plane = frozenset({"collision"})
    chosen = {name: chosen_kind(kinds.get(name) or plane, geometry) for name in names}
    colliding = frozenset(name for name in names if chosen[name] == "collision")
    return MjcfFilters(model, frozenset(names), colliding, neighbours(robot))


def _notices(
    document: MjcfDocument, model: MjcfModel, measured: dict[str, list[MjcfGeom]]
) -> list[Notice]:
    """Warnings on what moves bodies, or holds them together, in MuJoCo and not here."""
    found = []
    if document.left_out:
        counts = ", ".join(f"{n} {tag}" for tag, n in document.left_out.items())
        found.append(
            f"equalities that close loops are not followed ({counts}): the trajectory, or joints, must "
            "give every joint of the loop its value"
        )
    bearing = model.bearing(i for i, one in enumerate(model.bodies) if measured.get(one.name))
    moving = [repr(model.bodies[i].name) for i in sorted(bearing) if model.bodies[i].is_mocap]
    found += naming("mocap bodies stand where the file has them", moving)
    return [Notice(Severity.WARNING, "equality", text) for text in found]


def _kinds(model: MjcfModel) -> dict[str, frozenset[str]]:
    return {
        name: frozenset(
            kind for kind in ("collision", "visual") if any(_is(geom, kind) for geom in geoms)
        )
        for name, geoms in _by_body(model).items()
        if name != WORLD_LINK or geoms
    }


def _measured(
    model: MjcfModel, kinds: dict[str, frozenset[str]], geometry: Geometry
) -> dict[str, list[MjcfGeom]]:
    """The geoms of each body that are of the kind that is asked for, and planes that collide."""
    found = {
        name: [geom for geom in geoms if _is(geom, chosen_kind(kinds[name], geometry))]
        for name, geoms in _by_body(model).items()
    }
    for geom in _planes(model):
        found[model.bodies[geom.body].name].append(geom)
    return found


def _planes(model: MjcfModel) -> list[MjcfGeom]:
    return [geom for geom in model.geoms if geom.kind == "plane" and geom.collides]


def _is(geom: MjcfGeom, kind: str) -> bool:
    return geom.collides if kind == "collision" else geom.shown


def _by_body(model: MjcfModel) -> dict[str, list[MjcfGeom]]:
    """The geoms of each body in their order, planes left out."""
    found: dict[str, list[MjcfGeom]] = {body.name: [] for body in model.bodies}
    for geom in model.geoms:
        if geom.kind != "plane":
            found[model.bodies[geom.body].name].append(geom)
    return found


def _body(name: str, geoms: Sequence[MjcfGeom], shapes: MjcfShapes) -> Body:
    made = []
    for geom in geoms:
        with at(f"body {name!r}"):
            made.append(shapes.shape(geom))
    return Body(
        name, Polyhedron.merged([shape for shape, _ in made]), ", ".join(o for _, o in made)
    )


def _notes(
    model: MjcfModel,
    kinds: dict[str, frozenset[str]],
    measured: dict[str, list[MjcfGeom]],
) -> list[str]:
    """What was taken for what."""
    notes = []
    if measured.get(WORLD_LINK):
        of = "of the world itself stand"
        what = counted(len(measured[WORLD_LINK]), f"geom {of}s", f"geoms {of}")
        text = f"{what} with the robot, as its link {WORLD_LINK!r}"
        notes.append(f"{text}; self_clearance: true measures the other links against it")
    notes += note_on_planes([geom.name for geom in _planes(model)])
    kinds_of_geoms = Counter(
        "collide"
        if geom.collides
        else "are only seen"
        if geom.shown
        else "are hidden and collide with nothing"
        for geom in model.geoms
        if geom.kind != "plane"
    )
    notes += naming("geoms", [f"{n} {what}" for what, n in sorted(kinds_of_geoms.items())])
    free, limited = (
        [joint.name for joint in model.joints if joint.kind == kind] for kind in ("free", "ball")
    )
    return [
        *notes,
        *naming("the values of free joints are places in the model's world", free),
        *naming("limits of ball joints are not checked", limited),
        *notes_on_bare(kinds),
    ]


EXCLUDE = "<exclude> in the model"
BITS = "contype and conaffinity"
"""Reasons why MuJoCo does not test two bodies, beside being neighbours on one joint."""


@dataclass(frozen=True, eq=False)
class MjcfFilters:
    """What keeps the bodies of a model from colliding.

    Args:
        measured: bodies with a shape.
        colliding: those of them whose shape consists of geoms that collide; bits do not filter the others.
        neighbours: pairs of bodies that one joint joins.
    """

    model: MjcfModel
    measured: frozenset[str]
    colliding: frozenset[str]
    neighbours: frozenset[frozenset[str]]

    @cached_property
    def rows(self) -> tuple[tuple[str, str, str], ...]:
        """Pairs of bodies with a shape that MuJoCo does not test, and why."""
        bodies = self.model.bodies
        return tuple(
            (bodies[a].name, bodies[b].name, reason)
            for a, b in itertools.combinations(self._geoms, 2)
            if bodies[a].welded_to != bodies[b].welded_to and (reason := self._reason(a, b))
        )

    @property
    def matrix(self) -> CollisionMatrix:
        """The rows as an SRDF has them."""
        return CollisionMatrix(disabled=self.rows)

    def notes(self) -> Iterator[str]:
        """A line for each filter that leaves out more than neighbours, and for pairs of `<pair>`."""
        for reason in (EXCLUDE, PARENT, BITS):
            pairs = [f"{a} - {b}" for a, b, why in self.rows if why == reason]
            yield from naming(f"self_clearance without srdf leaves out ({reason})", pairs)
        bodies = self.model.bodies
        pairs = [f"{bodies[a].name} - {bodies[b].name}" for a, b in sorted(self._asked_for)]
        yield from naming("self_clearance without srdf measures, as <pair> says", pairs)

    @cached_property
    def _geoms(self) -> dict[int, list[MjcfGeom]]:
        """The geoms of each body that has a shape."""
        found: dict[int, list[MjcfGeom]] = {}
        for geom in self.model.geoms:
            if self.model.bodies[geom.body].name in self.measured:
                found.setdefault(geom.body, []).append(geom)
        return dict(sorted(found.items()))

    @cached_property
    def _asked_for(self) -> frozenset[tuple[int, int]]:
        ends = ([self.model.geoms[i].body for i in pair] for pair in self.model.pairs)
        return frozenset((min(one), max(one)) for one in ends)

    @cached_property
    def _excluded(self) -> frozenset[frozenset[str]]:
        return frozenset(map(frozenset, self.model.excludes))

    def _reason(self, a: int, b: int) -> str | None:
        bodies = self.model.bodies
        names = frozenset((bodies[a].name, bodies[b].name))
        if (a, b) in self._asked_for:
            return None
        if names in self._excluded:
            return EXCLUDE
        if self.model.filters_parents and self._is_parent(a, b):
            return ADJACENT if names in self.neighbours else PARENT
        if names <= self.colliding and not self._bits_meet(a, b):
            return BITS
        return None

    def _is_parent(self, a: int, b: int) -> bool:
        """True if one is the parent of the other, welded bodies counting as one; the world is no parent."""
        bodies = self.model.bodies
        one, other = bodies[a].welded_to, bodies[b].welded_to
        parents = [bodies[bodies[end].parent].welded_to for end in (one, other)]
        return 0 not in (one, other) and (one == parents[1] or other == parents[0])

    def _bits_meet(self, a: int, b: int) -> bool:
        """True if two of their geoms may collide."""
        return any(
            one.contype & other.conaffinity or other.contype & one.conaffinity
            for one, other in itertools.product(self._geoms[a], self._geoms[b])
        )
