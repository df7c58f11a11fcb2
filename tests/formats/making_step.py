"""Small STEP files (AP214), written out entity by entity: boxes and cylinders, in millimetres or inches."""

from __future__ import annotations

import numpy as np

from tests.strategies import BOX_FACES

_UNITS = {
    "mm": "#{0}=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));",
    "m": "#{0}=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.));",
    "inch": "#{1}=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\n"
    "#{2}=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#{1});\n"
    "#{3}=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n"
    "#{0}=(CONVERSION_BASED_UNIT('INCH',#{2}) LENGTH_UNIT() NAMED_UNIT(#{3}));",
}

HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('part','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 }'));
ENDSEC;
DATA;
"""
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"


class _Writer:
    """Numbers entities as they are written."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.n = 0

    def add(self, text: str) -> str:
        self.n += 1
        self.lines.append(f"#{self.n}={text};")
        return f"#{self.n}"

    def point(self, p) -> str:
        return self.add(f"CARTESIAN_POINT('',({_numbers(p)}))")

    def direction(self, d) -> str:
        return self.add(f"DIRECTION('',({_numbers(d)}))")

    def vertex(self, p) -> str:
        return self.add(f"VERTEX_POINT('',{self.point(p)})")

    def placement(self, at, z, x) -> str:
        place = f"{self.point(at)},{self.direction(z)},{self.direction(x)}"
        return self.add(f"AXIS2_PLACEMENT_3D('',{place})")

    def line_edge(self, p, q, at_p: str, at_q: str) -> str:
        p, q = np.array(p, float), np.array(q, float)
        vector = self.add(f"VECTOR('',{self.direction((q - p) / np.linalg.norm(q - p))},1.)")
        line = self.add(f"LINE('',{self.point(p)},{vector})")
        return self.add(f"EDGE_CURVE('',{at_p},{at_q},{line},.T.)")

    def loop(self, edges: list[tuple[str, bool]]) -> str:
        oriented = [
            self.add(f"ORIENTED_EDGE('',*,*,{edge},{'.T.' if forth else '.F.'})")
            for edge, forth in edges
        ]
        loop = self.add(f"EDGE_LOOP('',({','.join(oriented)}))")
        return self.add(f"FACE_OUTER_BOUND('',{loop},.T.)")

    def face(self, loop: str, surface: str, same: bool = True) -> str:
        return self.add(f"ADVANCED_FACE('',({loop}),{surface},{'.T.' if same else '.F.'})")

    def plane(self, at, z, x) -> str:
        return self.add(f"PLANE('',{self.placement(at, z, x)})")


def _numbers(values) -> str:
    return ",".join(f"{float(v):.17g}" + ("" if "." in f"{float(v):.17g}" else ".") for v in values)


def box_step(
    size=(10.0, 20.0, 30.0), unit: str = "mm", uncertainty: float = 1e-7, item: str = ""
) -> str:
    """A box with one corner at the origin, and one more item, which may name its {axes} and its {solid}."""
    writer = _Writer()
    corners = [np.array(size) * (i >> 2 & 1, i >> 1 & 1, i & 1) for i in range(8)]
    vertices = [writer.vertex(c) for c in corners]
    edges: dict[tuple[int, int], str] = {}
    faces = []
    for ring in BOX_FACES:
        used = []
        for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
            if (b, a) not in edges and (a, b) not in edges:
                edges[a, b] = writer.line_edge(corners[a], corners[b], vertices[a], vertices[b])
            used.append((edges.get((a, b)) or edges[b, a], (a, b) in edges))
        x = corners[ring[1]] - corners[ring[0]]
        z = np.cross(x, corners[ring[2]] - corners[ring[1]])
        plane = writer.plane(corners[ring[0]], z / np.linalg.norm(z), x / np.linalg.norm(x))
        faces.append(writer.face(writer.loop(used), plane))
    return _document(writer, faces, unit, uncertainty, item)


def cylinder_step(radius=10.0, length=30.0, unit: str = "mm", uncertainty: float = 1e-7) -> str:
    """A cylinder that stands at the origin along z: two ends, and a side with a seam."""
    writer = _Writer()
    low, high = (radius, 0.0, 0.0), (radius, 0.0, length)
    at_low, at_high = writer.vertex(low), writer.vertex(high)
    x, z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    circles = []
    for height, vertex in ((0.0, at_low), (length, at_high)):
        circle = writer.add(f"CIRCLE('',{writer.placement((0, 0, height), z, x)},{radius:.17g})")
        circles.append(writer.add(f"EDGE_CURVE('',{vertex},{vertex},{circle},.T.)"))
    seam = writer.line_edge(low, high, at_low, at_high)
    round_ = writer.add(
        f"CYLINDRICAL_SURFACE('',{writer.placement((0, 0, 0), z, x)},{radius:.17g})"
    )
    bottom, top = circles
    faces = [
        writer.face(
            writer.loop([(bottom, True), (seam, True), (top, False), (seam, False)]), round_
        ),
        writer.face(writer.loop([(bottom, False)]), writer.plane((0, 0, 0), (0, 0, -1), x)),
        writer.face(writer.loop([(top, True)]), writer.plane((0, 0, length), z, x)),
    ]
    return _document(writer, faces, unit, uncertainty)


def _document(
    writer: _Writer, faces: list[str], unit: str, uncertainty: float, item: str = ""
) -> str:
    """A product of one solid, and of one more item of a representation."""
    shell = writer.add(f"CLOSED_SHELL('',({','.join(faces)}))")
    solid = writer.add(f"MANIFOLD_SOLID_BREP('',{shell})")
    first = writer.n + 1
    length, *others = range(first, first + 4)
    writer.lines += _UNITS[unit].format(length, *others).split("\n")
    writer.n = first + 3
    angle = writer.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
    solid_angle = writer.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
    accuracy = writer.add(
        f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({uncertainty:.6E}),#{length},"
        "'distance_accuracy_value','')"
    )
    context = writer.add(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy})) "
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},{angle},{solid_angle})) REPRESENTATION_CONTEXT('',''))"
    )
    axes = writer.placement((0, 0, 0), (0, 0, 1), (1, 0, 0))
    shape = writer.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({axes},{solid}),{context})")
    if item:
        other = writer.add(item.format(axes=axes, solid=solid))
        also = writer.add(f"SHAPE_REPRESENTATION('',({other}),{context})")
        writer.add(f"SHAPE_REPRESENTATION_RELATIONSHIP('','',{shape},{also})")
    application = writer.add("APPLICATION_CONTEXT('automotive design')")
    product_context = writer.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = writer.add(f"PRODUCT('part','part','',({product_context}))")
    formation = writer.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = writer.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = writer.add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    defined = writer.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    writer.add(f"SHAPE_DEFINITION_REPRESENTATION({defined},{shape})")
    return HEAD + "\n".join(writer.lines) + "\n" + TAIL
