"""What a run imports: no more than it uses, and no compiler."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from clearance.compile import decorators
from tests.cli.test_leaving import write_case

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.cold

TELLS = """
import json, sys
{statement}
print("\\n" + json.dumps(sorted(sys.modules)))
"""

OPTIONAL = {"fcl", "manifold3d", "matplotlib", "meshcat", "pybullet", "rosbags", "shapely", "trimesh",
            "ezdxf", "coacd", "dask"}  # fmt: skip


def imported_by(statement: str, folder: Path) -> set[str]:
    """The modules that a process has imported in the end."""
    done = subprocess.run(
        [sys.executable, "-c", TELLS.format(statement=statement)],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return set(json.loads(done.stdout.splitlines()[-1]))


def check(case: Path, *options: str) -> str:
    arguments = ["check", str(case), *options]
    return f"from clearance.cli import run\nassert run({arguments!r}) in (0, 1)"


def test_the_package_alone_imports_nothing_large(tmp_path):
    found = imported_by("import clearance", tmp_path)
    assert not found & {
        *OPTIONAL,
        "numpy",
        "numba",
        "llvmlite",
        "scipy",
        "pyarrow",
        "pydantic",
        "click",
        "rich",
    }


def test_a_missing_case_is_refused_before_anything_large_is_imported(tmp_path):
    refused = "from clearance.cli import run\nassert run(['check', 'none.yaml']) == 2"
    assert not imported_by(refused, tmp_path) & {
        *OPTIONAL,
        "numpy",
        "numba",
        "scipy",
        "pyarrow",
        "pydantic",
    }


@pytest.mark.skipif(decorators.KERNELS == "jit", reason="the compiler is at work")
def test_a_check_imports_no_compiler(tmp_path):
    write_case(tmp_path / "case", None)
    case = tmp_path / "case" / "case.yaml"
    found = imported_by(check(case), tmp_path)
    assert {"numpy", "pydantic"} <= found
    other = {
        "clearance.query.contact",
        "clearance.formats.scene.sdf.scene",
        "clearance.report.page",
    }
    compilers = {"numba", "llvmlite"}
    assert not found & {*OPTIONAL, *other, *compilers, "scipy", "filelock", "pyarrow"}
    found = imported_by(check(case, "--out", "report"), tmp_path)
    assert not found & {*compilers, "scipy", "clearance.query.contact"}
