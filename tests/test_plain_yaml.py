"""YAML to plain data: what no YAML is ends with one line; aliases repeat no more than the file's length allows."""

from datetime import date

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clearance.errors import BadInput, BadSyntax, DuplicateName
from clearance.formats.text.yaml_text import flow
from clearance.plain_yaml import MOST_REPEATED, parse_yaml, plain_data


def grown(levels: int, begin: str, holds: str) -> bytes:
    """A file of which each line repeats the one before it ten times."""
    lines = [f"a0: &a0 {begin}"]
    for i in range(1, levels):
        lines.append(f"a{i}: &a{i} {holds % ', '.join([f'*a{i - 1}'] * 10)}")
    return "\n".join(lines).encode()


def test_aliases_are_the_data_that_they_name():
    assert plain_data(b"a: &one [1, 1e-3]\nb: *one\nc: {<<: &two {x: no}, y: 2}\nd: *two") == {
        "a": [1, 1e-3],
        "b": [1, 1e-3],
        "c": {"x": "no", "y": 2},
        "d": {"x": "no"},
    }


@pytest.mark.parametrize(
    ("begin", "holds"), [("[1, 2]", "[%s]"), ("{x: 1}", "{<<: [%s]}"), ("{x: 1}", "{y: [%s]}")]
)
def test_aliases_that_repeat_each_other_are_refused(begin, holds):
    plain_data(grown(4, begin, holds))
    with pytest.raises(BadSyntax, match=r"line 6: the aliases repeat too much; 100,\d\d\d values"):
        plain_data(grown(10, begin, holds))


def test_a_long_file_may_repeat_as_much_as_it_is_long():
    row = ", ".join(["0.125"] * 1000)
    uses = ", ".join(["*row"] * (MOST_REPEATED // 1001))
    assert len(plain_data(f"- &row [{row}]\n- [{uses}]".encode())[1]) == MOST_REPEATED // 1001


@pytest.mark.parametrize("text", ["&a [*a]", "&a {b: [1, *a]}", "&a [{? *a : 1}]"])
def test_an_alias_of_what_it_stands_in_is_refused(text):
    with pytest.raises(BadSyntax, match="line 1: an alias stands in what it repeats"):
        plain_data(text.encode())


@pytest.mark.parametrize(
    "text",
    [
        b"a: !!bool maybe", b"a: !!int ''", b"a: !!float ''", b"a: !!timestamp x",
        b"a: " + b"1" * 5000, b"? {a: [1]}\n: 2", b"a: *b", b"a\0", b"\xff", b"[" * 500, b"a: [",
        b"--- 1\n--- 2", b"!!python/object:os.system x", b"a: !degrees -10",
    ],
)  # fmt: skip
def test_what_no_plain_data_is_made_of_is_refused_in_one_line(text):
    with pytest.raises(BadSyntax):
        plain_data(text)


def test_what_only_yaml_1_1_takes_for_a_number_is_text():
    given = ["1_000", "1_0.5", "-_", "1e_3", "0x_f"]
    assert plain_data(f"[{', '.join(given)}, 010, 1e3]".encode()) == [*given, 10, 1000.0]
    assert plain_data(b"%YAML 1.1\n---\n[1_000, -_]") == ["1_000", "-_"]


def test_a_key_twice_is_refused_with_its_line():
    with pytest.raises(DuplicateName, match="line 2: "):
        plain_data(b"a: 1\na: 2")
    with pytest.raises(DuplicateName, match="key << is there twice"):
        plain_data(b"{<<: {a: 1}, <<: {b: 2}}")


def test_what_a_mapping_takes_gives_way_to_its_own_and_the_first_goes_before():
    text = b"a: &a {x: 1, y: 1}\nb: &b {y: 2, z: 2}\nc: {<<: [*a, *b], x: 3}"
    assert plain_data(text)["c"] == {"x": 3, "y": 1, "z": 2}


def test_lists_in_lists_without_end_are_refused():
    with pytest.raises(BadSyntax, match="nested too deep; 100 levels or fewer"):
        plain_data(b"[" * 101 + b"]" * 101)


def test_every_file_of_ours_is_bounded(tmp_path):
    """Each room reads YAML by the same door."""
    from clearance.planar.curve_file import read_curve
    from clearance.profiles.outline_file import read_outline
    from clearance.sketch import Sketch

    (tmp_path / "f.yaml").write_bytes(grown(10, "[1, 2]", "[%s]"))
    for read in (read_curve, read_outline, Sketch.load):
        with pytest.raises(BadInput, match=r"f\.yaml: line 6: the aliases repeat too much"):
            read(str(tmp_path / "f.yaml"))


def test_a_day_that_is_none_stays_text():
    """Who knows the field says what is wrong with it."""
    assert plain_data(b"[2027-03-31, 2027-02-30, 2027-02-30T25:00:00]") == [
        date(2027, 3, 31),
        "2027-02-30",
        "2027-02-30T25:00:00",
    ]


PLAIN = st.recursive(
    st.integers(-(10**17), 10**17) | st.floats(allow_nan=False, allow_infinity=False) | st.booleans()
    | st.text(st.characters(exclude_categories=["Cs", "Cc", "Cn", "Zl", "Zp"]), max_size=12),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text("ab -:#,'\"0", max_size=5), inner),
)  # fmt: skip


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(PLAIN)
def test_what_is_written_is_read_back(value):
    assert repr(parse_yaml(f"a: {flow(value)}  # said\n".encode(), "a.yaml")) == repr({"a": value})
