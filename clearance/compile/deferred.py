"""What only the compiler needs, made when a run first needs the compiler.

Importing numba takes longer than most runs with all their kernels compiled. So decorators leave something in the
place of what they make, and `begin` puts that there. Where numba is imported already, or where a setting of its
own could change what it makes, nothing is deferred. Not for: kernels that Python calls (`ready_kernel`).
"""

from __future__ import annotations

import os
import platform
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

_HARMLESS = {"NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS"}
"""Variables of the environment that change nothing of what is compiled."""


def _is_compiler_needed() -> bool:
    return (
        "numba" in sys.modules
        or (sys.platform, platform.machine()) not in (("linux", "x86_64"),)
        or any(name.startswith("NUMBA_") and name not in _HARMLESS for name in os.environ)
        or Path(".numba_config.yaml").exists()
    )


class DeferredValue:
    """Stands for what `make` gives, until the compiler is needed."""

    def __init__(self, make: Callable[[], Any]) -> None:
        self.make = make

    def made(self) -> Any:
        """What it stands for, the same at each call."""
        if not hasattr(self, "_made"):
            self._made = self.make()
        return self._made


class _State:
    begun = _is_compiler_needed()


_namespaces: dict[int, dict[str, Any]] = {}
_actions: list[Callable[[], Any]] = []
_beginning = threading.RLock()


def is_begun() -> bool:
    """True once the compiler is at work, and nothing is deferred any more."""
    return _State.begun


def defer(namespace: dict[str, Any], make: Callable[[], Any]) -> Any:
    """What `make` gives, or something that stands for it in `namespace`, where `begin` puts it."""
    if _State.begun:
        return make()
    watch(namespace)
    return DeferredValue(make)


def watch(namespace: dict[str, Any]) -> None:
    """Says that something deferred stands in a module."""
    _namespaces[id(namespace)] = namespace


def do_when_begun(action: Callable[[], Any]) -> None:
    """Does something, at once or before anything is compiled."""
    if _State.begun:
        action()
    else:
        _actions.append(action)


def begin() -> None:
    """Puts what was deferred in its place; from now on nothing is."""
    with _beginning:
        if _State.begun:
            return
        import numba  # noqa: F401 - what is made from here on finds it whole

        _State.begun = True
        for action in _actions:
            action()
        for namespace in list(_namespaces.values()):
            for name, value in list(namespace.items()):
                if isinstance(value, DeferredValue):
                    namespace[name] = value.made()
