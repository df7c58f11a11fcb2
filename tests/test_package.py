"""The package: its public names, what runs without optional libraries, the digest of its sources."""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance import extras
from clearance.batch import keys
from clearance.cli import ExitCode, run
from clearance.formats.files.input_files import resolved
from clearance.package_digest import digest_of_sources
from clearance.planar.dxf import read_dxf
from clearance.receipt import remade_report
from clearance.record import fingerprint
from clearance.world.motion import kinematic_motion
from clearance.world.trajectory import CornerZone
from tests.cells import cell

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


ROOT = Path(__file__).parents[1]
CASE = ROOT / "scenes" / "box_box" / "case.yaml"
WITH_PROFILES = ROOT / "scenes" / "profiles" / "keep_in.yaml"
OPTIONAL = sorted({library for libraries in extras.LIBRARIES.values() for library in libraries})

DISTRIBUTION_OF = {
    "fcl": "python-fcl",
    "pybullet_data": "pybullet",
    "pybullet_utils": "pybullet",
}
"""Of modules that are not named as what is installed."""


@pytest.fixture
def hidden(monkeypatch):
    """Makes libraries look as if they were not installed."""

    def hide(*libraries: str) -> None:
        for library in libraries:
            for name in [name for name in sys.modules if name.partition(".")[0] == library]:
                monkeypatch.delitem(sys.modules, name)
            monkeypatch.setitem(sys.modules, library, None)

    return hide


def test_the_extras_of_the_project_file_bring_the_libraries_that_are_asked_for():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    brought = project["optional-dependencies"]
    for extra, libraries in extras.LIBRARIES.items():
        named = {requirement.partition(">=")[0].lower() for requirement in brought[extra]}
        needed = {DISTRIBUTION_OF.get(library, library) for library in libraries}
        assert named == needed, extra
    of_all = sorted({*extras.LIBRARIES} - {"cad", "mujoco"})  # 200 MB for two formats
    assert brought["all"] == [f"clearance[{','.join(of_all)}]"]
    assert "clearance[all,cad,jit,mujoco]" in brought["test"]


LIBRARY_ALONE = f"""
import sys
for name in {OPTIONAL!r}:
    sys.modules[name] = None
import clearance as cl
away = [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
assert cl.distance(cl.box((1, 1, 1)), cl.box((1, 1, 1)), pose_b=away).distance == 2.0
run = cl.check({str(CASE)!r}, need="pairs")
assert run.passed and run.worst["between"] and "clear" in repr(run) and "<table" in run._repr_html_()
assert run.summary["verdict"] == "clear" and len(run.finding_list.findings) == len(run.findings)
assert all(getattr(cl, name) for name in cl.__all__)
"""


@pytest.mark.cold
def test_distance_and_check_need_no_optional_library():
    done = subprocess.run(
        [sys.executable, "-c", LIBRARY_ALONE], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("command", "extra", "library", "line"),
    [
        (["check", CASE, "--out", "report"], "report", "matplotlib", "--out needs matplotlib"),
        (["check", CASE, "--cross-check"], "crosscheck", "fcl", "--cross-check needs fcl"),
        (["check", CASE, "--motion", "simulated"], "simulate", "pybullet",
         "--motion simulated needs pybullet"),
        (["check", WITH_PROFILES], "profiles", "shapely", "a case with profiles needs shapely"),
        (["profile", "sweep", CASE, "--plane", "xy", "--out", "outline.yaml"], "profiles", "shapely",
         "profile sweep needs shapely"),
        (["workspace", CASE], "contact", "manifold3d", "a shared workspace needs manifold3d"),
        (["batch", CASE, "--out", "store"], "tables", "pyarrow", "clearance batch needs pyarrow"),
    ],
)  # fmt: skip
def test_a_command_refuses_first_what_a_missing_library_could_not_do(
    hidden, capsys, tmp_path, monkeypatch, command, extra, library, line
):
    hidden(library)
    monkeypatch.chdir(tmp_path)
    assert run([*map(str, command)]) == ExitCode.BAD_INPUT
    told = capsys.readouterr()
    assert told.out == "" and list(tmp_path.iterdir()) == []
    assert (
        told.err
        == f"error: {line}, which is not installed; pip install 'clearance[{extra}]' [CL702]\n"
    )


