"""A kernel that Python calls: from machine code that lies ready in the cache, or by way of the compiler.

Not for: how the code is put into memory (`machine_code`), and how a kernel is compiled (`numba_private`).
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from clearance.compile.deferred import DeferredValue, begin
from clearance.compile.forms import form_of
from clearance.compile.kernel_files import KernelFiles

if TYPE_CHECKING:
    from clearance.compile.machine_code import LoadedEntry

_loading = threading.RLock()


class ReadyKernel(DeferredValue):
    """A kernel as Python has it, where the compiler is not at work yet.

    Args:
        make: gives the compiler's form of it.
        files: where its forms are kept.
    """

    def __init__(
        self, function: Callable, make: Callable[[], Any], files: Callable[[], KernelFiles]
    ) -> None:
        super().__init__(make)
        self.py_func = function
        self.__name__, self.__doc__ = function.__name__, function.__doc__
        self.__module__, self.__qualname__ = function.__module__, function.__qualname__
        self._files, self._ready = files, {}

    @property
    def kept(self) -> KernelFiles:
        """Its files."""
        return self._files()

    def __call__(self, *arguments: object) -> object:
        form = form_of(arguments)
        ready = self._ready.get(form)
        return (self._of_form(form) if ready is None else ready)(*arguments)

    def for_types_of(self, arguments: tuple) -> Any:
        """What is called with arguments of these types, and asks for the types of none."""
        return self._of_form(form_of(arguments))

    def compiled(self) -> Any:
        """The compiler's form; calls for the compiler."""
        begin()
        return self.made()

    def __getattr__(self, name: str) -> Any:
        """What only the compiler's form has."""
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.compiled(), name)

    def loaded(self, form: object) -> LoadedEntry | None:
        """The machine code of a form in memory, or None where none lies ready."""
        entry = self.kept.entry(form)
        if entry is None:
            return None
        from clearance.compile.machine_code import load

        return load(entry)

    def _of_form(self, form: object) -> Any:
        if form is None:
            return self.compiled()
        with _loading:
            if form not in self._ready:
                found = self.loaded(form)
                self._ready[form] = self.compiled() if found is None else found.call
        return self._ready[form]
