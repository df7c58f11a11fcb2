"""A solve that is stopped changes nothing and says what it leaves; one that ends in time never sees the clock."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from clearance.errors import BadDimension
from clearance.sketch import Sketch
from clearance.sketch.effort import TimeLimit
from scripts.makers.point_sketches import irreducible, shaken, sketched, slivered

SKETCHES = Path(__file__).parents[2] / "scenes" / "sketches"


class Clock:
    """Shows 0 s until it has been asked so often, then an hour."""

    def __init__(self, n: float) -> None:
        self.left = n

    def __call__(self) -> float:
        self.left -= 1
        return 0.0 if self.left >= 0 else 3600.0


def cluster(off: float = 0.2) -> Sketch:
    points, edges = irreducible(12, 3)
    return sketched(points, shaken(points, off, 3), edges)


def contradictory() -> Sketch:
    """Four points with all six distances, one of them wrong, and a chain of others."""
    s = Sketch()
    places = [(0.0, 0.0), (1.0, 0.1), (1.1, 1.0), (0.0, 0.9)]
    p = [s.point(*place) for place in places]
    for i, j in itertools.combinations(range(4), 2):
        wrong = 0.3 if (i, j) == (0, 2) else 0.0
        s.distance(p[i], p[j], math.dist(places[i], places[j]) + wrong)
    return s


MADE = {"a numeric cluster": cluster, "slivers": lambda: slivered(30, 0.05, 1)[0]}


def numbers_of(sketch: Sketch) -> np.ndarray:
    return np.array(sketch._lists.numbers)


def solved_with(sketch: Sketch, limit: TimeLimit):
    return sketch._result(*sketch._engine().solve(limit))


@pytest.mark.parametrize("name", MADE)
@pytest.mark.slow
def test_whenever_it_is_stopped_it_is_as_it_was_or_solved_as_ever(name):
    """The clock runs out at every moment at which a search asks for it, one after another."""
    drawn = numbers_of(MADE[name]())
    free = MADE[name]()
    whole = solved_with(free, TimeLimit(math.inf))
    n_stopped = 0
    for n in itertools.count(1):
        sketch = MADE[name]()
        clock = Clock(n)
        found = solved_with(sketch, TimeLimit(10.0, clock))
        if not found.stopped:
            assert found.solved == whole.solved and (numbers_of(sketch) == numbers_of(free)).all()
            break
        n_stopped += 1
        assert not found.solved and (numbers_of(sketch) == drawn).all()
    assert n_stopped >= 1


def test_what_is_left_unsolved_is_said():
    sketch = cluster()
    found = sketch.solve(seconds=0)
    assert (found.status, found.stopped, found.conflicts) == ("unsolved", True, [])
    assert set(found.searched) == set(sketch.constraints)
    assert found.reason.startswith("not solved within 0 s: ")
    assert found.fault == found.reason and found.repairs == []
    assert sketch.solve().solved


def off(sketch: Sketch, placement) -> np.ndarray:
    """How far every distance is off where the points lie as a placement says."""
    gaps = []
    for c in sketch.constraints.values():
        a, b = (placement[e.name] for e in c.entities)
        gaps.append(abs(np.linalg.norm(a - b) - c.number))
    return np.array(gaps)


def drawn_places(sketch: Sketch) -> dict[str, np.ndarray]:
    return {name: e.position for name, e in sketch.entities.items()}


@pytest.mark.parametrize("n", [5, 6, 7])
def test_the_best_placement_by_then_is_reported_with_its_errors_and_what_does_not_close(n):
    sketch = cluster(0.4)
    found = solved_with(sketch, TimeLimit(10.0, Clock(n)))
    assert found.stopped
    gaps = off(sketch, found.best)
    assert gaps.max() < off(sketch, drawn_places(sketch)).max()
    assert list(found.errors.values()) == pytest.approx(gaps, abs=1e-12)
    assert found.residual == pytest.approx(gaps.max())
    wrong = {name for name, error in found.errors.items() if error > 1e-11}
    assert wrong == set(found.searched) == wrong & set().union(*found.unclosed) != set()
    assert all(wrong & set(names) for names in found.unclosed)


def test_an_interrupted_solve_leaves_the_sketch_as_it_was():
    def interrupted() -> float:
        clock()
        if clock.left < 0:
            raise KeyboardInterrupt
        return 0.0

    clock, sketch = Clock(6), cluster()
    drawn = numbers_of(sketch)
    with pytest.raises(KeyboardInterrupt):
        solved_with(sketch, TimeLimit(10.0, interrupted))
    assert (numbers_of(sketch) == drawn).all() and sketch.solve().solved


def test_a_drag_is_stopped_at_any_moment_and_leaves_the_sketch_as_it_was():
    n_stopped = 0
    for n in itertools.count(1):
        s = Sketch()
        p = [s.point(*q) for q in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for i in range(4):
            s.distance(p[i], p[(i + 1) % 4], 1.0)
        s.fix(p[0]), s.fix(p[1])
        drawn = numbers_of(s)
        found = s._result(*s._engine().drag(p[2], (1.6, 0.8), TimeLimit(10.0, Clock(n))))
        if not found.stopped:
            assert found.solved
            break
        n_stopped += 1
        assert not found.solved and (numbers_of(s) == drawn).all() and found.reason
    assert n_stopped >= 1


def test_a_sketch_keeps_its_own_limit_for_solves_and_drags():
    sketch = cluster()
    sketch.most_seconds = 0.0
    assert sketch.solve().stopped
    assert sketch.drag(next(iter(sketch.entities.values())), (9.0, 9.0)).stopped
    assert not sketch.solve(seconds=math.inf).stopped


def test_what_conflicts_is_looked_for_as_long_as_a_solve():
    """The same limit again, for the trials of which constraints conflict, and then for repairs."""
    quick = contradictory()
    assert solved_with(quick, TimeLimit(math.inf)).status == "inconsistent"
    sketch = contradictory()
    found = solved_with(sketch, TimeLimit(10.0, Clock(math.inf)))
    assert not found.solved and not found.stopped
    found._problem.limit = TimeLimit(10.0, Clock(2))
    assert (found.status, found.conflicts) == ("unsolved", [])
    assert set(found.searched) == set(sketch.constraints)


@pytest.mark.parametrize("seconds", [-1.0, math.nan, "10"])
def test_what_is_no_number_of_seconds_is_refused(seconds):
    with pytest.raises(BadDimension, match="seconds is"):
        cluster().solve(seconds=seconds)


def test_the_search_for_other_solutions_ends_with_its_time():
    sketch = Sketch.load(SKETCHES / "bar_length.yaml")
    found = solved_with(sketch, TimeLimit(10.0, Clock(math.inf)))
    found._problem.limit = TimeLimit(10.0, Clock(3))
    assert found.alternatives == []
