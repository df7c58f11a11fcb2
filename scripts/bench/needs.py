"""Prints what each `need`, a certificate and a second thread cost, in parts of our own `steps`.

    python scripts/bench/needs.py [--scenes NAME ...] [--passes N] [--csv FILE]

Seconds on the wall, since threads are among what is measured: the least of interleaved passes, one thread
unless two are said. python-fcl's all pairs are asked for some steps only and told for all of them.
"""

from __future__ import annotations

from collections.abc import Callable

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import Row, geometric_mean, least_on_wall, tell
from inputs import Scene, absent_inputs, scenes
from loops import AllPairs
from peers import Fcl, available

from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import NEEDS, measure
from clearance.simulate.measure.resources import Resources
from clearance.tolerance import CERTIFY_GAP

N_ASKED = 8
"""Steps at which python-fcl is asked for all pairs."""

COUNTED = ("queries", "node_tests", "polygon_tests")

SMALLEST = ["--scenes", "box_box", "--passes", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, scenes=[], passes=9)
    tell(*absent_inputs())
    rows: list[Row] = []
    for scene in scenes(asked.scenes):
        found = rows_of(scene, asked.passes)
        harness.show(scene.name, found)
        rows += found
        harness.write_csv(rows, asked.csv)
    for what in dict.fromkeys(row["what"] for row in rows):
        ratios = [row["ratio_to_steps"] for row in rows if row["what"] == what]
        told = f"{geometric_mean(ratios):.3g} ({min(ratios):.3g} to {max(ratios):.3g})"
        tell(f"{what}: {told}{'' if '/' in what else ' of steps'}, {len(ratios)} scenes")
    return rows


def rows_of(scene: Scene, passes: int) -> list[Row]:
    """What everything costs on one scene."""
    found = least_on_wall(works_of(scene), passes)
    seconds = {what: spent for what, (spent, _) in found.items()}
    ratios = {}
    if "FCL all pairs" in seconds:
        seconds["FCL all pairs"] *= scene.n_steps / N_ASKED
        ratios["FCL all pairs / pairs"] = seconds["FCL all pairs"] / seconds["pairs"]
    ratios = {what: spent / seconds["steps"] for what, spent in seconds.items()} | ratios
    return [
        {
            "scene": scene.name, "what": what, "seconds": seconds.get(what), "ratio_to_steps": ratio,
            **{name: found[what][1].get(name) if what in found else None for name in COUNTED},
        }
        for what, ratio in ratios.items()
    ]  # fmt: skip


def works_of(scene: Scene) -> dict[str, Callable[[], dict]]:
    """What is measured, by name; bodies are laid out each time. Each answers its counters."""

    def in_motion() -> PairsInMotion:
        return PairsInMotion(scene.case, scene.motions, scene.pairs)

    def ours(need: str, jobs: int) -> Callable[[], dict]:
        return lambda: measure(in_motion(), need, Resources(jobs=jobs)).tally

    found = measure(in_motion(), resources=Resources(jobs=1))

    def certified() -> dict:
        certify_motion(in_motion(), found, CERTIFY_GAP, resources=Resources(jobs=1))
        return {}

    works = {need: ours(need, 1) for need in NEEDS}
    works["steps, 2 threads"] = ours("steps", 2)
    works["certificate to 0.1 mm"] = certified
    if available("fcl"):
        peer = AllPairs(scene, Fcl())
        sample = np.linspace(0, scene.n_steps - 1, N_ASKED).round().astype(int)
        works["FCL all pairs"] = lambda: (peer.run(sample), peer.counters)[1]
    return works


if __name__ == "__main__":
    main()
