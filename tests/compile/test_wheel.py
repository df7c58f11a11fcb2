"""A wheel holds compiled kernels and the demo, serves any Python 3 of its platform, and needs no compiler."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from packaging.tags import sys_tags
from packaging.utils import parse_wheel_filename

from clearance.compile.decorators import KERNELS
from clearance.compile.library import processor_level

ROOT = Path(__file__).parents[2]

pytestmark = [
    pytest.mark.cold,
    pytest.mark.slow,
    pytest.mark.skipif(KERNELS != "built", reason="the library is not used"),
    pytest.mark.skipif(
        importlib.util.find_spec("hatchling") is None, reason="hatchling is not installed"
    ),
]

ASKS = """
import sys
sys.modules.update(dict.fromkeys(["numba", "llvmlite"]))
import numpy as np
import clearance as cl
from clearance.compile.manifest import FOLDER
box, pose = cl.box((1.0, 1.0, 1.0)), np.eye(4)
pose[0, 3] = 3.0
print(FOLDER, cl.distance(box, box, pose_b=pose).distance)
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT, check=True, stdout=subprocess.DEVNULL,
        env={**os.environ, "CLEARANCE_LEVELS": processor_level()},
    )  # fmt: skip
    (found,) = folder.iterdir()
    return found


def test_a_wheel_fits_every_python_of_its_platform(wheel):
    _, _, _, tags = parse_wheel_filename(wheel.name)
    (tag,) = tags
    assert (tag.interpreter, tag.abi) == ("py3", "none") and tag.platform != "any"
    assert not tag.platform.startswith("linux_"), "the version of the C library is told"
    assert tag in set(sys_tags())
    if tag.platform.startswith("manylinux_2_"):
        whole = zipfile.ZipFile(wheel)
        libraries = [whole.read(name) for name in whole.namelist() if name.endswith(".so")]
        needed = [int(n) for one in libraries for n in re.findall(rb"GLIBC_2\.(\d+)", one)]
        assert int(tag.platform.split("_")[2]) == max(needed)


def test_a_wheel_holds_the_libraries_and_nothing_else_of_the_build(wheel):
    names = {Path(name).name for name in zipfile.ZipFile(wheel).namelist() if "/built/" in name}
    libraries = {Path(name).stem for name in names - {"manifest.json"}}
    assert libraries == {f"kernels-{processor_level()}"} and "manifest.json" in names


def test_a_distance_is_measured_from_a_wheel_without_a_compiler(wheel, tmp_path):
    zipfile.ZipFile(wheel).extractall(tmp_path)
    done = subprocess.run(
        [sys.executable, "-P", "-c", ASKS], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(tmp_path / "clearance" / "compile" / "built"), "2.0"]


def test_the_demo_runs_from_a_wheel(wheel, tmp_path):
    zipfile.ZipFile(wheel).extractall(tmp_path / "installed")
    brought, ours = tmp_path / "installed" / "clearance" / "demo", ROOT / "clearance" / "demo"
    assert contents(brought) == contents(ours) != {}
    done = subprocess.run(
        [sys.executable, "-P", "-m", "clearance", "demo"], cwd=tmp_path, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(tmp_path / "installed")},
    )  # fmt: skip
    assert done.returncode == 0 and done.stdout.startswith("CLEAR  seam"), done.stderr
    assert (tmp_path / "clearance_demo" / "report.html").is_file()


def contents(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }
