"""What an XML document says beside what its reader reads, by a table of elements.

A name that may be meant to give a shape or a place is refused, or named in a warning; any other stands in a note.
Not for: what the elements that are read mean.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from clearance.errors import BadInput, meant_name
from clearance.formats.text.numbers import is_zero
from clearance.world.notice import Notice, Severity, naming

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

ANY = "*"
"""In place of the names of a row's children: the reader itself refuses what it does not read."""


class Row(NamedTuple):
    """The names in one element of a format, with blanks between them.

    Attributes:
        children, attributes: those that are read.
        passed: elements and attributes that say nothing of shape or place: they are passed over.
        has_text: its text is read. closed: it has no names but those above.
    """

    children: str = ""
    attributes: str = ""
    passed: str = ""
    has_text: bool = False
    closed: bool = False


class Format(NamedTuple):
    """The table of a format.

    Attributes:
        rows: by the name of the element. fault: the class of a refusal.
    """

    rows: Mapping[str, Row]
    fault: type[BadInput]


_PLACES = frozenset(
    "origin axis mesh xyz rpy pose pos quat size radius radii length scale link filename file uri "
    "include placement_frame relative_to attached_to href unit units".split()
)
"""Elements and attributes that give a shape or a place, in one format or another."""

_SOLID = frozenset(
    "link collision visual geometry box sphere cylinder capsule ellipsoid plane mesh".split()
)


class Unread(NamedTuple):
    """An element that is not read, or the owner of such an attribute.

    Attributes:
        name: `<surface>` or `role=`. where: `link 'a'`. is_passed: the table lets it through.
        is_place: it may give a shape or a place.
    """

    element: Element
    name: str
    where: str
    is_passed: bool = False
    is_place: bool = False


def unread(element: Element, known: Format) -> Iterator[Unread]:
    """What is not read in an element and in those below that are read.

    Raises:
        BadInput: a name that resembles one that is read, or gives a shape or a place; text in place of elements.
    """
    row, where = known.rows[str(element.tag)], _where(element)
    text = (element.text or "").strip()
    if text and not (row.has_text or len(element)):
        raise known.fault(f"the text {text!r:.60} is not read", where=where, valid=_valid(row))
    for name, value in element.attrib.items():
        local = _local(name)
        if name not in row.attributes.split() and not _is_nothing(value):
            if local not in row.passed.split():
                yield _attribute(element, (local, value), row, known)
    children, passed = row.children.split(), row.passed.split()
    for child in element:
        if child.tag in children or row.children == ANY:
            if child.tag in known.rows:
                yield from unread(child, known)
        elif _local(child.tag) in passed:
            is_place = _local(child.tag) != "plugin" and _holds(child, ("geometry",))
            yield Unread(child, f"<{_local(child.tag)}>", where, True, is_place)
        else:
            yield _element(child, row, known)


def notices_on(found: Sequence[Unread]) -> list[Notice]:
    """A warning on unread elements that may give a shape or a place."""
    named = [f"{one.name} in {one.where}" for one in found if one.is_place]
    text = "not read, though it may give a shape or a place"
    return [Notice(Severity.WARNING, "geometry", line) for line in naming(text, named, 4)]


def notes_on(found: Sequence[Unread]) -> list[str]:
    """A note on unread names that the table does not have."""
    counted = Counter(one.name for one in found if not (one.is_passed or one.is_place))
    named = [name if n == 1 else f"{name} ({n})" for name, n in counted.items()]
    return naming("not read", named, 8)


def _attribute(element: Element, given: tuple[str, str], row: Row, known: Format) -> Unread:
    """An attribute that the table does not have there."""
    (name, value), where = given, _where(element)
    meant = meant_name(name, row.attributes.split())
    if meant or row.closed or name in _PLACES or name in row.children.split():
        valid = f"did you mean {meant}=?" if meant else _valid(row)
        raise known.fault(f"{name}={value!r:.60} is not read", where=where, valid=valid)
    return Unread(element, f"{name}=", where)


def _element(child: Element, row: Row, known: Format) -> Unread:
    """An element that the table does not have there."""
    name, where = _local(child.tag), _where(child.getparent())
    is_place = any(_gives_place(one) for one in child.iter())
    meant = meant_name(name, row.children.split()) or name * (name in row.children.split())
    is_known = name in known.rows or name in _PLACES
    if meant or row.closed or (is_known and is_place) or _holds(child, _SOLID):
        shown = f"{child.prefix}:{name}" if child.prefix else name
        valid = f"did you mean <{meant}>?" if meant else _valid(row)
        raise known.fault(f"<{shown}> is not read", where=where, valid=valid)
    return Unread(child, f"<{name}>", where, is_place=is_place)


def _gives_place(element: Element) -> bool:
    values = {_local(name): value for name, value in element.attrib.items()}
    values[_local(element.tag)] = element.text or ""
    return any(name in _PLACES and not _is_nothing(values[name]) for name in values)


def _holds(element: Element, tags: Collection[str]) -> bool:
    """True if one of the tags is in it, or is its own, and says something."""
    return any(_local(one.tag) in tags and (len(one) or one.attrib) for one in element.iter())


def _is_nothing(value: str) -> bool:
    """True for no words, and for numbers that are all 0."""
    return all(is_zero(word) for word in value.split())


def _local(name: str) -> str:
    """A name without its namespace."""
    return str(name).rpartition("}")[2]


def _valid(row: Row) -> str:
    names = [f"{name}=" for name in sorted({*row.attributes.split()})]
    names += [f"<{name}>" for name in sorted(row.children.split())]
    return f"{', '.join(names)}, and no other" if names else "numbers"


def _where(element: Element) -> str:
    """`joint 'j' origin`: the nearest element with a name, and the one that is meant."""
    owner = next((one for one in (element, *element.iterancestors()) if one.get("name")), element)
    named = f"{_local(owner.tag)} {owner.get('name')!r}" if owner.get("name") else ""
    return named if owner is element and named else f"{named} {_local(element.tag)}".strip()
