"""Work in parts on several threads: results in order, few ahead, and nothing goes on behind the caller's back."""

import os
import signal
import time

import pytest

from clearance.simulate.measure.resources import Resources, in_order


def test_nothing_is_worked_on_any_more_when_no_more_is_wanted() -> None:
    started, done = [], []

    def work(span: slice) -> None:
        started.append(span.start)
        time.sleep(0.01)
        done.append(span.start)

    results = in_order(work, [slice(i, i + 1) for i in range(20)], 2)
    next(results)
    results.close()
    assert sorted(started) == sorted(done)
    assert len(done) < 10


@pytest.mark.cold
@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks here")
def test_a_process_forked_after_a_run_on_threads_runs_on_threads_of_its_own() -> None:
    spans = [slice(i, i + 1) for i in range(4)]
    list(in_order(lambda span: span.start, spans, 2))
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        os._exit(0 if list(in_order(lambda span: span.start, spans, 2)) == [0, 1, 2, 3] else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


@pytest.mark.parametrize("fails", [0, 1, 7, 19])
def test_an_error_comes_after_the_results_before_it(fails) -> None:
    def work(span: slice) -> int:
        if span.start == fails:
            raise ValueError(fails)
        time.sleep(0.001)
        return span.start

    results = in_order(work, [slice(i, i + 1) for i in range(20)], 2)
    assert [next(results) for _ in range(fails)] == list(range(fails))
    with pytest.raises(ValueError, match=str(fails)):
        next(results)


def test_progress_of_a_section_ends_with_its_steps_however_its_measurement_counts() -> None:
    seen = []
    own = Resources(progress=lambda done, of: seen.append((done, of))).of_section(1, (10, 20), 30)
    for done in (1, 5, 19):
        own.progress(done, 19)
    assert seen == [(10, 30), (12, 30), (20, 30)]
    assert Resources().of_section(0, (0, 10), 30).progress is None
