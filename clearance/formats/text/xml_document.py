"""XML documents in which nothing stands for something else, and the `<robot>` element of URDF and SRDF files.

Not for: what the elements mean (`urdf.elements`, `srdf`).
"""

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


XACRO = ".xacro"
"""Suffix of files that are xacro's."""

ALLOW_XACRO = "xacro evaluates Python in it: `xacro: true` beside urdf, or --xacro, allows that"


def robot_element(data: bytes, wanted: str) -> Element:
    """The root element of a document, its elements without a namespace; comments are gone.

    Args:
        wanted: "a URDF file" or "an SRDF file".

    Raises:
        BadSyntax: not XML, another root, an entity that stands for something, or a xacro file.
    """
    from lxml import etree

    root = root_of(data, wanted)
    if etree.QName(root).localname != "robot":
        raise BadSyntax(
            f"the root element is <{etree.QName(root).localname}>", valid="<robot> is needed"
        )
    entity = next(root.iter(etree.Entity), None)
    if entity is not None:
        raise BadSyntax(
            f"{entity.text} stands for something among the elements",
            valid="write out what it stands for",
        )
    if any("xacro" in (etree.QName(element).namespace or "") for element in root.iter()):
        otherwise = (
            f"`xacro: true` beside urdf in a case makes {wanted} of it, as the xacro command does"
        )
        raise BadSyntax(
            f"this is a xacro file, not {wanted}",
            valid=ALLOW_XACRO if wanted == "a URDF file" else otherwise,
        )
    namespace = etree.QName(root).namespace
    if namespace is not None:  # URDF has none of its own
        for element in root.iter():
            element.tag = element.tag.removeprefix(f"{{{namespace}}}")
    return root
