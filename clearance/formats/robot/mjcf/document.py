"""An MJCF file with all that it includes as one document, reduced to bodies, joints, geoms and what holds them.

Textures, materials' pictures, sites, cameras, actuators, sensors, tendons and plugins are taken out, so that the
compiler opens no file at all: mesh files are read by us (`shapes`). What would make bodies that are not
written here is refused by name. Not for: what elements mean, which MuJoCo knows (`mujoco_adapter`).

Source: MuJoCo, XML reference (include, compiler, asset); model editing, `strippath`.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from clearance.errors import (
    BadRobot,
    BadSyntax,
    MissingKey,
    NotFinite,
    at,
    meant_name,
    nearest_name,
)
from clearance.formats.files.input_files import InputFiles
from clearance.formats.text.xml_document import plain_root

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

MOST_BYTES = 32_000_000
MOST_FILES = 200
MOST_ELEMENTS = 500_000
MOST_MADE = 20_000
"""Files are text; a file may include others, and `<replicate>` may make so many copies of elements."""

_NEEDED = ("compiler", "default", "asset", "worldbody", "contact", "equality", "keyframe")
"""Sections of the root that say what there is and where; the others say how it is driven, seen and simulated."""

_PASSED = (
    "option", "size", "visual", "statistic", "extension", "custom", "deformable", "tendon", "actuator", "sensor",
)  # fmt: skip
"""The others that MuJoCo has."""

_OF_KEYS = ("time", "qvel", "act", "ctrl", "mpos", "mquat")

_IDLE = ("site", "camera", "light", "plugin", "texture", "skin", "layer")
"""Elements anywhere that have no surface to touch."""

_NAMES = frozenset(
    (
        *("name", "class", "childclass", "model", "file", "prefix", "mesh", "hfield", "material"),
        *("joint1", "joint2", "body1", "body2", "geom1", "geom2", "meshdir", "assetdir"),
    )
)
"""Attributes that hold names, which may look like numbers."""

_REFUSED = {
    "attach": "bodies of another model",
    "model": "bodies of another model",
    "composite": "bodies that are made by rule",
    "flexcomp": "a body that bends",
    "flex": "a body that bends",
}
"""Elements that make bodies which are not written here."""


@dataclass(eq=False)
class MjcfDocument:
    """A model as one document.

    Attributes:
        root: of the document. folder: of the model's file, against which all files are looked up.
        left_out: how often an element was taken out that bears on how joints move, by its tag.
        outside: included files that lie outside the folder, as they are shown.
    """

    root: Element
    folder: Path
    left_out: dict[str, int] = field(default_factory=dict)
    outside: list[str] = field(default_factory=list)


def mjcf_document(path: Path, files: InputFiles) -> MjcfDocument:
    """The model in a file, reduced; elements from other files stand where they were included.

    Raises:
        BadSyntax: not XML, not MJCF, an entity, or too long. BadInput: an element that is not read, or files that
        include each other. MissingFile: a file that is not there.
    """
    reader = _Inclusion(path.parent, files)
    root = reader.root(path)
    if root.tag != "mujoco":
        raise BadSyntax(f"the root element is <{root.tag}>", valid="<mujoco> is needed")
    reader.expand(root)
    document = MjcfDocument(root, path.parent, outside=reader.outside)
    _require_readable(root)
    _reduce(document)
    return document


class _Inclusion:
    """Reads files and puts them where they are included; each once, as MuJoCo demands."""

    def __init__(self, folder: Path, files: InputFiles) -> None:
        self.folder, self.files = folder, files
        self.seen: set[str] = set()
        self.n_bytes = 0
        self.outside: list[str] = []

    def root(self, path: Path) -> Element:
        """The root element of a file."""
        shown = self.files.shown(path)
        key = os.path.abspath(path)
        if key in self.seen:
            raise BadRobot(f"{shown!r} is included twice", valid="each file once in a model")
        self.seen.add(key)
        data = self.files.read(path)
        self.n_bytes += len(data)
        if self.n_bytes > MOST_BYTES or len(self.seen) > MOST_FILES:
            raise BadSyntax(
                "the model is too long", valid=f"{MOST_BYTES} bytes in {MOST_FILES} files"
            )
        return plain_root(data, "an MJCF file")

    def expand(self, root: Element) -> None:
        """Puts the children of included files' roots in place of each `<include>`, until none is left."""
        waiting = list(root.iter("include"))
        while waiting:
            element = waiting.pop()
            given = element.get("file")
            if not given:
                raise MissingKey("<include> has no file", valid='file="…"')
            path = self.folder / given.replace("\\", "/")
            with at(self.files.shown(path)):
                included = self.root(path)
            if not Path(os.path.abspath(path)).is_relative_to(os.path.abspath(self.folder)):
                self.outside.append(self.files.shown(path))
            parent, children = element.getparent(), list(included)
            place = parent.index(element)
            parent[place : place + 1] = children
            waiting += [found for child in children for found in child.iter("include")]


