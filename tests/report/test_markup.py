"""What the page is built with: everything from outside is escaped once, and nothing twice."""

from __future__ import annotations

from xml.etree import ElementTree

from hypothesis import given
from hypothesis import strategies as st
from markupsafe import Markup

from clearance.report.markup import element, table

# what XML cannot hold at all, and the line ends that its readers turn into others
TEXT = st.text(st.characters(exclude_categories=("Cc", "Cs"), exclude_characters="\ufffe\uffff"))


@given(TEXT, TEXT)
def test_a_reader_finds_the_text_and_the_attribute_that_were_given(text, title):
    read = ElementTree.fromstring(element("p", text, element("b", text), title=title))
    assert read.text == (text or None) and read.get("title") == title
    assert len(read) == 1 and read[0].text == (text or None)


def test_markup_is_taken_as_it_is_and_numbers_as_text():
    assert element("td", Markup("<i>1</i>"), 2, " < ", 0.5) == "<td><i>1</i>2 &lt; 0.5</td>"


def test_markup_in_an_attribute_is_text():
    assert element("p", title=Markup('<i class="x">')) == '<p title="&lt;i class=&#34;x&#34;&gt;"></p>'


def test_names_of_attributes_lose_their_underscores_and_none_is_left_out():
    made = element("td", "", class_="number", data_step=3, title=None)
    assert made == '<td class="number" data-step="3"></td>' and isinstance(made, Markup)


def test_a_table_escapes_its_heads():
    assert "<script>" not in table(("><script>", "a & b"), [])
    assert "a &amp; b" in table(("a & b",), [])
