"""The `<robot>` element that URDF and SRDF files are. Not for: what is in it (`urdf.elements`, `srdf`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clearance.errors import BadSyntax
from clearance.formats.text.xml_document import root_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


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
    _take_out_of(etree.QName(root).namespace, root)
    return root


def _take_out_of(namespace: str | None, root: Element) -> None:
    """Gives the elements of a namespace the names that they have in URDF, which has none of its own."""
    if namespace is None:
        return
    prefix = f"{{{namespace}}}"
    for element in root.iter():
        element.tag = element.tag.removeprefix(prefix)
