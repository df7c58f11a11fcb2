"""XML documents in which nothing stands for something else. Not for: what the elements mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clearance.errors import BadSyntax

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


def plain_root(data: bytes, needed: str) -> Element:
    """The root element of a document without a document type and without entities; comments are gone.

    Args:
        needed: "an SDF file", for the message.

    Raises:
        BadSyntax: not XML, a document type or an entity.
    """
    from lxml import etree

    parser = etree.XMLParser(
        remove_comments=True, remove_pis=True, resolve_entities=False, no_network=True
    )
    try:
        root = etree.fromstring(data.lstrip(), parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        problem = getattr(error, "msg", None) or str(error)
        raise BadSyntax(f"not XML: {problem}", valid=f"{needed} is needed") from None
    if root.getroottree().docinfo.doctype or next(root.iter(etree.Entity), None) is not None:
        raise with_entities()
    return root


def with_entities() -> BadSyntax:
    """The refusal of a document in which something may stand for anything."""
    return BadSyntax(
        "a document type or an entity, which may stand for anything",
        valid="write out what it stands for",
    )
