"""An editor and a type checker see every method of a sketch in the class itself."""

import inspect

import pytest

from clearance.sketch import Sketch
from clearance.sketch.constraints import KINDS


def test_a_sketch_inherits_nothing():
    assert Sketch.__bases__ == (object,)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_of_constraint_has_a_method_with_hints_and_a_docstring(kind):
    method = vars(Sketch)[kind]
    parameters = list(inspect.signature(method).parameters.values())[1:]
    assert inspect.getdoc(method) and all(p.annotation is not p.empty for p in parameters)
    assert "name" in {p.name for p in parameters if p.kind is p.KEYWORD_ONLY}
