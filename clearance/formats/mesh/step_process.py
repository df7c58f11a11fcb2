"""Open CASCADE in a process of its own, and its adapter: a STEP file comes on stdin, a GLB goes to stdout.

The library is compiled code that ends the whole process on some broken files, and writes what it thinks of others
to stdout. This file is started by path and knows nothing of the package. Not for: importing (`step_file` starts
it).
"""

import os
import sys

MOST_MEMORY = 4 << 30
"""[bytes] of data."""


def _main(deflection_mm: float, turn: float, seconds: int) -> None:
    answer = os.dup(1)
    os.dup2(2, 1)  # whatever the library prints
    _limit_work(seconds)
    sys.modules["trimesh"] = None  # type: ignore[assignment]  # only asked for, in 0.7 of 0.9 s
    import cascadio

    made = cascadio.load(
        sys.stdin.buffer.read(),
        "step",
        tol_linear=deflection_mm,
        tol_angular=turn,
        merge_primitives=True,
        use_parallel=False,
        include_brep=True,
    )
    with os.fdopen(answer, "wb") as out:
        out.write(made or b"")


def _limit_work(seconds: int) -> None:
    """Ends this process after that much work of its own, on any machine however busy; not on Windows."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = MOST_MEMORY if hard == resource.RLIM_INFINITY else min(hard, MOST_MEMORY)
    resource.setrlimit(resource.RLIMIT_DATA, (most, hard))


if __name__ == "__main__":
    _main(float(sys.argv[1]), float(sys.argv[2]), int(sys.argv[3]))
