"""The optional libraries: which extra brings each, and the one line that says so where one is missing.

`pip install clearance` brings what measuring needs. The other libraries serve one purpose each and are imported
behind one adapter each, which asks here first. Not for: the dependencies that are always there (`pyproject.toml`).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from clearance.errors import Unavailable

LIBRARIES = {
    "batch": ("dask", "distributed", "pyarrow"),
    "cad": ("cascadio",),
    "contact": ("coacd", "manifold3d"),
    "crosscheck": ("fcl",),
    "dxf": ("ezdxf",),
    "mujoco": ("mujoco",),
    "profiles": ("shapely",),
    "report": ("meshcat", "matplotlib", "pyarrow"),
    "ros": ("rosbags", "xacro"),
    "simulate": ("pybullet", "pybullet_data", "pybullet_utils"),
    "tables": ("pyarrow",),
}
"""The modules that each extra of `pyproject.toml` brings."""


def install(extra: str) -> str:
    """The command that installs an extra."""
    return f"pip install 'clearance[{extra}]'"


def is_installed(library: str) -> bool:
    """Whether a library can be found; it is not imported."""
    return find_spec(library) is not None


def require(extra: str, purpose: str, *libraries: str) -> None:
    """Lets pass where all libraries of an extra are installed; none is imported.

    Args:
        libraries: those that are needed, where not all are.

    Raises:
        Unavailable: one is missing; the message names the purpose and the command that installs it.
    """
    for library in libraries or LIBRARIES[extra]:
        if not is_installed(library):
            raise Unavailable(
                f"{purpose} needs {library}, which is not installed", valid=install(extra)
            )


@contextmanager
def importing(extra: str, purpose: str) -> Iterator[None]:
    """Turns the failure of an import inside into one line: the library is missing, or why it cannot be loaded.

    Raises:
        Unavailable: a library is missing, or cannot be loaded.
    """
    try:
        yield
    except ImportError as error:
        library = (error.name or "a library").partition(".")[0]
        missing = isinstance(error, ModuleNotFoundError)
        fault = "is not installed" if missing else f"cannot be imported ({error})"
        raise Unavailable(
            f"{purpose} needs {library}, which {fault}", valid=install(extra)
        ) from None


class Library:
    """A library of an extra, imported when something of it is first used.

    Raises:
        Unavailable: then, where it is missing or cannot be loaded.
    """

    def __init__(self, name: str, extra: str, purpose: str) -> None:
        self._asked = name, extra, purpose

    def __getattr__(self, name: str) -> Any:
        library, extra, purpose = self._asked
        with importing(extra, purpose):
            return getattr(import_module(library), name)
