"""What holds of every certified run, whatever its joints move on."""

import numpy as np

import clearance as cl


def assert_as_tight_as_asked(run):
    """The bound is within the gap of what was seen, and never above the steps at its ends."""
    certificate = run.record.certificate
    assert (certificate.upper_bound - certificate.lower_bound).max() <= certificate.gap
    clearances = run.record.clearances
    assert (certificate.lower_bound <= clearances).all()
    assert (certificate.lower_bound[:-1] <= clearances[1:]).all()
    assert certificate.lower_bound[-1] == clearances[-1]


def assert_never_above_samples(run, finer, n_worst):
    """The bound of the worst and some other intervals is not above `finer(case, interval, 1000)` sampled."""
    certificate = run.record.certificate
    rng = np.random.default_rng(4)
    n_intervals = len(certificate.lower_bound) - 1
    worst = np.argsort(certificate.lower_bound[:-1])[:n_worst]
    for first in {*worst.tolist(), *rng.choice(n_intervals, n_worst).tolist()}:
        sampled = cl.check(
            finer(run.record.case, first, 1000), certify=False
        ).record.clearances.min()
        assert certificate.lower_bound[first] <= sampled
        assert sampled <= certificate.upper_bound[first] + 1e-4
