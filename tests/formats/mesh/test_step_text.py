"""What the text of a STEP file says of itself, and which files are refused before anything is made of them."""

import pytest

from clearance.errors import BadInput, BadSyntax
from clearance.formats.mesh.step_text import step_facts
from tests.formats.making_case import load_small, with_obstacle
from tests.formats.making_step import HEAD, TAIL, box_step, cylinder_step

IN_A_COMMENT = "DATA; /* #9=ADVANCED_FACE('',(),#1,.T.);\n#9=TRIANGULATED_FACE('',1); */"


def _bare_inches() -> str:
    """As Open CASCADE 8 writes it: the number without its type."""
    text = cylinder_step(unit="inch", uncertainty=0.01)
    assert "LENGTH_MEASURE(25.4)" in text
    return text.replace("LENGTH_MEASURE(25.4)", "25.4")


@pytest.mark.parametrize(
    ("text", "n_faces", "accuracy"),
    [
        (box_step(uncertainty=0.01), 6, 1e-5),
        (box_step(unit="m", uncertainty=0.01), 6, 1e-2),
        (cylinder_step(unit="inch", uncertainty=0.01), 3, 0.01 * 25.4e-3),
        (_bare_inches(), 3, 0.01 * 25.4e-3),
        (box_step().replace("UNCERTAINTY", "OTHER"), 6, 0.0),
        (box_step(uncertainty=0.01).replace("DATA;", IN_A_COMMENT), 6, 1e-5),
    ],
)
def test_faces_are_counted_and_the_accuracy_is_in_metres(text, n_faces, accuracy):
    facts = step_facts(text.encode())
    assert facts.n_faces == n_faces and facts.accuracy == pytest.approx(accuracy, rel=1e-12)


def test_a_file_cut_off_anywhere_is_refused():
    whole = cylinder_step().strip().encode()
    for n in range(len(whole)):
        with pytest.raises(BadSyntax):
            step_facts(whole[:n])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("solid a\nendsolid", "not a STEP file"),
        (HEAD + TAIL, "the STEP file has no faces"),
        (HEAD + "#1=TRIANGULATED_FACE('',1);" + TAIL, "TRIANGULATED_FACE is not read"),
        (HEAD + "#1=DOCUMENT_FILE('other.stp');" + TAIL, "names other files, which are not opened"),
        (
            box_step().replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.MEGA.,.METRE.)"),
            "is no length unit",
        ),
        (box_step(uncertainty=1e9), "is given as a length"),
        (box_step(uncertainty=1e5), "its accuracy is 100 m"),
    ],
)
def test_each_fault_is_one_line(text, says):
    with pytest.raises(BadSyntax) as caught:
        step_facts(text.encode())
    assert says in str(caught.value)


def test_a_tolerance_of_flat_faces_is_refused(tmp_path):
    with pytest.raises(BadInput, match=r"a tolerance of 'upper.stl' is given.*of .step or .stp"):
        load_small(tmp_path, with_obstacle("mesh: {file: upper.stl, tolerance: 0.001}"))
