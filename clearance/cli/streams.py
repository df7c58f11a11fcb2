"""Standard input, output and error as the shell has left them: closed, full or no text; and the way out.

Not for: what is said on them.
"""

from __future__ import annotations

import atexit
import errno
import io
import os
import sys
import warnings
from contextlib import suppress
from typing import NoReturn


def make_streams_safe() -> None:
    """Makes sure that nothing else is taken for one of the three, and that no character stops a line.

    A file opened later would get the number of one that is closed, and what libraries print would go into it.
    Output that is closed still cannot be written, and says so; where errors cannot be written, they are not. A
    warning is one line, like an error.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free
    if sys.stdout is None:
        sys.stdout = _ClosedStream()
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    warnings.formatwarning = _in_one_line


def _in_one_line(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    line: str | None = None,
) -> str:
    return f"warning: {message}\n"


class _ClosedStream(io.TextIOBase):
    """Output that the shell has closed."""

    encoding = "utf-8"

    def writable(self) -> bool:
        return True

    def write(self, text: str) -> int:
        raise OSError(errno.EBADF, "standard output is closed")


def leave(code: int) -> NoReturn:
    """Ends this process, whatever its threads and those of libraries are doing.

    The interpreter's own end waits for threads, then takes away from under those of libraries what they run on.
    """
    if sys.getprofile() is not None or sys.gettrace() is not None:
        sys.exit(code)  # who measures writes its results afterwards
    with suppress(Exception):
        atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()
    os._exit(code)
