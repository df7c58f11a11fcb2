"""The command line: one file a command, and here what they share: exit codes and one-line errors.

Exit codes: 0 clear; 1 a limit is violated, or a waiver is unused or expired; 2 bad input, or suspect input;
3 the cross-check disagrees; 4 incomplete, of several cases some have no answer yet (each puts those before it in
doubt, so the greatest that holds goes); 70 a fault of this program, with its traceback; 130 interrupted.
"""

from __future__ import annotations

import atexit
import io
import os
import sys
import warnings
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from enum import IntEnum
from typing import NoReturn

from clearance.codes import code_of_error, coded


class ExitCode(IntEnum):
    """The exit codes, which the shell reads."""

    CLEAR = 0
    VIOLATED = 1
    BAD_INPUT = 2
    DISAGREES = 3
    INCOMPLETE = 4
    FAULT = 70  # EX_SOFTWARE: Python's own 1 would read as a violated limit
    INTERRUPTED = 130
    PIPE_CLOSED = 141


QUIET = frozenset({"--quiet", "--brief", "-q", "--json"})
"""Options with which nobody hears how far a command is."""


COMPLETE = "_CLEARANCE_COMPLETE"
"""The variable by which a shell asks for completions, as click has it."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line and leaves with its exit code."""
    make_streams_safe()
    leave(int(run(sys.argv[1:] if arguments is None else arguments)))


def run(arguments: Sequence[str]) -> int:
    """The exit code of the command line `arguments`, after doing what they say."""
    try:
        return _dispatch(list(arguments))
    except KeyboardInterrupt:
        _say("interrupted")
        return ExitCode.INTERRUPTED
    except BrokenPipeError:  # the reader of our output left, as in `clearance check … | head -1`
        return ExitCode.PIPE_CLOSED
    except SystemExit as left:  # rich leaves with 1 for the same reason: our "violated"
        if isinstance(left.__context__, BrokenPipeError):
            return ExitCode.PIPE_CLOSED
        raise
    except OSError as error:
        _say(coded(f"error: {_shown(error)}", code_of_error(type(error))))
        return ExitCode.BAD_INPUT
    except Exception as error:
        import traceback

        with suppress(OSError):
            traceback.print_exc()
        message = "error: a fault of this program, not of the input; please report the lines above"
        _say(coded(message, code_of_error(type(error))))
        return ExitCode.FAULT


def _dispatch(arguments: list[str]) -> int:
    import click

    from clearance.cli.commands import clearance
    from clearance.errors import ClearanceError, Incomplete
    from clearance.progress import never_silent

    if COMPLETE in os.environ:  # a shell asks how a command line may go on
        from click.shell_completion import shell_complete

        return shell_complete(clearance, {}, "clearance", COMPLETE, os.environ[COMPLETE])
    try:
        _require_text(arguments)
        with clearance.make_context("clearance", arguments) as context:
            with (
                nullcontext()
                if QUIET & {*arguments}
                else never_silent(lambda: f"{arguments[0]} goes on")
            ):
                code = clearance.invoke(context)
        sys.stdout.flush()
        return code or ExitCode.CLEAR
    except click.exceptions.Exit as leave:
        sys.stdout.flush()
        return leave.exit_code
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return ExitCode.BAD_INPUT
    except click.ClickException as error:
        message = f"error: {' '.join(error.format_message().split())}{_hint(error)}"
        _say(coded(message, code_of_error(type(error))))
        return ExitCode.BAD_INPUT
    except Incomplete as error:
        _say(f"incomplete: {error.line}")
        return ExitCode.INCOMPLETE
    except ClearanceError as error:
        _say(f"error: {error.line}")
        return ExitCode.BAD_INPUT


def _require_text(arguments: list[str]) -> None:
    for argument in arguments:
        if not _is_text(argument):
            from clearance.errors import BadSyntax

            raise BadSyntax(
                f"{argument!a} is not UTF-8 text", valid="rename the file, or spell it in UTF-8"
            )


def _is_text(argument: str) -> bool:
    try:
        argument.encode()
    except UnicodeEncodeError:  # bytes that were no text stand in it as lone surrogates
        return False
    return True


def _shown(error: OSError) -> str:
    """One line on a place that the system refuses; output that goes nowhere has none."""
    reason = error.strerror or str(error) or type(error).__name__
    place = "the output cannot be written" if error.filename is None else ascii(str(error.filename))
    return f"{place:.300}: {reason}"


def _hint(error: Exception) -> str:
    context = getattr(error, "ctx", None)
    if context is None:
        return ""
    return f" (see {' '.join(context.command_path.split())} --help)"


def _say(line: str) -> None:
    with suppress(OSError):
        print(line, file=sys.stderr, flush=True)


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
        sys.stdout = open(os.devnull)  # which refuses what is written
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
