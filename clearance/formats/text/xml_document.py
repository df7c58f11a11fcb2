"""XML documents in which nothing stands for something else. Not for: what the elements mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clearance.errors import BadSyntax

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


def root_of(data: bytes, needed: str, *, is_huge: bool = False) -> Element:
    """The root element of a document; comments are gone, and entities stand for themselves.

    Args:
        needed: "an SDF file", for the message. is_huge: it may be deeper and longer than documents of text are.

    Raises:
        BadSyntax: not XML.
    """
    from lxml import etree

    parser = etree.XMLParser(
        remove_comments=True,
        remove_pis=True,
        resolve_entities=False,
        huge_tree=is_huge,
        no_network=True,
    )
    try:
        return etree.fromstring(data.lstrip(), parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        problem = getattr(error, "msg", None) or str(error)
        raise BadSyntax(f"not XML: {problem}", valid=f"{needed} is needed") from None


def plain_root(data: bytes, needed: str) -> Element:
    """The root element of a document without a document type and without entities; comments are gone.

    Args:
        needed: as for `root_of`.

    Raises:
        BadSyntax: not XML, a document type or an entity.
    """
    root = root_of(data, needed)
    if root.getroottree().docinfo.doctype:  # without one, an entity is no XML
        raise BadSyntax(
            "a document type or an entity, which may stand for anything",
            valid="write out what it stands for",
        )
    return root
