"""Every row of the table of shapes: what files make of it, and that the public names and the guide have it."""

import re
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.geometry.shapes import SHAPES, Measure
from tests.formats.making import ARM
from tests.formats.making_case import load_small, with_obstacle

EXAMPLE = {
    Measure.LENGTH: 0.25,
    Measure.LENGTH_OR_ZERO: 0.125,
    Measure.SIZES: [0.5, 0.25, 0.125],
    Measure.POINTS: [[0, 0, 0], [1, 0, 0]],
    Measure.SIDES: 12,
}


def example(name: str, **more) -> dict:
    return {key: EXAMPLE[measure] for key, measure in SHAPES[name].dimensions.items()} | more


def written(name: str, given: dict) -> str:
    return f"{name}: {{{', '.join(f'{key}: {value}' for key, value in given.items())}}}"


def same(shape, other) -> bool:
    return np.array_equal(shape.vertices, other.vertices) and shape.excess == other.excess


@pytest.mark.parametrize("name", SHAPES)
def test_a_case_file_makes_what_python_makes(tmp_path, name):
    given = example(name, length=0.5) if "length" in SHAPES[name].optional else example(name)
    body = load_small(tmp_path, with_obstacle(written(name, given))).obstacles[0].body
    assert body.origin == name and body.shape.closed
    assert same(body.shape, getattr(cl, name)(**given))


@pytest.mark.parametrize("name", [name for name, shape in SHAPES.items() if shape.in_urdf])
def test_a_urdf_makes_what_python_makes(tmp_path, name):
    def text(value):
        return " ".join(map(str, value)) if isinstance(value, list) else str(value)

    attributes = " ".join(f'{key}="{text(value)}"' for key, value in example(name).items())
    urdf = ARM.replace('<box size="0.2 0.2 0.2"/>', f"<{name} {attributes}/>")
    assert urdf != ARM or name == "box"
    body = load_small(tmp_path, urdf=urdf).robots[0].robot.bodies[0]
    assert body.origin == name
    assert same(body.shape, getattr(cl, name)(**example(name)))


@pytest.mark.parametrize("name", SHAPES)
def test_what_is_missing_or_no_length_is_refused_where_it_stands(tmp_path, name):
    for key, measure in SHAPES[name].dimensions.items():
        given = example(name)
        bad = [1, 1] if measure is Measure.SIZES else -1
        for faulty in ({k: v for k, v in given.items() if k != key}, given | {key: bad}):
            with pytest.raises(BadInput) as caught:
                load_small(tmp_path, with_obstacle(written(name, faulty)))
            assert f"scene.obstacles[0].{name}" in str(caught.value) and key in str(caught.value)


def test_every_radius_is_held_against_what_radii_usually_are():
    given = {name: shape.radius for name, shape in SHAPES.items() if shape.radius}
    assert given == dict.fromkeys(("sphere", "cylinder", "capsule"), "radius") | {
        "pipe": "outer_radius"
    }


def test_the_public_names_and_the_guide_have_every_shape():
    guide = (Path(__file__).resolve().parents[2] / "scripts" / "docs" / "case_file.md").read_text()
    for name, shape in SHAPES.items():
        assert getattr(cl, name) is shape.maker and name in cl.__all__
        rows = re.findall(rf"^\| `{name}` \| (.*) \| .* \|$", guide, flags=re.MULTILINE)
        assert rows, f"no row of {name}"
        assert all(f"`{key}" in row for key in shape.dimensions for row in rows)
