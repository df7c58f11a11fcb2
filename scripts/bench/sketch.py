"""Times the sketch solver against its targets, and against slvs where that is installed.

    PYTHONPATH=. python scripts/bench/sketch.py [--peers] [--seeds N] [--csv scripts/bench/results/sketch.csv]

One run, one core; sketches are built outside the clock, a solve includes everything
from the flat lists to the residual. CPU time of this process, which a busy machine does not stretch; fixed
seeds; median, least and greatest of the repetitions.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

# so that it runs from the root without an installation
sys.path.insert(0, str(Path(__file__).parents[2]))

from scripts.bench.sketches.clusters import irreducible_clusters
from scripts.bench.sketches.designs import bars, conflict, midship, separate_rectangles
from scripts.bench.sketches.drawings import drawings
from scripts.bench.sketches.patches import constructions, patches, slivers
from scripts.bench.sketches.table import Table


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--peers", action="store_true")
    arguments.add_argument("--seeds", type=int, default=20)
    arguments.add_argument("--csv", type=Path)
    chosen = arguments.parse_args()
    table = Table()
    patches(table, chosen.peers)
    slivers(table)
    constructions(table)
    drawings(table, chosen.peers)
    midship(table)
    bars(table)
    conflict(table)
    separate_rectangles(table)
    irreducible_clusters(table, chosen.seeds, chosen.peers)
    if chosen.csv:
        table.write(chosen.csv)


if __name__ == "__main__":
    main()
