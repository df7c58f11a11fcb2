"""What a run imports: no more than it uses, and no compiler."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from clearance.compile import decorators
from tests.cart import ROOT, write_cart

TELLS = """
import json, sys
from clearance.cli import run
for arguments in {runs!r}:
    assert run(arguments) in (0, 1)
    print("\\n" + json.dumps(sorted(sys.modules)))
"""


def imported_by(folder: Path, *runs: list[str]) -> list[set[str]]:
    """The modules that a process has imported once it has run each of some commands."""
    done = subprocess.run(
        [sys.executable, "-c", TELLS.format(runs=runs)],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return [set(json.loads(line)) for line in done.stdout.splitlines() if line.startswith('["')]


@pytest.mark.cold
@pytest.mark.skipif(decorators.KERNELS == "jit", reason="the compiler is at work")
def test_a_check_imports_no_compiler_and_no_library_of_what_was_not_asked_for(tmp_path):
    write_cart(tmp_path)
    check = ["check", "case.yaml"]
    found, with_report = imported_by(tmp_path, check, [*check, "--out", "report"])
    assert {"numpy", "pydantic"} <= found
    assert not found & {
        "numba", "llvmlite", "scipy", "pyarrow", "fcl", "manifold3d", "matplotlib", "meshcat", "pybullet",
        "rosbags", "shapely", "trimesh", "ezdxf", "coacd", "dask", "clearance.query.contact",
        "clearance.formats.scene.sdf.scene", "clearance.report.page",
    }  # fmt: skip
    assert not with_report & {"numba", "llvmlite", "scipy", "clearance.query.contact"}
