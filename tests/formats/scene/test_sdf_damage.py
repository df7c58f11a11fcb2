"""Damaged SDF files: cut off at every byte, and with parts exchanged, only our own errors come out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import cli
from clearance.errors import BadInput
from tests.examples import examples
from tests.formats.making import write_case
from tests.formats.making_sdf import BOX, at, collision, content_of, link, model, pose, sdf, world
from tests.formats.scene.test_sdf_file import NAMED

SMALL = sdf(
    world(
        model(
            at(1),
            link(collision(), name="a"),
            link(at(2, "a"), collision(BOX, pose("0 0 1 1 0 0"))),
        )
    )
).encode()


@pytest.mark.slow
def test_a_file_cut_off_anywhere_is_refused(tmp_path):
    for n in range(len(SMALL)):
        with pytest.raises(BadInput) as caught:
            content_of(tmp_path, SMALL[:n])
        assert str(caught.value).startswith("cell.sdf: ") and "\n" not in str(caught.value)


WORDS = [
    "1 2 3", "nan", "", "1e400", "m", "l", "a::b", "__model__", "world", "model://x", "cell.sdf", "٣", "1_0",
]  # fmt: skip
TAGS = ["model", "link", "collision", "geometry", "box", "size", "pose", "include", "uri", "frame", "joint",
        "child", "mesh", "plane", "normal", "state", "world", "scale", "sphere", "radius"]  # fmt: skip
KEYS = [
    "name",
    "relative_to",
    "attached_to",
    "placement_frame",
    "degrees",
    "rotation_format",
    "merge",
]


def _element(children):
    def made(tag, attributes, inner):
        written = "".join(f' {key}="{value}"' for key, value in attributes.items())
        return f"<{tag}{written}>{''.join(inner)}</{tag}>"

    attributes = st.dictionaries(st.sampled_from(KEYS), st.sampled_from(WORDS), max_size=3)
    return st.builds(made, st.sampled_from(TAGS), attributes, st.lists(children, max_size=4))


TREES = st.recursive(st.sampled_from(WORDS), _element, max_leaves=25)


@examples(150)
@given(st.lists(TREES, max_size=4))
def test_only_our_own_errors_come_out(tmp_path_factory, parts):
    folder = tmp_path_factory.getbasetemp()
    try:
        content_of(folder, sdf(*parts))
    except BadInput as error:
        assert str(error).startswith("cell.sdf") and "\n" not in str(error)


@examples(150)
@given(st.data())
def test_exchanged_bytes_do_too(tmp_path_factory, data):
    damaged = bytearray(SMALL)
    for _ in range(data.draw(st.integers(1, 3))):
        damaged[data.draw(st.integers(0, len(SMALL) - 1))] = data.draw(st.integers(0, 255))
    try:
        content_of(tmp_path_factory.getbasetemp(), bytes(damaged))
    except BadInput as error:
        assert str(error).startswith("cell.sdf") and "\n" not in str(error)


def test_the_command_line_answers_with_one_line(tmp_path, capsys):
    text = sdf(model(link(collision("<cilinder/>"))))
    path = write_case(tmp_path, NAMED, cell__sdf=text)
    assert cli.run(["check", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    said = "case.yaml: scene: cell.sdf: model 'm': link 'l': collision 'c': <cilinder>"
    assert said in told and "did you mean 'cylinder'?" in told
