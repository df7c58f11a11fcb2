"""In sources that may be edited, a library that does not fit is built before it is used, or nothing is called."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import clearance

SOURCES = Path(clearance.__file__).parent

KERNEL = """
from clearance.compile.decorators import kernel
from clearance.compile.declared import Floats

@kernel
def scaled_sum(numbers: Floats) -> float:
    total = 0.0
    for x in numbers:
        total += 2.0 * x
    return total
"""

ASKS = """
import sys
sys.modules.update({missing!r})
import numpy as np
from clearance.kernels.small import scaled_sum
{meanwhile}
print(scaled_sum(np.arange(4.0)), bool(sys.modules.get("numba")))
"""


class SmallPackage:
    """Sources in a folder, as they stand in an editable installation."""

    def __init__(self, folder: Path) -> None:
        self.root = folder
        self.package = folder / "clearance"
        self.built = self.package / "compile" / "built"
        shutil.copytree(SOURCES / "compile", self.package / "compile",
                        ignore=shutil.ignore_patterns("built", "__pycache__", "*.md"))  # fmt: skip
        for name in ("errors.py", "codes.py", "codes.toml"):
            shutil.copy(SOURCES / name, self.package)
        (self.package / "kernels").mkdir()
        for name in ("__init__.py", "kernels/__init__.py"):
            (self.package / name).touch()
        self.kernel = self.package / "kernels" / "small.py"
        self.kernel.write_text(KERNEL)

    def edit(self, old: str, new: str) -> None:
        """Changes the kernel."""
        source = self.kernel.read_text()
        assert old in source
        self.kernel.write_text(source.replace(old, new))

    @property
    def answer(self) -> str:
        """What the kernel as it stands is to answer, from a process without numba."""
        factor = float(self.kernel.read_text().partition("total += ")[2].partition(" ")[0])
        return f"{6.0 * factor} False"

    def start(
        self, *, without: tuple[str, ...] = (), meanwhile: str = "", **environment: str
    ) -> subprocess.Popen:
        """A process that calls the kernel; `without` modules, and after it has done something `meanwhile`."""
        script = ASKS.format(missing=dict.fromkeys(without), meanwhile=meanwhile)
        settings = {"CLEARANCE_KERNELS": "built", "PYTHONPATH": str(self.root), **environment}
        return subprocess.Popen(
            [sys.executable, "-P", "-c", script], cwd=self.root, env={**os.environ, **settings},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip

    def ask(self, **options) -> tuple[str, str]:
        """What such a process prints, and what it tells."""
        said, told = self.start(**options).communicate(timeout=300)
        return said.strip(), told


pytestmark = [pytest.mark.cold, pytest.mark.slow]


def test_a_clone_that_is_installed_is_built_again(tmp_path, monkeypatch):
    """As pip builds it: each process takes the folder of the editable installation out of its path first."""
    hook = pytest.importorskip("clearance.compile.build_hook")
    made = SmallPackage(tmp_path / "clone")
    (tmp_path / "pip").mkdir()
    (tmp_path / "pip" / "sitecustomize.py").write_text(
        f"import sys\nsys.path = [one for one in sys.path if one != {str(made.root)!r}]\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "pip"))
    hook.KernelBuild(str(made.root), {}, None, None, "", "wheel").initialize("editable", {})
    monkeypatch.delenv("PYTHONPATH")
    assert made.ask(without=("numba", "llvmlite")) == ("12.0 False", "")


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> SmallPackage:
    """A small package whose library two processes have found missing at the same time."""
    made = SmallPackage(tmp_path_factory.mktemp("sources"))
    two = [made.start(), made.start()]
    ends = [process.communicate(timeout=300) for process in two]
    assert [said.strip() for said, _ in ends] == ["12.0 False"] * 2, ends
    told = "".join(told for _, told in ends)
    assert told.count("the kernels are not compiled yet") == 2
    assert told.count("compiling 1 kernels") == 1
    return made


def test_an_edited_kernel_is_compiled_before_it_is_called(built):
    before = {file: file.stat().st_ino for file in built.built.glob("kernels-*")}
    with open(next(iter(before)), "rb") as loaded:
        content = loaded.read()
        built.edit("2.0 * x", "3.0 * x")
        said, told = built.ask()
        assert said == built.answer == "18.0 False"
        assert "have changed since they were compiled" in told and "compiling 1 kernels" in told
        loaded.seek(0)
        assert loaded.read() == content, "what a process has loaded was written over"
    assert all(file.stat().st_ino != inode for file, inode in before.items())


def test_an_edited_kernel_that_cannot_be_compiled_is_not_called(built):
    """It does not compile any longer, or there is no compiler."""
    built.edit("total = 0.0", "total = no_such_thing")
    said, told = built.ask()
    assert said == "" and "clearance_small_scaled_sum does not compile" in told
    assert "the kernels cannot be compiled; the lines above say why" in told.splitlines()[-1]
    said, told = built.ask(without=("numba",))
    assert said == "" and "pip install -e '.[jit]'" in told.splitlines()[-1]
    built.edit("total = no_such_thing", "total = 0.0")


def test_a_process_that_began_before_the_edit_is_to_be_started_again(built):
    edits = f"""
from pathlib import Path
source = Path({str(built.kernel)!r})
source.write_text(source.read_text().replace(".0 * x", ".5 * x"))
"""
    before = built.answer
    said, told = built.ask(meanwhile=edits)
    assert said == before, "the library fits what was imported"
    rebuilds = "import subprocess\nsubprocess.run([sys.executable, '-P', '-m', 'clearance.compile.build'])\n"
    built.edit(".5 * x", ".0 * x")
    said, told = built.ask(meanwhile=edits + rebuilds)
    assert said == "" and "since this process began; start it again" in told.splitlines()[-1]


def test_without_a_linker_llvmlite_links_the_objects(built, tmp_path):
    (built.built / "manifest.json").unlink()
    said, told = built.ask(PATH=str(tmp_path))
    assert said == built.answer and "compiling" not in told
    assert not json.loads((built.built / "manifest.json").read_text())["is_linked"]
