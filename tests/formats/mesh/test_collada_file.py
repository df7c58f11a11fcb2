"""COLLADA: unit and up axis are obeyed once, transforms and instances are placed, precision is kept."""

import re

import numpy as np
import pytest

from clearance.errors import BadInput
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from tests.formats.making import signed_volume
from tests.formats.making_meshes import NODE, WEDGE, collada, primitive
from tests.formats.refusal import refusal


def load(*args, scale=1.0, **kwargs):
    return mesh_from_bytes(collada(*args, **kwargs), "m.dae", scale)


Z_UP = "<up_axis>Z_UP</up_axis>"


@pytest.mark.parametrize(
    ("asset", "upper", "lower"),
    [
        (Z_UP, [1, 2, 3], [0, 0, 0]),
        ('<unit name="inch" meter="0.0254"/>' + Z_UP, [0.0254, 0.0508, 3 * 0.0254], [0, 0, 0]),
        ("<up_axis>Y_UP</up_axis>", [1, 0, 2], [0, -3, 0]),
        ("", [1, 0, 2], [0, -3, 0]),  # the specification's default is y up, in metres
        ("<up_axis>X_UP</up_axis>", [0, 0, 1], [-2, -3, 0]),
        ('<unit meter="0.5"/>', [0.5, 0, 1], [0, -1.5, 0]),
    ],
)
def test_unit_and_up_axis_are_obeyed_once(asset, upper, lower):
    mesh = load(asset)
    assert mesh.shape.bounds.tolist() == [lower, upper]
    assert signed_volume(mesh.shape) > 0
    assert bool(mesh.notes) == (asset != Z_UP)


def test_positions_keep_double_precision():
    value = 0.1234567890123456
    mesh = load(Z_UP, vertices=f"0 0 0 {value!r} 0 0 0 2 0 0 0 3")
    assert value in mesh.shape.vertices[:, 0]
    assert float(np.float32(value)) != value


@pytest.mark.parametrize(
    ("transforms", "upper"),
    [
        ("<translate>1 2 3</translate>", [2, 4, 6]),
        ("<translate>1 0 0</translate><scale>2 2 2</scale>", [3, 4, 6]),
        ("<rotate>0 0 1 90</rotate>", [0, 1, 3]),
        ("<matrix>1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix>", [6, 2, 3]),
        ("<scale>1 1 -1</scale>", [1, 2, 0]),
    ],
)
def test_node_transforms_are_applied_in_order_and_keep_faces_outward(transforms, upper):
    mesh = load(Z_UP, nodes=f"<node>{transforms}{NODE}</node>")
    assert mesh.shape.bounds[1].tolist() == upper
    assert signed_volume(mesh.shape) > 0


def test_nested_nodes_and_instances_are_all_placed():
    inner = f"<node><translate>0 0 10</translate>{NODE}</node>"
    nodes = (
        f'<node><translate>5 0 0</translate>{inner}</node><node><instance_node url="#n"/></node>'
    )
    library = f'<library_nodes><node id="n">{NODE}</node></library_nodes>'
    mesh = load(Z_UP, nodes=nodes, more=library)
    assert mesh.n_triangles == 8
    assert mesh.shape.bounds.tolist() == [[0, 0, 0], [6, 2, 13]]


def test_polygons_of_several_primitives_are_kept_and_cut_inside():
    dart = "2 2 0 0 1 0 -2 2 0 0 0 0"
    primitives = (
        primitive("polylist", 1, "<vcount>4</vcount><p>0 1 2 3</p>")
        + primitive("polygons", 1, "<p>3 2 1 0</p>")
        + primitive("lines", 1, "<p>0 1</p>")
    )
    mesh = load(Z_UP, vertices=dart, primitives=primitives)
    areas = [mesh.shape.face(i) for i in range(mesh.shape.n_faces)]
    area = sum(np.linalg.norm(np.cross(f[1] - f[0], f[2] - f[0])) / 2 for f in areas)
    assert mesh.n_triangles == 4
    assert area == pytest.approx(4)
    assert "1 element of points or lines, which have no surface: not measured" in mesh.notes


def test_triangle_strips_turn_every_other_triangle():
    strips = (primitive("tristrips", 1, f"<p>{p}</p>") for p in ("0 2 1 3", "1 3 0 2"))
    mesh = load(Z_UP, primitives="".join(strips))
    assert mesh.shape.closed and mesh.shape.oriented
    assert signed_volume(mesh.shape) == pytest.approx(1)


