"""The adapter of MuJoCo: an MJCF document to bodies, joints and geoms as MuJoCo compiles them, in plain numbers.

MuJoCo knows the format best (classes of defaults, orders of angles, inferred sizes), but bends meshes: they are
kept in single precision, moved into their frame of inertia, and collide as convex hulls. So it is given a box in
place of each mesh, opens no file, and says where the meshes lie; we read the meshes ourselves (`shapes`).
Not for: what becomes of bodies and joints (`joints`).

Source: MuJoCo, XML reference; Computation, "Kinematics".
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from clearance.errors import BadSyntax
from clearance.extras import importing
from clearance.geometry.pose import inverse, pose_from_quaternion

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


class MjcfMesh(NamedTuple):
    """A mesh as it is written: points p of its file become scale * (turned^-1 (p - moved)).

    Attributes:
        file: as it is written; empty where the surface stands in the document or is made by MuJoCo.
        scale, moved: (3,). turned: (3, 3).
        points, corners: (n, 3) [m] and (m, 3) of a mesh without a file; no corners for the hull of its points.
    """

    file: str
    scale: np.ndarray
    moved: np.ndarray
    turned: np.ndarray
    points: np.ndarray
    corners: np.ndarray

    @property
    def lies_as_in_its_file(self) -> bool:
        """True for one that is at most scaled."""
        return not self.moved.any() and np.array_equal(self.turned, np.eye(3))


class MjcfGeom(NamedTuple):
    """A shape on a body.

    Attributes:
        kind: "box", "sphere", "capsule", "cylinder", "ellipsoid", "plane", "hfield", "mesh" or "sdf".
        size: (3,) half sizes, radius and half length, or semi-axes [m], as MuJoCo has them.
        pose: (4, 4) of the shape, of a mesh as `MjcfMesh` makes it, in the body [m]. mesh: its name.
        contype, conaffinity: bits; two geoms may collide where the first of one meets the second of the other.
        collides: it takes part in contacts. shown: it is of a group that MuJoCo's viewer shows from the start.
    """

    name: str
    kind: str
    body: int
    size: np.ndarray
    pose: np.ndarray
    mesh: str
    contype: int
    conaffinity: int
    collides: bool
    shown: bool


class MjcfJoint(NamedTuple):
    """A joint between a body and its parent; those of one body act in their order.

    Attributes:
        kind: "free", "ball", "slide" or "hinge". place, axis: (3,) in the body.
        reference: the value at which the body is as written [rad or m].
        limits: lower and upper [rad or m]; None without limits.
    """

    name: str
    kind: str
    body: int
    place: np.ndarray
    axis: np.ndarray
    reference: float
    limits: tuple[float, float] | None


class MjcfBody(NamedTuple):
    """A body.

    Attributes:
        parent: the place of its parent; of the world (the first) its own. pose: (4, 4) in it [m].
        welded_to: the place of the topmost body that no joint lies between; its own where it has a joint.
    """

    name: str
    parent: int
    welded_to: int
    pose: np.ndarray
    is_mocap: bool


class MjcfFollower(NamedTuple):
    """A joint whose value is its reference + polynomial(value of `master` - its reference); None: a constant."""

    joint: str
    master: str | None
    polynomial: tuple[float, ...]
    active: bool


class MjcfKey(NamedTuple):
    """A keyframe; `positions`: (n,) of all joints in their order, 7 of a free one, 4 of a ball, 1 of others."""

    name: str
    positions: np.ndarray


@dataclass(frozen=True, eq=False)
class MjcfModel:
    """A compiled model; bodies with parents before children, the world first.

    Attributes:
        excludes: pairs of bodies that do not collide. pairs: of geoms that do, whatever else is said.
        filters_parents: bodies do not collide with their parents.
        reference: (n,) the positions at which the model is written, as `MjcfKey` has them.
    """

    name: str
    bodies: tuple[MjcfBody, ...]
    joints: tuple[MjcfJoint, ...]
    geoms: tuple[MjcfGeom, ...]
    follows: tuple[MjcfFollower, ...]
    excludes: tuple[tuple[str, str], ...]
    pairs: tuple[tuple[int, int], ...]
    filters_parents: bool
    keys: tuple[MjcfKey, ...]
    reference: np.ndarray

    def bearing(self, bodies: Iterable[int]) -> set[int]:
        """The places of some bodies, and of all that they are on."""
        found = {*bodies}
        for i in range(len(self.bodies) - 1, 0, -1):  # parents come first
            found |= {self.bodies[i].parent} if i in found else set()
        return found


_PURPOSE = "reading MJCF"

_STAND_IN = np.array([[x, y, z] for x in (-0.3, 0.3) for y in (-0.4, 0.4) for z in (-0.5, 0.5)])
"""(8, 3) [m] corners of a box of three different sides, whose frame of inertia is its own."""

_NO_CORNERS = np.zeros((0, 3), dtype=np.int64)

_BESIDE_POINTS = ("usernormal", "userfacenormal", "usertexcoord", "userfacetexcoord")
"""What a mesh may have for each point, and not every version of MuJoCo."""

_LAST_SHOWN = 2
"""MuJoCo's viewer shows groups 0, 1 and 2 from the start."""


