"""Import closures: every form of import is followed or refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from clearance.import_closure import PACKAGE, UnknownImport, digest_of, import_closure


def _package(folder: Path, **sources: str) -> Path:
    package = folder / "clearance"
    files = {"__init__": "", "rooms/__init__": "", "rooms/b": "", "rooms/c": "", **sources}
    for name, source in files.items():
        path = package / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)
    return package


def _names(package: Path, start: str = "rooms/a") -> set[str]:
    found = import_closure([package / f"{start}.py"], package)
    return {path.relative_to(package).with_suffix("").as_posix() for path in found}


@pytest.mark.parametrize(
    "form",
    [
        "import clearance.rooms.b",
        "import clearance.rooms.b as b",
        "import os, clearance.rooms.b as b",
        "from clearance.rooms import b",
        "from clearance.rooms import b as other",
        "from clearance.rooms import (\n    b,\n)",
        "from clearance.rooms.b import name",
        "from clearance.rooms.b import *",
        "from . import b",
        "from .b import name",
        "from ..rooms.b import name",
        "def f():\n    from clearance.rooms.b import name",
        "try:\n    pass\nexcept ValueError:\n    import clearance.rooms.b as b",
        "match 1:\n    case 1:\n        import clearance.rooms.b as b",
        "if TYPE_CHECKING:\n    pass\nelse:\n    from clearance.rooms import b",
        "from importlib import import_module\nx = [import_module('clearance.rooms.b')]",
        "x = 1; from clearance.rooms import b",
    ],
)
def test_every_form_is_followed(tmp_path, form):
    package = _package(
        tmp_path, **{"rooms/a": form, "rooms/b": "from clearance.rooms.c import name"}
    )
    assert {"rooms/b", "rooms/c", "rooms/__init__"} <= _names(package)


def test_type_checkers_imports_and_other_packages_do_not_count(tmp_path):
    form = "import numpy\nif TYPE_CHECKING:\n    from clearance.rooms import b\nfrom os import path"
    assert _names(_package(tmp_path, **{"rooms/a": form})) == {"rooms/a"}


def test_left_out_rooms_are_not_followed(tmp_path):
    package = _package(tmp_path, **{"rooms/a": "import clearance.shown.d as d", "shown/__init__": "",
                                    "shown/d": "from clearance.rooms import b"})  # fmt: skip
    found = import_closure([package / "rooms/a.py"], package, leave_out=("shown",))
    assert package / "rooms/b.py" not in found
    assert package / "rooms/b.py" in import_closure([package / "rooms/a.py"], package)


@pytest.mark.parametrize(
    "form",
    [
        "import clearance",
        "from clearance import *",
        "import clearance.rooms.missing",
        "from ... import b",
        "from importlib import import_module\nimport_module(name)",
        "import_module('.b', __package__)",
        "__import__('clearance.rooms.b')",
        "exec('import clearance.rooms.b')",
    ],
)
def test_what_cannot_be_followed_is_refused(tmp_path, form):
    package = _package(tmp_path, **{"rooms/a": form})
    with pytest.raises(UnknownImport, match=r"a\.py, line \d"):
        _names(package)


def test_a_digest_knows_content_and_place(tmp_path):
    package = _package(tmp_path)
    b, c = package / "rooms/b.py", package / "rooms/c.py"
    one = digest_of([b], package)
    assert one != digest_of([c], package)
    b.write_text("changed = True\n")
    assert digest_of([b], package) != one


def test_every_file_of_the_package_can_be_followed():
    assert len(import_closure(PACKAGE.rglob("*.py"))) == len([*PACKAGE.rglob("*.py")])
