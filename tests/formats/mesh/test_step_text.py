"""What the text of a STEP file says of itself, and which files are refused before anything is made of them."""

import pytest

from clearance.errors import BadInput, BadSyntax
from clearance.formats.mesh.step_text import step_facts
from tests.formats.making_case import load_small, with_obstacle
from tests.formats.making_step import HEAD, TAIL, box_step, cylinder_step
from tests.formats.refusal import refusal

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
        (box_step().replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT(.MEGA.,.METRE.)"), "is no length unit"),
        (box_step(uncertainty=1e9), "is given as a length"),
        (box_step(uncertainty=1e5), "its accuracy is 100 m"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line(text, says):
    assert says in refusal(step_facts, text.encode(), of=BadSyntax)


def test_a_tolerance_of_flat_faces_is_refused(tmp_path):
    with pytest.raises(BadInput, match=r"a tolerance of 'upper.stl' is given.*of .step or .stp"):
        load_small(tmp_path, with_obstacle("mesh: {file: upper.stl, tolerance: 0.001}"))


@pytest.mark.parametrize(
    ("item", "unread"),
    [
        ("SWEPT_DISK_SOLID('',#1,20.,$,0.,2.)", "SWEPT_DISK_SOLID"),
        ("BLOCK('it''s',{axes},50.,50.,50.)", "BLOCK"),
        ("SPHERE('',50.,#1)", "SPHERE"),
        ("TORUS('',#1,50.,10.)", "TORUS"),
        ("RIGHT_CIRCULAR_CYLINDER('',#1,50.,10.)", "RIGHT_CIRCULAR_CYLINDER"),
        ("CSG_SOLID('',#1)", "CSG_SOLID"),
        ("SPHERICAL_SURFACE('',{axes},50.)", "SPHERICAL_SURFACE"),
        ("RECTANGULAR_TRIMMED_SURFACE('',#1,0.,1.,0.,1.,.T.,.T.)", "RECTANGULAR_TRIMMED_SURFACE"),
        (
            "(GEOMETRIC_REPRESENTATION_ITEM() REPRESENTATION_ITEM('') SOLID_MODEL() SOLID_OF_TOMORROW(1.))",
            "GEOMETRIC_REPRESENTATION_ITEM REPRESENTATION_ITEM SOLID_MODEL SOLID_OF_TOMORROW",
        ),
        ("CARTESIAN_TRANSFORMATION_OPERATOR_3D('','','',$,$,#1,2.,$)", "CARTESIAN_TRANSFORMATION"),
    ],
)
def test_what_open_cascade_leaves_out_is_refused_by_its_name(item, unread):
    with pytest.raises(BadSyntax, match=f"{unread}.* is not read"):
        step_facts(box_step(item=item).encode())


def test_so_are_surfaces_in_a_set_and_items_of_a_complex_representation():
    whole = box_step(item="GEOMETRIC_SET('',({axes},{solid}))")
    assert "MANIFOLD_SOLID_BREP is not read" in refusal(step_facts, whole.encode(), of=BadSyntax)
    items = "(REPRESENTATION('of it',(#9001),#1) SHAPE_REPRESENTATION())"
    block = f"#9001=BLOCK('',#1,1.,1.,1.);\n#9002={items};\n"
    with pytest.raises(BadSyntax, match="BLOCK is not read"):
        step_facts(box_step().replace(TAIL, block + TAIL).encode())


@pytest.mark.parametrize(
    "item",
    [
        "CARTESIAN_POINT('',(0.,0.,0.))",
        "PLANE('',{axes})",
        "TEXT_LITERAL_WITH_EXTENT('','BLOCK(',{axes},'left',.RIGHT.,#1,#1)",
        "(LENGTH_MEASURE_WITH_UNIT() MEASURE_REPRESENTATION_ITEM() REPRESENTATION_ITEM(''))",
        "GEOMETRIC_SET('',({axes}))",
    ],
)
def test_what_has_no_surface_is_passed_over(item):
    assert step_facts(box_step(item=item).encode()) == (6, 1e-10, 0, ())


def test_sets_of_curves_are_counted():
    assert step_facts(box_step(item="GEOMETRIC_CURVE_SET('',({axes}))").encode()).n_lines == 1


OCCURRENCE = """#9000=PRODUCT_DEFINITION('design','',#1,#2);
#9001=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#9000,{part},$);
#9002=PRODUCT_DEFINITION_SHAPE('','',#9001);
"""


def test_an_occurrence_of_a_part_without_a_placement_is_refused():
    text = box_step()
    part = next(line for line in text.splitlines() if "=PRODUCT_DEFINITION(" in line)
    unplaced = text.replace(TAIL, OCCURRENCE.format(part=part.partition("=")[0]) + TAIL)
    with pytest.raises(BadSyntax, match="#9001 is a part of an assembly without a placement"):
        step_facts(unplaced.encode())
    placement = "#9003=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#1,#9002);\n"
    assert step_facts(unplaced.replace(TAIL, placement + TAIL).encode()).n_faces == 6
    without_shape = text.replace(TAIL, OCCURRENCE.format(part="#9005") + TAIL)
    assert step_facts(without_shape.encode()).n_faces == 6


BARE = """#9003=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#1,#9002);
#9005=PRODUCT_DEFINITION('holder','',#1,#2);
#9006=PRODUCT_DEFINITION_SHAPE('','',#9005);
#9007=AXIS2_PLACEMENT_3D('',#1,#2,#3);
#9008=SHAPE_REPRESENTATION('',(#9007),#4);
#9009=SHAPE_DEFINITION_REPRESENTATION(#9006,#9008);
"""


def test_parts_of_an_assembly_without_a_shape_are_named():
    """A representation that is related to one with a shape is that shape."""
    occurrence = OCCURRENCE.format(part="#9005").replace("CE('',", "CE('holder:1',")
    text = box_step().replace(TAIL, occurrence + BARE + TAIL)
    assert step_facts(text.encode()).bare == ("'holder:1'",)
    shape = next(line for line in text.splitlines() if "ADVANCED_BREP" in line).partition("=")[0]
    related = f"#9010=SHAPE_REPRESENTATION_RELATIONSHIP('','',#9008,{shape});\n"
    assert step_facts(text.replace(TAIL, related + TAIL).encode()).bare == ()