def with_accessor(numbers: str, attributes: str, *names: str) -> bytes:
    """The wedge's document with another accessor, of four points unless it says otherwise, over other numbers."""
    parts = "".join(f'<param name="{name}"/>' if name else "<param/>" for name in names)
    count = "" if "count" in attributes else 'count="4"'
    accessor = f'<accessor source="#pa" {count} {attributes}>{parts}</accessor>'
    text = collada(Z_UP, vertices=numbers).decode()
    return re.sub(r"<accessor.*</accessor>", accessor, text, flags=re.DOTALL).encode()


@pytest.mark.parametrize(
    "data",
    [
        with_accessor(f"9 9 {WEDGE}", 'offset="2" stride="3"', *"XYZ"),
        with_accessor("0 0 0 7 1 0 0 7 0 2 0 7 0 0 3", 'stride="4"', *"XYZ"),
        with_accessor("7 0 0 0 7 1 0 0 7 0 2 0 7 0 0 3", 'stride="4"', "", *"XYZ"),
        with_accessor("0 0 0 0 1 0 0 0 2 3 0 0", 'stride="3"', *"ZXY"),
        with_accessor(WEDGE, 'stride="3"'),
    ],
    ids=["offset", "stride", "part without a name", "parts in another order", "no parts"],
)
def test_positions_are_taken_as_the_accessor_says(data):
    mesh = mesh_from_bytes(data, "m.dae")
    assert mesh.shape.bounds.tolist() == [[0, 0, 0], [1, 2, 3]]
    assert signed_volume(mesh.shape) == pytest.approx(1)


@pytest.mark.filterwarnings("error")  # numbers that overflow say nothing on the terminal
@pytest.mark.parametrize(
    ("data", "says"),
    [
        (with_accessor(WEDGE, 'count="5" stride="3"', *"XYZ"), "number 14"),
        (with_accessor(WEDGE, 'stride="2"', *"XYZ"), "stride 2"),
        (collada(Z_UP).replace(b'count="12"', b'count="13"'), "its count is 13"),
        (collada(Z_UP).replace(b'<triangles count="4"', b'<triangles count="5"'), "its count is 5"),
        (collada(Z_UP, primitives=primitive("polylist", 2, "<vcount>3</vcount><p>0 1 2</p>")), "count is 2"),
        (collada(Z_UP, primitives=primitive("polylist", 1, "<vcount>4</vcount><p>0 1 2</p>")),
         "polygons name 4 corners, 3 are given"),
        (collada(Z_UP, primitives=primitive("triangles", 4, "<p>0 2 1</p>", '<input semantic="VERTEX"/>')),
         "has no attribute"),
        (collada(Z_UP, primitives=primitive("triangles", 1, "")), "no <p>"),
        (collada(Z_UP, primitives=primitive("triangles", 1, "<p>0 1 1_0</p>")), "'1_0' is not a whole number"),
        (collada(Z_UP, primitives=primitive("triangles", 1, "<p>0 1 2<b/> 3</p>")), "<p> holds <b>"),
        (collada(Z_UP, primitives=primitive("polygons", 1, "<ph><p>0 1 2</p></ph>")), "holes (<ph>)"),
        (collada('<unit meter="0,01"/>' + Z_UP), "<unit meter='0,01'> is given"),
        (collada('<unit name="inch"/>' + Z_UP), "<unit name='inch'> is given"),
        (collada("<up_axis>W_UP</up_axis>"), "<up_axis> is 'W_UP'; X_UP, Y_UP, Z_UP"),
        (collada(Z_UP).replace(b"<mesh>", b'<asset><unit meter="0.5"/></asset><mesh>'), "units of 1 and 0.5 m"),
        (collada(Z_UP, nodes=f"<node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>{NODE}</node>"),
         "<matrix>: the last row is [0.0, 0.0, 0.0, 2.0]; 0 0 0 1"),
        (collada(Z_UP, nodes=f"<node><scale>1 nan 1</scale>{NODE}</node>"), "not finite"),
        (collada(Z_UP, nodes=f"<node><rotate>0 0 1e308 90</rotate>{NODE}</node>"), "the axis is"),
        (collada(Z_UP).replace(b"<COLLADA", b'<!DOCTYPE a [<!ENTITY a "b">]><COLLADA', 1), "entities"),
        (collada(Z_UP, nodes=f"{'<node>' * 120}{NODE}{'</node>' * 120}"), "nested more than 100 deep"),
        (collada(Z_UP, nodes='<node id="a"><instance_node url="#a"/></node>'), "place themselves"),
        (collada(Z_UP, more='<library_geometries><geometry id="g"/></library_geometries>'), "the id 'g'"),
    ],
)  # fmt: skip
def test_what_would_be_another_surface_is_refused(data, says):
    said = refusal(mesh_from_bytes, data, "m.dae", of=BadInput)
    assert says in said and said.startswith("m.dae: ")
