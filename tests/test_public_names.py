"""The public names: the stub that an IDE reads and what the package gives at run time are the same."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import clearance as cl

STUB = ast.parse(Path(cl.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
ROOM_OF = {
    alias.name: f"clearance.{node.module}"
    for node in STUB.body
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
}
LISTED = next(
    ast.literal_eval(node.value)
    for node in STUB.body
    if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
)


def test_the_stub_lists_what_it_imports_and_the_package_offers_the_same():
    assert sorted(LISTED) == LISTED == sorted([*ROOM_OF, "__version__"])
    assert sorted(cl.__all__) == LISTED and set(ROOM_OF) <= set(dir(cl))


@pytest.mark.parametrize("name", sorted(ROOM_OF))
def test_each_name_is_what_its_room_calls_so(name):
    assert getattr(cl, name) is getattr(importlib.import_module(ROOM_OF[name]), name)


def test_an_unknown_name_is_an_attribute_error_that_names_it():
    with pytest.raises(AttributeError, match="distanse"):
        cl.distanse  # noqa: B018


@pytest.mark.cold
def test_importing_the_package_imports_no_large_library():
    heavy = ("numpy", "numba", "scipy", "pyarrow", "pydantic", "lxml", "click", "clearance.formats")
    script = f"import sys, clearance; print([name for name in {heavy!r} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


def public_functions():
    """Each public function, and each method that a public class has of its own, with its name."""
    for name in sorted(ROOM_OF):
        value = getattr(cl, name)
        if not inspect.isclass(value):
            yield name, value
            continue
        for method, made in vars(value).items():
            made = getattr(made, "__func__", getattr(made, "fget", made))
            if inspect.isfunction(made) and not method.startswith("_"):
                yield f"{name}.{method}", made


@pytest.mark.parametrize(("name", "function"), list(public_functions()))
def test_each_public_function_says_what_it_takes_and_gives(name, function):
    signature = inspect.signature(function)
    said = {one.name: one.annotation for one in signature.parameters.values()}
    said["return"] = signature.return_annotation
    open_ones = [one for one, type_ in said.items() if type_ is signature.empty]
    assert set(open_ones) <= {"self", "cls"}, name
