"""Names that are hard to show or to match, and messages that must read as a person writes."""

import pytest

from clearance.errors import BadInput
from clearance.formats.motion.requests import parse_trajectory
from clearance.formats.schema.obstacle import Obstacle
from clearance.formats.schema.strict_model import validated
from clearance.world.names import checked_name
from clearance.world.rules import matches
from tests.formats.making_urdf import parse_document

BAD = {
    "a\nb": "control character",
    "CLEAR\x85forged line": "control character",
    "a\u2028b": "line separator",
    "a\u202eb": "direction of text",
    "a\u2066b": "direction of text",
    "a\uffffb": "no character",
    "a\ufdd0b": "no character",
    "a\U0001fffeb": "no character",
}


def escaped(name: str) -> str:
    """The name in the form in which XML can carry it, where it can."""
    return "".join(f"&#{ord(letter)};" for letter in name)


@pytest.mark.parametrize("name", BAD)
def test_a_name_from_any_file_shows_what_it_holds_or_is_refused(name):
    places = {
        "case": lambda: validated(
            Obstacle, {"name": name, "box": {"size": [1.0, 1.0, 1.0]}}, "case.yaml"
        ),
        "csv": lambda: parse_trajectory(f'time,"{name}"\n0,0\n'.encode(), "path.csv"),
    }
    if (
        "no character" not in BAD[name] or ord(name[1]) == 0xFDD0
    ):  # XML refuses U+FFFE and U+FFFF itself
        written = escaped(name)
        places |= {
            "link": lambda: parse_document(
                f'<robot name="r"><link name="{written}"/></robot>'.encode()
            ),
            "joint": lambda: parse_document(
                f'<robot name="r"><link name="a"/><joint name="{written}" type="fixed"/></robot>'.encode()
            ),
            "robot": lambda: parse_document(
                f'<robot name="{written}"><link name="a"/></robot>'.encode()
            ),
            "mesh": lambda: parse_document(
                f'<robot name="r"><link name="a"><collision><geometry><mesh filename="{written}"/>'
                "</geometry></collision></link></robot>".encode()
            ),
        }
    for place, read in places.items():
        with pytest.raises(BadInput) as caught:
            read()
        told = str(caught.value)
        assert BAD[name] in told, place
        assert told.isprintable() and "\n" not in told, place


@pytest.mark.parametrize("letter", ["\x1b", "\x9b", "\u202e", "\uffff", "\ud800"])
def test_what_an_error_quotes_is_shown_escaped_wherever_it_comes_from(letter):
    told = str(BadInput(f"a{letter}b is given", where=f"x{letter}.yaml", valid="c"))
    assert told.isprintable() and letter not in told
    assert repr(letter)[1:-1] in told
    assert str(BadInput("größer ist 机器", valid="x")) == "größer ist 机器; x"


def test_names_in_any_script_are_names():
    for name in ("Gehäuse", "机器人_1", "mâchoire (gauche)", "ذراع"):
        assert checked_name(name) == name


def test_a_name_that_holds_wildcards_matches_itself():
    assert matches("post[a]", "post[a]") and matches("posta", "post[a]")
    assert not matches("postb", "post[a]")
