"""What hatchling calls when it makes the package: kernels are compiled in the source tree and go into the wheel.

It runs where the package is not installed, so it asks another process to build (`build`). One wheel serves every
Python on a platform; its tag says how old the system's C library may be. `CLEARANCE_LEVELS` names the levels of
processor that a wheel is for, all by default. An editable installation is for this machine alone.
Not for: anything at run time.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

BUILT = "clearance/compile/built"

_BUILD = """
import runpy, sys
sys.path.insert(0, {root!r})
runpy.run_module("clearance.compile.build", run_name="__main__", alter_sys=True)
"""
"""Not by PYTHONPATH: where this tree is installed already, pip's build environment takes it out of the path."""


class KernelBuild(BuildHookInterface):
    """Builds the library of kernels before a wheel is made, or an editable installation."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Builds, and says what of it belongs into the wheel."""
        is_editable = version == "editable"
        self._build([] if is_editable else os.environ.get("CLEARANCE_LEVELS", "all").split())
        folder = Path(self.root, BUILT)
        manifest = json.loads((folder / "manifest.json").read_text())
        if not manifest["is_linked"]:
            build_data["dependencies"].append("llvmlite")
        if is_editable:
            return
        build_data["pure_python"] = False
        files = {folder / name: name for name in manifest["sizes"]}
        build_data["tag"] = f"py3-none-{_platform(file.read_bytes() for file in files)}"
        of_wheel = folder / "manifest-of-wheel.json"
        of_wheel.write_text(json.dumps({**manifest, "is_checked": False}))
        files[of_wheel] = "manifest.json"
        build_data["force_include"] |= {
            str(file): f"{BUILT}/{name}" for file, name in files.items()
        }

    def _build(self, levels: list[str]) -> None:
        ours = ("NUMBA_", "CLEARANCE_KERNELS")
        environment = {
            name: value for name, value in os.environ.items() if not name.startswith(ours)
        }
        done = subprocess.run(
            [sys.executable, "-P", "-c", _BUILD.format(root=str(self.root)), *levels],
            cwd=Path(self.root, BUILT).parent,
            env=environment,
            stdout=sys.stderr,
            check=False,
        )
        if done.returncode != 0:
            sys.exit("error: the kernels cannot be compiled; the lines above say why")


def _platform(libraries: Iterable[bytes]) -> str:
    """This platform, on Linux with the oldest GNU C library (2.N) whose symbols the libraries need."""
    needed = [int(n) for one in libraries for n in re.findall(rb"GLIBC_2\.([0-9]+)", one)]
    tags = list(platform_tags())
    oldest = f"manylinux_2_{max(needed, default=-1)}_"
    fitting = [tag for tag in tags if tag.startswith(oldest)]
    named = [tag for tag in tags if not tag.startswith("linux_")]
    return [*fitting, *named, *tags][0]