def refused_by(function, *arguments) -> str:
    with pytest.raises(cl.ClearanceError) as caught:
        function(*arguments)
    return str(caught.value)


@pytest.mark.slow
def test_each_door_says_which_extra_it_needs(hidden, tmp_path):
    hidden(*OPTIONAL)
    (tmp_path / "drawing.dxf").write_text("")
    dxf = refused_by(read_dxf, str(tmp_path / "drawing.dxf"))
    assert dxf == "a DXF drawing needs ezdxf, which is not installed; pip install 'clearance[dxf]'"
    robot = refused_by(resolved, "pybullet_data:r2d2.urdf", tmp_path)
    assert robot.endswith("needs the package pybullet_data; pip install 'clearance[simulate]'")
    kept = cl.check(CASE, need="pairs")
    for table in ("steps", "pairs"):
        with pytest.raises(cl.ClearanceError, match=r"needs pyarrow.*'clearance\[tables\]'"):
            getattr(kept, table)
    assert refused_by(kept.save, tmp_path / "report").endswith("pip install 'clearance[report]'")
    assert not (tmp_path / "report").exists()
    for option, extra in (
        ({"cross_check": True}, "crosscheck"),
        ({"motion": "simulated"}, "simulate"),
    ):
        with pytest.raises(cl.ClearanceError, match=rf"pip install 'clearance\[{extra}\]'"):
            cl.check(CASE, **option)


def test_a_library_that_cannot_be_loaded_says_why():
    with pytest.raises(cl.ClearanceError, match=r"cannot be imported \(libGL is missing\)"):
        with extras.importing("report", "the page"):
            raise ImportError("libGL is missing", name="meshcat")


@pytest.fixture
def folder(tmp_path):
    for name, content in (("a.py", "x = 1\n"), ("rooms/b.py", "y = 2\n"), ("rooms/p.yaml", "z: 3")):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(content)
    return tmp_path


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "rooms/b.py").write_text("y = 3\n"),
        lambda folder: (folder / "rooms/p.yaml").write_text("z: 4"),
        lambda folder: (folder / "rooms/page.html").write_text("<p>"),
        lambda folder: (folder / "rooms/b.py").rename(folder / "b.py"),
        lambda folder: (folder / "a.py").unlink(),
    ],
)
def test_whatever_is_changed_it_is_another(folder, change):
    before = digest_of_sources(folder)
    change(folder)
    assert digest_of_sources(folder) != before


def test_what_decides_nothing_does_not_change_it(folder):
    before = digest_of_sources(folder)
    (folder / "rooms/NOTES.md").write_text("notes")
    (folder / "rooms/b.cpython-311.pyc").write_bytes(b"compiled")
    assert digest_of_sources(folder) == before


@pytest.mark.parametrize(
    "room, told",
    [
        (keys, keys.program.__wrapped__),
        (remade_report, remade_report.maker),
        (fingerprint, lambda: fingerprint.fingerprint(cell(0), (), (), ())),
    ],
    ids=["rows of a batch", "report of a receipt", "rows of a long run"],
)
def test_what_other_sources_made_is_not_taken_for_ones_own(room, told, monkeypatch):
    before = told()
    assert told() == before
    monkeypatch.setattr(room, "package_digest", lambda: "0" * 64)
    assert told() != before


def test_rows_of_a_long_run_are_not_those_of_larger_balls():
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    scans = (cl.Obstacle(cl.Body("scan", cl.PointCloud(points, radius))) for radius in (0.01, 0.02))
    cases = (replace(cell(0), obstacles=(scan,), carries=()) for scan in scans)
    assert len({fingerprint.fingerprint(case, (), (), ()) for case in cases}) == 2


def test_rows_of_a_long_run_are_not_those_of_wider_corners():
    placed = next(one for one in cell(0).robots if one.trajectory is not None)
    found = set()
    for end in (0.2, 0.3):
        zone = CornerZone("LIN 1", 0.1, end, 0.02, {})
        cornered = replace(placed, trajectory=replace(placed.trajectory, corners=(zone,)))
        found.add(fingerprint.fingerprint(cell(0), [kinematic_motion(cornered)], (), ()))
    assert len(found) == 2
