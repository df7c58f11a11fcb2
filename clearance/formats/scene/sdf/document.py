"""The `<sdf>` element of a document, and the texts in it, each fault with its element. Not for: what they mean."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadScene, BadSyntax, MissingKey
from clearance.formats.text.numbers import finite_numbers
from clearance.formats.text.unread import ANY, Format, Row, Unread, unread
from clearance.formats.text.xml_document import plain_root
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import of_unit_length
from clearance.world.names import checked_name

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

NEWEST = (1, 11)
"""The newest version of SDF that is read."""

_TEXT = Row(has_text=True, closed=True)

_SDF = Format(
    {
        **dict.fromkeys(("sdf", "gazebo"), Row("world model", "version", "actor light")),
        "world": Row(
            "model include frame joint state population",
            "name",
            "audio wind gravity magnetic_field atmosphere gui physics scene light road plugin actor "
            "spherical_coordinates",
        ),
        "model": Row(
            "model link include frame joint pose",
            "name placement_frame",
            "canonical_link static self_collide allow_auto_disable enable_wind plugin gripper",
        ),
        "link": Row(
            "collision visual pose",
            "name",
            "gravity enable_wind self_collide kinematic must_be_base_link velocity_decay inertial sensor light "
            "projector audio_sink audio_source battery particle_emitter plugin",
        ),
        "collision": Row(
            "pose geometry",
            "name",
            "laser_retro max_contacts surface density auto_inertia_params proximity_properties",
        ),
        "include": Row("uri name pose placement_frame", "merge", "static plugin"),
        "frame": Row("pose", "name attached_to"),
        "joint": Row(
            "child pose",
            "name type",
            "parent axis axis2 physics sensor screw_thread_pitch thread_pitch gearbox_ratio "
            "gearbox_reference_body",
        ),
        "geometry": Row(ANY),
        "mesh": Row(
            "uri scale submesh",
            passed="optimization convex_decomposition declare_convex",
            closed=True,
        ),
        "plane": Row("normal", passed="size", closed=True),
        "box": Row("size", closed=True),
        "sphere": Row("radius", closed=True),
        "ellipsoid": Row("radii", closed=True),
        **dict.fromkeys(("cylinder", "capsule"), Row("radius length", closed=True)),
        "pose": Row("", "relative_to frame rotation_format degrees", has_text=True, closed=True),
        **dict.fromkeys("uri name placement_frame child".split(), _TEXT),
        **dict.fromkeys("scale normal size radius radii length".split(), _TEXT),
    },
    fault=BadScene,
)
"""Source: SDF specification 1.11. A `<visual>` is counted; a `<state>` is compared."""

MOST_BYTES = 32_000_000
"""Files are text of links and names; meshes lie beside them."""


def sdf_element(data: bytes) -> tuple[Element, list[Unread]]:
    """The root element of an SDF document, without comments and entities; and what is in it beside what is read.

    Raises:
        BadSyntax: not XML, not SDF, an entity or a document type, or too long. BadInput: a newer version; a name
            or text that is not read and may give a shape or a place.
    """
    if len(data) > MOST_BYTES:
        raise BadSyntax(f"{len(data)} bytes are given", valid=f"{MOST_BYTES} or fewer")
    root = plain_root(_as_gazebo_reads(data), "an SDF file")
    if root.tag not in ("sdf", "gazebo"):
        raise BadSyntax(f"the root element is <{root.tag}>", valid="<sdf> is needed")
    _require_version(root.get("version") or "")
    found = [*unread(root, _SDF)]
    for element in root.iter("model", "link", "collision", "include", "frame", "joint"):
        for tag in ("pose", "geometry"):
            if len(element.findall(tag)) > 1:
                where = f"{element.tag} {element.get('name')!r}"
                raise BadScene(f"two <{tag}> are given", where=where, valid="one")
    return root, found


_COMMENT = re.compile(rb"<!\[CDATA\[.*?\]\]>|<!--.*?-->", re.DOTALL)
_PREFIX = re.compile(rb"[<\s]([A-Za-z_]\w*):\w")
_DECLARED = re.compile(rb"xmlns:(\w+)\s*=")
_ROOT = re.compile(rb"<(?:sdf|gazebo)(?=[\s>])")


def _as_gazebo_reads(data: bytes) -> bytes:
    """The document as XML: Gazebo takes two hyphens in a comment, and prefixes as `gz:` that nothing declares."""
    plain = _COMMENT.sub(
        lambda found: found[0] if found[0][:3] == b"<![" else b"\n" * found[0].count(b"\n"), data
    )
    prefixes = {*_PREFIX.findall(plain)} - {*_DECLARED.findall(plain), b"xml", b"xmlns"}
    declared = b"".join(b' xmlns:%b="%b"' % (prefix, prefix) for prefix in sorted(prefixes))
    return _ROOT.sub(lambda found: found[0] + declared, plain, count=1)


def name_of(element: Element) -> str:
    """The name of an element.

    Raises:
        MissingKey: none. BadInput: a name that no table can show.
    """
    name = element.get("name")
    if not name:
        raise MissingKey(f"<{element.tag}> has no name", valid='name="…"')
    return checked_name(name)


def text_of(element: Element, tag: str, default: str | None = None) -> str:
    """The text of a child.

    Raises:
        MissingKey: there is none, and no default.
    """
    child = element.find(tag)
    text = "" if child is None else (child.text or "").strip()
    if text:
        return text
    if default is None:
        raise MissingKey(f"<{element.tag}> has no <{tag}>", valid=f"<{tag}>…</{tag}>")
    return default


def numbers_of(element: Element, tag: str, n: int, default: str | None = None) -> tuple[float, ...]:
    """The `n` finite numbers in a child.

    Raises:
        MissingKey, BadShape, NotFinite: there is no child, or not such numbers.
    """
    return _numbers(text_of(element, tag, default), n, tag)


def pose_of(element: Element) -> np.ndarray:
    """The (4, 4) pose [m] in an element's `<pose>`; the identity where it has none.

    Raises:
        BadShape, NotFinite, BadPose: no pose. BadInput: a way to write rotations that SDF does not have.
    """
    pose = element.find("pose")
    if pose is None or not (pose.text or "").strip():
        return np.eye(4)
    kind = pose.get("rotation_format") or "euler_rpy"
    if kind not in ("euler_rpy", "quat_xyzw"):
        raise BadScene(f"rotation_format={kind!r:.60}", valid="euler_rpy or quat_xyzw")
    values = _numbers(pose.text, 6 if kind == "euler_rpy" else 7, "pose")
    if kind == "quat_xyzw":
        return pose_from_quaternion(values[:3], of_unit_length(np.array([values[3:]]))[0][0])
    in_degrees = (pose.get("degrees") or "false").strip() in ("true", "1")
    angles = [math.radians(a) for a in values[3:]] if in_degrees else values[3:]
    return pose_from_rpy(values[:3], angles)


def angles_of(element: Element) -> list[float]:
    """Roll, pitch and yaw [rad] as they are written in a `<pose>`; none where it has no six numbers."""
    pose = element.find("pose")
    words = [] if pose is None else (pose.text or "").split()
    if len(words) != 6 or pose.get("degrees"):
        return []
    try:
        return [float(word) for word in words[3:]]
    except ValueError:  # of an element that is not read, in a plugin or an actor
        return []


def n_rounded(document: Element) -> int:
    """How many poses have a quaternion that is rounded to three digits or so, and made of length 1."""
    written = [
        (pose.text or "").split() for pose in document.iter("pose") if pose.get("rotation_format")
    ]
    words = [row[3:] for row in written if len(row) == 7]
    try:
        return of_unit_length(np.array(words, dtype=np.float64).reshape(-1, 4))[1]
    except ValueError:  # of an element that is not read, in a plugin or an actor
        return 0


def base_of(element: Element) -> str:
    """What an element's pose is relative to, if it says so."""
    pose = element.find("pose")
    return "" if pose is None else pose.get("relative_to") or pose.get("frame") or ""


def _numbers(text: str, n: int, tag: str) -> tuple[float, ...]:
    return finite_numbers(text, f"<{tag}> is {text!r:.60}", (n,))


def _require_version(given: str) -> None:
    parts = given.split(".")
    if not all(part.isascii() and part.isdigit() and len(part) < 6 for part in parts):
        raise BadScene(f"version={given!r:.60}", where="sdf", valid="a version such as 1.9")
    if tuple(map(int, parts)) > NEWEST and tuple(map(int, parts))[:2] != NEWEST:
        raise BadScene(f"version {given} is given", where="sdf", valid="1.11 or older is read")
