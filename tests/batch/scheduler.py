"""A dask scheduler with a worker, as others run one: `python -m tests.batch.scheduler HOST ADDRESS_FILE`."""

from __future__ import annotations

import sys
import threading
from pathlib import Path

if __name__ == "__main__":
    from distributed import LocalCluster

    cluster = LocalCluster(
        n_workers=1, threads_per_worker=1, host=sys.argv[1], dashboard_address=None, memory_limit=0
    )
    place = Path(sys.argv[2])
    place.with_suffix(".new").write_text(cluster.scheduler_address)
    place.with_suffix(".new").replace(place)
    threading.Event().wait()
