"""The SDF files that `<include>` names: found, read once each, the newest version of a model that we can read.

Not for: what is in them (`scope`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import BadInput, BadScene, UnknownKey, at, nearest_name
from clearance.formats.files.found_files import MODEL, OPTIONAL, FoundFiles, note_lookup
from clearance.formats.files.mesh_paths import model_path
from clearance.formats.scene.request import SKIP, SceneRequest
from clearance.formats.scene.sdf.document import NEWEST, sdf_element, text_of
from clearance.formats.scene.sdf.scope import IncludedModel
from clearance.formats.text.unread import Unread
from clearance.formats.text.yaml_text import flow
from clearance.world.notice import Notice, Severity, naming

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

MOST_ELEMENTS = 2_000_000
"""In all files, each counted as often as it is included."""

SUN = "model://sun"
"""The light of every world that Gazebo makes: no solid, and left out where it is not there."""


class IncludeReader:
    """Finds and reads included files, and keeps what is to be reported of them."""

    def __init__(self, asked: SceneRequest) -> None:
        self._asked = asked
        self._roots: dict[Path, Element] = {}
        self.unread: list[Unread] = []
        self._n_elements = 0
        self.missing_suns = 0
        self._said: dict[str, None] = {}
        self.found = FoundFiles(asked.files, asked.package_dirs)

    @property
    def documents(self) -> list[Element]:
        """The root of each file that was read."""
        return list(self._roots.values())

    def root(self, path: Path) -> Element:
        """The root element of a file.

        Raises:
            BadInput: it is no SDF file; all files together are too long.
        """
        path = path.resolve()
        if path not in self._roots:
            self._roots[path], found = sdf_element(self._asked.files.read(path))
            self.unread += found
        self._n_elements += sum(1 for _ in self._roots[path].iter())
        if self._n_elements > MOST_ELEMENTS:
            raise BadScene(f"more than {MOST_ELEMENTS} elements in all", valid="fewer includes")
        return self._roots[path]

    def include(self, element: Element, folder: Path, chain: tuple[str, ...]) -> IncludedModel:
        """The model that an `<include>` in a file of `folder` names.

        Args:
            chain: the files that lead here, as they are shown.
        """
        uri = text_of(element, "uri")
        said = self._asked.includes.get(uri)
        if said is not None:
            self._said[uri] = None
        if said == SKIP:
            return IncludedModel(None, folder, uri)
        asked = said or uri, folder, self._asked.package_dirs
        try:
            found = model_path(*asked)
        except BadInput as error:
            if uri.rstrip("/") != SUN:
                leave_out = f"includes: {{{flow(uri)}: {SKIP}}} in the case leaves it out"
                ways = f"{leave_out}, a path in place of skip uses another model"
                error.valid = f"{error.valid}; {ways}".removeprefix("; ")
                raise
            note_lookup(self._asked.files, MODEL, *asked, None)
            self.missing_suns += 1
            return IncludedModel(None, folder, uri)
        note_lookup(self._asked.files, MODEL, *asked, found.path)
        path = _file_of(found.path, self._asked)
        shown = self._asked.files.shown(path)
        self.found.add(asked[0], found, shown)
        if shown in chain:
            raise BadScene(f"{shown} includes itself", valid="no ring of files")
        with at(shown):
            return IncludedModel(_only_model(self.root(path)), path.parent, shown)

    def notices(self) -> list[Notice]:
        """A warning on included models that the case leaves out or replaces.

        Raises:
            UnknownKey: the case names a model that the scene does not include.
        """
        for uri in self._asked.includes:
            if uri not in self._said:
                raise UnknownKey(
                    f"includes names {uri!r}, which the scene does not include",
                    valid=nearest_name(uri, self._uris()),
                )
        skipped = [repr(uri) for uri in self._said if self._asked.includes[uri] == SKIP]
        replaced = [
            f"{Path(self._asked.includes[uri]).name} for {uri!r}"
            for uri in self._said
            if self._asked.includes[uri] != SKIP
        ]
        lines = [
            *naming("included models left out, as the case says", skipped),
            *naming("models used in place of others, as the case says", replaced),
        ]
        return [Notice(Severity.WARNING, "scene", line) for line in lines]

    def _uris(self) -> set[str]:
        includes = (one for root in self.documents for one in root.iter("include"))
        return {(one.findtext("uri") or "").strip() for one in includes}


def _file_of(path: Path, asked: SceneRequest) -> Path:
    """The SDF file that is meant by it or by its folder: as `model.config` says, else `model.sdf`."""
    if not path.is_dir():
        return path
    config = path / "model.config"
    if not config.is_file():
        note_lookup(asked.files, OPTIONAL, config.name, path, (), None)
        return path / "model.sdf"
    with at(asked.files.shown(config)):
        return path / _newest(asked.files.read(config))


def _newest(config: bytes) -> str:
    """The file of the newest version that is read."""
    from lxml import etree

    parser = etree.XMLParser(resolve_entities=False, no_network=True, recover=True)
    try:
        root = etree.fromstring(config.lstrip(), parser)
    except (etree.XMLSyntaxError, ValueError):
        root = None
    best: tuple[int, ...] = (0, 0)
    name = "model.sdf"
    for row in () if root is None else root.iterfind("sdf"):
        parts = (row.get("version") or "1.0").strip().split(".")[:2]
        version = tuple(int(part) if part.isdecimal() and len(part) < 6 else 0 for part in parts)
        if best <= version <= NEWEST and (row.text or "").strip():
            best, name = version, row.text.strip()
    return name


def _only_model(root: Element) -> Element | None:
    models = root.findall("model")
    if root.find("world") is not None or len(models) > 1:
        what = "a world" if root.find("world") is not None else f"{len(models)} models"
        raise BadScene(f"{what} is included", valid="a file with one model")
    return models[0] if models else None
