"""Damage to the structure of XML: elements, attributes and words exchanged, and still XML."""

from __future__ import annotations

import copy
from random import Random

from lxml import etree

from tests.formats.damaged.lines import odd_word

MOST_ELEMENTS = 3000
"""Of a damaged document, so that what is asked of a reader stays small."""


def xml_damaged(valid: bytes, random: Random) -> bytes:
    """An XML file of which elements, attributes or words of text are exchanged."""
    root = etree.fromstring(valid)
    for _ in range(random.randint(1, 3)):
        elements = [one for one in root.iter() if isinstance(one.tag, str)]
        if len(elements) < MOST_ELEMENTS:
            random.choice(_DAMAGES)(elements, random)
    return etree.tostring(root)


def _change_attribute(elements: list, random: Random) -> None:
    held = [one for one in elements if one.attrib]
    if not held:
        return _change_text(elements, random)
    element = random.choice(held)
    key = random.choice(sorted(element.attrib))
    element.set(key, _words_changed(element.get(key), random))


def _change_text(elements: list, random: Random) -> None:
    held = [one for one in elements if one.text and one.text.strip()]
    element = random.choice(held or elements)
    element.text = _words_changed(element.text or "", random)


def _words_changed(text: str, random: Random) -> str:
    """The text with a word that is another, left out or there twice."""
    words = text.split() or [""]
    i = random.randrange(len(words))
    words[i : i + 1] = random.choice(([odd_word(random)], [odd_word(random)], [], [words[i]] * 2))
    return " ".join(words)


def _swap_values(elements: list, random: Random) -> None:
    held = [(one, key) for one in elements for key in sorted(one.attrib)]
    if not held:
        return _change_text(elements, random)
    (one, key), (other, name) = random.choice(held), random.choice(held)
    value, second = one.get(key), other.get(name)
    one.set(key, second)
    other.set(name, value)


def _rename_attribute(elements: list, random: Random) -> None:
    names = sorted({key for one in elements for key in one.attrib}) + ["x"]
    element = random.choice(elements)
    if element.attrib:
        value = element.attrib.pop(random.choice(sorted(element.attrib)))
        if random.random() < 0.7:
            element.set(random.choice(names), value)
    else:
        element.set(random.choice(names), odd_word(random))


def _rename(elements: list, random: Random) -> None:
    element = random.choice(elements)
    element.tag = random.choice([*sorted({one.tag for one in elements}), "x"])


def _drop(elements: list, random: Random) -> None:
    element = random.choice(elements[1:] or elements)
    if element.getparent() is not None:
        element.getparent().remove(element)


def _repeat(elements: list, random: Random) -> None:
    element = random.choice(elements[1:] or elements)
    if element.getparent() is None:
        return
    for _ in range(random.choice((1, 1, 2, 30))):
        element.addnext(copy.deepcopy(element))


def _graft(elements: list, random: Random) -> None:
    """A copy of an element inside another, which may be inside it."""
    random.choice(elements).append(copy.deepcopy(random.choice(elements)))


def _nest(elements: list, random: Random) -> None:
    element = random.choice(elements[1:] or elements)
    for _ in range(random.choice((1, 2, 50))):
        parent = element.getparent()
        if parent is None:
            return
        around = etree.Element(element.tag, dict(element.attrib))
        parent.replace(element, around)
        around.append(element)


_DAMAGES = (
    _change_attribute, _change_attribute, _change_attribute, _change_text, _change_text, _swap_values,
    _rename_attribute, _rename, _drop, _repeat, _graft, _nest,
)  # fmt: skip