class MjcfSpec:
    """A parsed model, whose meshes are known and not compiled yet.

    Attributes:
        meshes: by name. fitted: names of those that a box, capsule or the like is fitted to.
        meshdir: folder of the meshes, as it is written. strippath: of their files only the name counts.

    Raises:
        Unavailable: MuJoCo is missing. BadSyntax: what MuJoCo says of the document.
    """

    def __init__(self, root: Element) -> None:
        from lxml import etree

        with importing("mujoco", _PURPOSE):
            import mujoco
        self._mujoco = mujoco
        files = _take_out_files(root)
        with _refused(mujoco):
            self._spec = mujoco.MjSpec.from_string(etree.tostring(root, encoding="unicode"))
        texts = {mesh.get("name"): mesh for mesh in root.iterfind("asset/mesh")}
        self.meshes = {
            mesh.name: _written(mesh, files.get(mesh.name, ""), texts.get(mesh.name))
            for mesh in self._spec.meshes
        }
        self.meshdir, self.strippath = self._spec.meshdir, bool(self._spec.strippath)
        as_mesh = (mujoco.mjtGeom.mjGEOM_MESH, mujoco.mjtGeom.mjGEOM_SDF)
        self.fitted = {
            geom.meshname for geom in self._spec.geoms if geom.meshname and geom.type not in as_mesh
        }

    def model(self, surfaces: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> MjcfModel:
        """The compiled model.

        Args:
            surfaces: vertices (n, 3) [m], as `MjcfMesh` makes them, and triangles (m, 3) of each mesh of `fitted`.

        Raises:
            BadSyntax: what MuJoCo says of the model.
        """
        spec = self._spec
        spec.compiler.discardvisual = spec.compiler.fusestatic = False
        for mesh in spec.meshes:
            mesh.scale, mesh.refpos, mesh.refquat = [1, 1, 1], [0, 0, 0], [1, 0, 0, 0]
            vertices, triangles = surfaces.get(mesh.name, (_STAND_IN, _NO_CORNERS))
            mesh.uservert, mesh.userface = vertices.ravel(), triangles.ravel()
            for attribute in _BESIDE_POINTS:
                if hasattr(mesh, attribute):
                    setattr(mesh, attribute, [])
        with _refused(self._mujoco):
            compiled = spec.compile()
        return _ModelReader(self._mujoco, spec.modelname, compiled).model()


def _take_out_files(root: Element) -> dict[str, str]:
    """The files of the document's meshes by name; a box stands for each in the document."""
    files = {}
    for mesh in root.iterfind("asset/mesh"):
        if mesh.get("file") is not None:
            files[mesh.get("name")] = mesh.attrib.pop("file")
            mesh.attrib.pop("content_type", None)
            mesh.set("vertex", " ".join(map(str, _STAND_IN.ravel().tolist())))
    return files


def _written(mesh: Any, file: str, element: Element | None) -> MjcfMesh:
    """A mesh of the parsed model; its points are the document's own numbers where they stand there."""
    points, corners = (
        np.array(mesh.uservert, dtype=np.float64),
        np.array(mesh.userface, dtype=np.int64),
    )
    if element is not None and element.get("vertex") is not None and not file:
        points = np.array([float(word) for word in element.get("vertex").split()])
    return MjcfMesh(
        file,
        np.array(mesh.scale, dtype=np.float64),
        np.array(mesh.refpos, dtype=np.float64),
        _rotation(mesh.refquat),
        points.reshape(-1, 3),
        corners.reshape(-1, 3),
    )


@contextmanager
def _refused(mujoco: Any) -> Iterator[None]:
    """Turns what MuJoCo says into one line; the lines of the document it counts are not those of the file.

    Its warnings, of masses and the like, would be printed, and written to a file where we are.
    """
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        with warnings.catch_warnings(action="ignore"):
            yield
    except MemoryError:
        raise
    except Exception as error:  # FatalError is no ValueError
        text = re.sub(r",? *\(?line \d+\)?", "", " ".join(str(error).split()))
        raise BadSyntax(f"MuJoCo refuses it: {text.removeprefix('Error: '):.300}") from None
    finally:
        mujoco.set_mju_user_warning(before)


class _ModelReader:
    """Takes a compiled model apart."""

    def __init__(self, mujoco: Any, name: str, compiled: Any) -> None:
        self.mujoco, self.name, self.compiled = mujoco, name, compiled
        self.bodies = [
            compiled.body(i).name or f"body{i}" if i else "world" for i in range(compiled.nbody)
        ]
        self.joints = [self._joint_name(i) for i in range(compiled.njnt)]

    def model(self) -> MjcfModel:
        """All of it."""
        compiled = self.compiled
        pairs = tuple(zip(compiled.pair_geom1.tolist(), compiled.pair_geom2.tolist(), strict=True))
        paired = {geom for pair in pairs for geom in pair}
        return MjcfModel(
            self.name,
            tuple(self._body(i) for i in range(compiled.nbody)),
            tuple(self._joint(i) for i in range(compiled.njnt)),
            tuple(self._geom(i, i in paired) for i in range(compiled.ngeom)),
            tuple(self._follows(i) for i in range(compiled.neq)),
            tuple(
                (self.bodies[pair >> 16], self.bodies[pair & 0xFFFF])
                for pair in compiled.exclude_signature.tolist()
            ),
            pairs,
            not compiled.opt.disableflags & self.mujoco.mjtDisableBit.mjDSBL_FILTERPARENT,
            tuple(
                MjcfKey(compiled.key(i).name or f"key{i}", compiled.key_qpos[i].copy())
                for i in range(compiled.nkey)
            ),
            compiled.qpos0.copy(),
        )

    def _joint_name(self, i: int) -> str:
        compiled = self.compiled
        body = int(compiled.jnt_bodyid[i])
        place = i - int(compiled.body_jntadr[body])
        many = int(compiled.body_jntnum[body]) > 1
        return compiled.joint(i).name or f"{self.bodies[body]}/joint{place if many else ''}"

    def _body(self, i: int) -> MjcfBody:
        compiled = self.compiled
        return MjcfBody(
            self.bodies[i],
            int(compiled.body_parentid[i]),
            int(compiled.body_weldid[i]),
            _pose(compiled.body_pos[i], compiled.body_quat[i]),
            bool(compiled.body_mocapid[i] >= 0),
        )

    def _joint(self, i: int) -> MjcfJoint:
        compiled = self.compiled
        kind = self._kind(self.mujoco.mjtJoint, compiled.jnt_type[i])
        one = kind in ("hinge", "slide")
        lower, upper = compiled.jnt_range[i].tolist()
        return MjcfJoint(
            self.joints[i],
            kind,
            int(compiled.jnt_bodyid[i]),
            compiled.jnt_pos[i].copy(),
            compiled.jnt_axis[i].copy(),
            float(compiled.qpos0[compiled.jnt_qposadr[i]]) if one else 0.0,
            (lower, upper) if one and compiled.jnt_limited[i] else None,
        )

    def _geom(self, i: int, is_paired: bool) -> MjcfGeom:
        compiled = self.compiled
        kind = self._kind(self.mujoco.mjtGeom, compiled.geom_type[i])
        pose, mesh = _pose(compiled.geom_pos[i], compiled.geom_quat[i]), ""
        if kind == "mesh":
            i_mesh = int(compiled.geom_dataid[i])
            mesh = compiled.mesh(i_mesh).name
            pose = pose @ inverse(_pose(compiled.mesh_pos[i_mesh], compiled.mesh_quat[i_mesh]))
        body = int(compiled.geom_bodyid[i])
        bits = int(compiled.geom_contype[i]), int(compiled.geom_conaffinity[i])
        return MjcfGeom(
            compiled.geom(i).name or f"geom{i - int(compiled.body_geomadr[body])}",
            kind, body, compiled.geom_size[i].copy(), pose, mesh, *bits, any(bits) or is_paired,
            0 <= compiled.geom_group[i] <= _LAST_SHOWN,
        )  # fmt: skip

    def _follows(self, i: int) -> MjcfFollower:
        compiled = self.compiled
        one, other = int(compiled.eq_obj1id[i]), int(compiled.eq_obj2id[i])
        return MjcfFollower(
            self.joints[one],
            self.joints[other] if other >= 0 else None,
            tuple(compiled.eq_data[i, :5].tolist()),
            bool(compiled.eq_active0[i]),
        )

    def _kind(self, kinds: Any, number: int) -> str:
        return kinds(int(number)).name.partition("_")[2].lower()


def _pose(place: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = _rotation(quaternion), place
    return pose


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    """(3, 3) of a quaternion of any length, the scalar first."""
    w, x, y, z = np.array(quaternion, dtype=np.float64) / np.linalg.norm(quaternion)
    return pose_from_quaternion([0.0, 0.0, 0.0], [x, y, z, w])[:3, :3]