def _require_readable(root: Element) -> None:
    """Refuses what makes bodies by rule or from elsewhere, and more of them than any model has."""
    for tag, what in _REFUSED.items():
        found = next(root.iter(tag), None)
        if found is not None:
            name = found.get("name") or found.get("prefix") or ""
            raise BadRobot(
                f"<{tag}> {name!r:.60} is not read: it makes {what}",
                valid="a model in which all bodies are written out",
            )
    _require_finite(root)
    n_elements = sum(1 for _ in root.iter())
    n_made = sum(_copies(element) for element in root.iter("geom", "body", "joint", "freejoint"))
    if n_elements > MOST_ELEMENTS or n_made > MOST_MADE:
        raise BadRobot(
            f"it makes {n_made} bodies, joints and geoms of {n_elements} elements",
            valid=f"{MOST_MADE} or fewer, of {MOST_ELEMENTS}",
        )


def _require_finite(root: Element) -> None:
    """Refuses numbers that are none, which MuJoCo takes for numbers that are not given."""
    for element in root.iter():
        for key, text in element.attrib.items():
            if key not in _NAMES and not all(map(_is_finite, text.split())):
                raise NotFinite(
                    f"<{element.tag}> has {key}={text!r:.60}", valid="finite numbers are needed"
                )


def _is_finite(word: str) -> bool:
    """False for a number that is not finite; True for what is no number."""
    try:
        return math.isfinite(float(word))
    except ValueError:
        return True


def _copies(element: Element) -> int:
    """How many of an element the `<replicate>` around it make."""
    n = 1
    for above in element.iterancestors("replicate"):
        try:
            n *= max(1, int(above.get("count") or 1))
        except ValueError:
            raise BadRobot(
                f"<replicate> has count={above.get('count')!r:.20}", valid="a whole number"
            ) from None
        if n > MOST_MADE:
            return n
    return n


def _reduce(document: MjcfDocument) -> None:
    root = document.root
    for section in list(root):
        if section.tag == "option":
            _keep_filter(section)
        elif section.tag in _PASSED:
            root.remove(section)
        elif section.tag not in _NEEDED:
            valid = nearest_name(str(section.tag), (*_NEEDED, *_PASSED))
            raise BadRobot(f"<{section.tag}> is no section of a model", valid=valid)
    for element in list(root.iter(*_IDLE)):
        element.getparent().remove(element)
    for material in root.iter("material"):
        material.attrib.pop("texture", None)
    for field_ in root.iter("hfield"):  # its file is not opened; a geom of it is refused by name
        _name(field_)
        field_.attrib.pop("file", None)
        field_.set("nrow", "2")
        field_.set("ncol", "2")
    for element in list(
        root.iterfind("equality/*")
    ):  # what ties bodies, beside joints that follow joints
        if element.tag == "joint":
            continue
        document.left_out[element.tag] = document.left_out.get(element.tag, 0) + 1
        element.getparent().remove(element)
    for key in root.iterfind(
        "keyframe/key"
    ):  # the rest is of motors and tendons, which are taken out
        for name in _OF_KEYS:
            key.attrib.pop(name, None)
    for mesh in root.iterfind("asset/mesh"):
        _name(mesh)


def _keep_filter(option: Element) -> None:
    """Leaves of the options whether bodies collide with their parents; the rest is of simulation."""
    option.attrib.clear()
    for child in list(option):
        if child.tag != "flag":
            option.remove(child)
        for name in set(child.attrib) - {"filterparent"}:
            if meant_name(name, ["filterparent"]):
                raise BadRobot(f"<flag> has {name}=", valid="did you mean filterparent=?")
            del child.attrib[name]


def _name(asset: Element) -> None:
    """Gives an asset without a name the one that MuJoCo takes from its file."""
    if not asset.get("name") and asset.get("file"):
        asset.set("name", PurePosixPath(asset.get("file").replace("\\", "/")).stem)
