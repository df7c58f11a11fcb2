"""A package of one small kernel and the room that compiles it, to be edited and asked in processes of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

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
        shutil.copy(SOURCES / "errors.py", self.package)
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
