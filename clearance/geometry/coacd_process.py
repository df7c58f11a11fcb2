"""CoACD in a process of its own, and its adapter: a mesh comes on stdin, parts go to stdout.

The library is compiled code that ends the whole process on some broken meshes; a run must outlive that. This
file is started by path and knows nothing of the package. Not for: importing (`decompose` starts it).
"""

import io
import sys

import numpy as np

SEARCH = {"mcts_nodes": 10, "mcts_iterations": 60, "mcts_max_depth": 2, "resolution": 1000}
"""A search half as wide and deep as CoACD's default: the ways out that it leads to are the same on what
`query/CONTACT.md` measures, lower bounds up to 1 % of the depth weaker; a pipe needs 0.5 s of processor time."""


def _main() -> None:
    import coacd

    given = np.load(io.BytesIO(sys.stdin.buffer.read()))
    _limit_work(int(given["seconds"]))
    coacd.set_log_level("off")
    parts = coacd.run_coacd(
        coacd.Mesh(given["vertices"], given["triangles"]),
        threshold=float(given["threshold"]),
        preprocess_mode="off",
        seed=0,
        **SEARCH,
    )
    written = io.BytesIO()
    np.savez(written, *[np.asarray(corners, dtype=np.float64) for corners, _ in parts])
    sys.stdout.buffer.write(written.getvalue())


def _limit_work(seconds: int) -> None:
    """Ends this process after that much work of its own, on any machine however busy; not on Windows."""
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


if __name__ == "__main__":
    _main()
