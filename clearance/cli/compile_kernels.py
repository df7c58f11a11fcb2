"""`clearance compile`: fills the cache of compiled kernels ahead, as for a container image.

Not for: compiling beside a run that needs them (`compile_ahead`).
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from clearance.cli.rehearsal import CommandCall


@click.command(name="compile")
@click.option(
    "--all", "everything", is_flag=True, help="Also what a check needs only where it is asked to."
)
def compile_kernels(everything: bool) -> int:
    """Compiles the kernels that `clearance check` needs, and says where they lie.

    A check compiles what is not there yet: half a minute the first time on a machine. After this command it finds
    all in the cache: ~/.cache/clearance, or where NUMBA_CACHE_DIR says. With --all also what other needs than
    every step, contact at every step, the paper's method and two clocks need.
    """
    import time

    from clearance.cli.rehearsal import EVERYDAY, THE_REST
    from clearance.errors import Unwritable
    from clearance.kept_files import cache_root

    root = cache_root()
    if root is None:
        raise Unwritable(
            "compiled kernels cannot be kept",
            valid="a folder of this user's that nobody else can write: NUMBA_CACHE_DIR names one",
        )
    begun = time.monotonic()
    _ask([*EVERYDAY, *(THE_REST if everything else ())])
    files = [path for path in root.glob("*/*") if path.suffix in (".kernel", ".entry")]
    n_kernels = sum(path.suffix == ".kernel" for path in files)
    size = sum(path.stat().st_size for path in files) / 1e6
    seconds = time.monotonic() - begun
    click.echo(
        f"{root} holds {n_kernels} compiled kernels, {size:.1f} MB; this took {seconds:.0f} s"
    )
    return 0


def _ask(questions: Sequence[CommandCall]) -> None:
    """Asks all of them in a folder that is gone afterwards.

    Raises:
        RuntimeError: one was not answered.
    """
    import io
    import tempfile

    from clearance.cli import ExitCode, run
    from clearance.cli.rehearsal import write_files

    shows = sys.stderr.isatty()
    with tempfile.TemporaryDirectory() as folder:
        write_files(Path(folder))
        for i, (about, (command, case, *options)) in enumerate(questions, start=1):
            if shows:
                click.echo(f"{i}/{len(questions)}  {about}", err=True)
            arguments = [command, str(Path(folder, case)), *options]
            said = io.StringIO()
            with redirect_stdout(said), redirect_stderr(said):
                code = run(arguments)
            if code not in (ExitCode.CLEAR, ExitCode.VIOLATED):
                raise RuntimeError(f"{about}: {code}\n{said.getvalue()}")
