"""Prints what a step costs: ours beside every peer's loop, on the shared cases and on our scenes.

    python scripts/bench/trajectory.py [--scenes NAME ...] [--made] [--csv FILE] [--picture FILE]

Compiled code warm, meshes and trees made outside the clock; milliseconds of CPU a step, median over interleaved
passes; the first run of each pass, which finds the others' data in the processor's caches, is told apart. Loops
without memory are asked for evenly spread steps where all of them would exceed their share of `--seconds`. A peer
that says 0 where we say more than 1 um is counted as false, and the reverse as missed.
`--made` takes the cases of `inputs.made` instead: those in which nothing can be cut, and real robots whose links
are measured against each other and against other robots.
"""

from __future__ import annotations

import harness  # first: it sets the number of threads before numpy is loaded
import inputs
import numpy as np
from harness import Row, Timing, geometric_mean, interleaved, tell, timed
from inputs import Scene
from loops import StepLoop, loops_of
from peers import absent_peers, versions

LIBRARIES = ("fcl", "coal", "klampt")

GROUPS = {
    "fastest of what a peer's user writes first": ("all pairs", "managers", "by spheres"),
    "python-fcl's managers": ("managers",),
    "Klampt with the best so far": ("best so far",),
    "Klampt with bounds carried by hand": ("carried bounds",),
}
"""Endings of the names of loops, by what our time is held against."""

SAME = 1e-9
"""[m] Loops that differ from ours by more measure something else: round shapes where ours have facets."""

FAULT = 1e-6
"""[m] Beyond which a contact is false, or missed."""

SHOWN = (
    "method",
    "ms_per_step",
    "ratio_to_ours",
    "greatest_difference_m",
    "false",
    "missed",
    "steps_asked",
)

SMALLEST = ["--scenes", "box_box", "--seconds", "0.02", "--passes", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(
        __doc__, words, scenes=[], made=True, seconds=0.8, passes=5, picture=""
    )
    tell(*inputs.absent_inputs(), *absent_peers(LIBRARIES))
    rows: list[Row] = []
    for scene in inputs.scenes([*inputs.made()] if asked.made else asked.scenes):
        found = measured(scene, asked.seconds, asked.passes)
        title = f"{scene.name}: {scene.n_triangles} triangles, {len(scene.pairs)} pairs, {scene.n_steps} steps"
        harness.show(title, found, SHOWN)
        rows += found
        harness.write_csv(rows, asked.csv)
    tell(*summary(rows), versions(LIBRARIES))
    if asked.picture:
        from figures import draw_trajectory

        draw_trajectory(rows, asked.picture)
    return rows


def measured(scene: Scene, seconds: float, passes: int) -> list[Row]:
    """One row a loop; ours first."""
    loops = loops_of(scene)
    asked = [steps_for(loop, scene.n_steps, seconds / 3) for loop in loops]
    works = [
        (lambda loop=loop, steps=steps: loop.run(steps))
        for loop, steps in zip(loops, asked, strict=True)
    ]
    timings = interleaved(works, passes, seconds)
    return [
        row_of(scene, loop, steps, timing, timings[0])
        for loop, steps, timing in zip(loops, asked, timings, strict=True)
    ]


def steps_for(loop: StepLoop, n_steps: int, seconds: float) -> np.ndarray:
    """All steps, or for a loop without memory as many, evenly spread, as fit into `seconds`."""
    everything = np.arange(n_steps)
    if loop.coherent:
        return everything
    sample = everything[:: max(1, n_steps // 5)]
    spent, _ = timed(lambda: loop.run(sample))
    n_asked = int(np.clip(seconds / max(spent / len(sample), 1e-9), 8, n_steps))
    return np.unique(np.linspace(0, n_steps - 1, n_asked).round().astype(int))


def row_of(scene: Scene, loop: StepLoop, steps: np.ndarray, timing: Timing, ours: Timing) -> Row:
    """What is known of one loop on one scene; ours is asked for all steps."""
    theirs = np.maximum(timing.answer, 0.0)  # some say -1 for contact
    known = ours.answer[steps]
    per_step, in_all = 1e3 / len(steps), scene.n_steps / len(steps)
    return {
        "scene": scene.name,
        "library": loop.library,
        "method": loop.name,
        "triangles": scene.n_triangles,
        "pairs": len(scene.pairs),
        "steps": scene.n_steps,
        "ms_per_step": timing.median * per_step,
        "ms_least": timing.least * per_step,
        "ms_greatest": timing.greatest * per_step,
        "ms_first": timing.first * per_step,
        "passes": timing.n_passes,
        "steps_asked": len(steps),
        "ratio_to_ours": timing.median / ours.median * in_all,
        "first_ratio_to_ours": timing.first / ours.first * in_all,
        "greatest_difference_m": float(np.abs(theirs - known).max()),
        "false": int(((theirs == 0.0) & (known > FAULT)).sum()),
        "missed": int(((theirs > FAULT) & (known == 0.0)).sum()),
        "counters": " ".join(f"{name}={count}" for name, count in loop.counters.items()),
    }


def summary(rows: list[Row]) -> list[str]:
    """Geometric means of the ratios, and where anybody is faster than we are."""
    lines = []
    alike_rows = [row for row in rows if row["greatest_difference_m"] <= SAME]
    for what, kinds in GROUPS.items():
        ratios = fastest_ratios(rows, kinds)
        if ratios:
            first = geometric_mean(fastest_ratios(rows, kinds, "first_ratio_to_ours"))
            alike = geometric_mean(fastest_ratios(alike_rows, kinds) or [np.nan])
            lines.append(
                f"{what}: {geometric_mean(ratios):.1f} times our time (geometric mean of {len(ratios)} scenes; "
                f"least {min(ratios):.1f}, greatest {max(ratios):.1f}; of the first run of each pass {first:.1f}; "
                f"of loops with our answers to {SAME:g} m {alike:.1f})"
            )
    peers = [row for row in rows if row["library"] != "clearance"]
    quicker = [f"{r['scene']} ({r['method']})" for r in peers if 0 < r["ratio_to_ours"] < 1.0]
    told = (
        f"faster than ours: {', '.join(quicker)}" if quicker else "no peer is faster on any scene"
    )
    return [*lines, told]


def fastest_ratios(
    rows: list[Row], kinds: tuple[str, ...], ratio: str = "ratio_to_ours"
) -> list[float]:
    """For each scene the least `ratio` of the loops whose name ends as one of `kinds`."""
    least: dict[str, float] = {}
    for row in rows:
        if row["library"] != "clearance" and row["method"].endswith(kinds):
            least[row["scene"]] = min(least.get(row["scene"], np.inf), row[ratio])
    return list(least.values())


if __name__ == "__main__":
    main()
