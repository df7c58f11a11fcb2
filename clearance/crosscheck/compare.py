"""Our record compared with the peer's answers, step by step, and our witness points against the
bodies.

The size of the scene, to which the tolerance is relative, is the diagonal of the box that contains
every measured body at every step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from clearance.crosscheck.fcl_adapter import peer_name
from clearance.crosscheck.peer_run import PeerAnswers, PeerRun
from clearance.crosscheck.settle import off_body, peer_is_wrong
from clearance.record.record import CrossCheck, Disagreement, Samples
from clearance.record.rule_answer import RuleAnswer
from clearance.record.steps import RunAnswer, StepColumns
from clearance.simulate.measure.sections import SectionAnswer
from clearance.tolerance import CROSS_CHECK
from clearance.world.pairs import Pair

GIVE_UP = 64
"""Steps that exact arithmetic examines, or does not settle, after which it examines no others."""


def compared(
    record: Samples, pairs: Sequence[Pair], progress: Callable[[int, int], None] | None = None
) -> tuple[CrossCheck, np.ndarray]:
    """The comparison of every step of a record with FCL on the same bodies, and the steps that exact arithmetic
    settles for us.

    Args:
        record: what we measured. pairs: those that it is of.
        progress: called with (steps done, all steps) now and then.

    Raises:
        Unavailable: python-fcl cannot be imported.
    """
    run = PeerRun(record, pairs)
    answers = run.measure(progress)
    tolerance = CROSS_CHECK * answers.diagonal + run.point_size
    differences = np.abs(record.clearances - answers.clearances)
    witnesses = _Witnesses(run)
    errors = witnesses.errors()
    for step in np.flatnonzero(errors > tolerance)[:GIVE_UP]:
        errors[step] = witnesses.exact_error(int(step))
    bad = np.flatnonzero(~(differences <= tolerance) | ~(errors <= tolerance))
    settled = _settled(witnesses, answers, bad[errors[bad] <= tolerance], tolerance)
    bad = np.setdiff1d(bad, settled)
    check = CrossCheck(
        peer=peer_name(),
        n_steps=len(differences),
        greatest_difference=float(differences.max()),
        worst_step=int(np.argmax(differences)),
        tolerance=tolerance,
        worst_witness_error=float(errors.max()),
        disagreements=tuple(
            _disagreement(run, answers, int(step), differences[step] <= tolerance, errors[step])
            for step in bad
        ),
        n_settled=len(settled),
        greatest_settled=float(differences[settled].max(initial=0.0)),
    )
    return check, settled


def _settled(
    witnesses: _Witnesses, answers: PeerAnswers, steps: np.ndarray, tolerance: float
) -> np.ndarray:
    """Those of `steps` at which exact arithmetic decides against the peer; gives up after some."""
    settled: list[int] = []
    for n_asked, step in enumerate(steps.tolist()):
        if n_asked - len(settled) >= GIVE_UP:
            break
        if witnesses.refute(answers, step, tolerance):
            settled.append(step)
    return np.array(settled, dtype=np.int64)


def _disagreement(
    run: PeerRun, answers: PeerAnswers, step: int, same_distance: bool, witness_error: float
) -> Disagreement:
    record = run.record
    found, (link, obstacle) = record.rows.row(step), record.sides[:2]
    row = {"link": found[link], "obstacle": found[obstacle]}
    clearance = float(record.clearances[step])
    peer_clearance, i_pair = float(answers.clearances[step]), int(answers.i_pairs[step])
    pair = run.pairs[i_pair]
    if same_distance:
        reason = f"the witness points miss their bodies or the distance by {witness_error:.3g} m"
    else:
        reason = _reason(clearance, peer_clearance, run.collides(step, i_pair))
    return Disagreement(
        step=step, clearance=clearance, peer_clearance=peer_clearance, peer_link=pair.link.name,
        peer_obstacle=pair.other.name, reason=reason, **row,
    )  # fmt: skip


def _reason(ours: float, peers: float, peer_collides: bool) -> str:
    if peers == 0.0:
        doubt = "" if peer_collides else ", though FCL's own collision test finds none"
        return f"the peer says contact{doubt}"
    if ours == 0.0:
        return "we say contact, the peer does not"
    return f"the clearances differ by {abs(ours - peers):.3g} m"


class _Witnesses:
    """How well our witness points realise our clearance and lie on their bodies."""

    def __init__(self, run: PeerRun) -> None:
        self._run = run
        rows, (link, obstacle, *places) = run.record.rows, run.record.sides
        points = np.column_stack([rows.numbers(name) for name in places])
        self._points = {"link": points[:, :3], "obstacle": points[:, 3:]}
        names = (rows.names(side).tolist() for side in (link, obstacle))
        self._names = list(zip(*names, strict=True))
        self._pairs = {(pair.link.name, pair.other.name): pair for pair in run.pairs}

    def errors(self) -> np.ndarray:
        """(n,) [m] for each step the greatest of: error of the realised distance, distance of each
        point from its body. Inside a closed body counts as on it where the clearance is 0."""
        run = self._run
        clearances = run.record.clearances
        realised = np.linalg.norm(self._points["link"] - self._points["obstacle"], axis=1)
        errors = np.abs(realised - clearances)
        for start in range(0, len(errors), 512):
            poses = run.poses(start, min(start + 512, len(errors)))
            for k in range(poses.shape[1]):
                off = self._off_bodies(start + k, poses[:, k], clearances[start + k] == 0.0)
                errors[start + k] = max(errors[start + k], off)
        return errors

    def exact_error(self, step: int) -> float:
        """[m] one of `errors`, its distances from the bodies in rational arithmetic."""
        poses = self._run.poses(step, step + 1)[:, 0]
        clearance = self._run.record.clearances[step]
        pair = self._pairs.get(self._names[step])
        if pair is None or clearance == 0.0:  # then inside is on the body, too
            return max(self._realised(step), self._off_bodies(step, poses, clearance == 0.0))
        link, obstacle = self._points["link"][step], self._points["obstacle"][step]
        return max(
            self._realised(step),
            off_body(link, pair.link, poses[pair.i_mover]),
            off_body(obstacle, pair.other, poses[pair.i_other]),
        )

    def _realised(self, step: int) -> float:
        """[m] how far the distance of the witness points is from the clearance."""
        distance = np.linalg.norm(self._points["link"][step] - self._points["obstacle"][step])
        return float(abs(distance - self._run.record.clearances[step]))

    def refute(self, answers: PeerAnswers, step: int, tolerance: float) -> bool:
        """True if exact arithmetic decides for us against the peer at a step."""
        ours, peers = float(self._run.record.clearances[step]), float(answers.clearances[step])
        pair, i_peer = self._pairs.get(self._names[step]), int(answers.i_pairs[step])
        if pair is None or not np.isfinite([ours, peers]).all():
            return False
        points = np.array([self._points[side][step] for side in ("link", "obstacle")])
        poses = self._run.poses(step, step + 1)[:, 0]
        if peers == 0.0 and self._run.is_nested(step, i_peer):
            return False
        return peer_is_wrong(ours, points, pair, peers, self._run.pairs[i_peer], poses, tolerance)

    def _off_bodies(self, step: int, poses: np.ndarray, contact: bool) -> float:
        pair = self._pairs.get(self._names[step])
        if pair is None:
            return np.inf
        sides = (
            (pair.link, poses[pair.i_mover], self._points["link"][step]),
            (pair.other, poses[pair.i_other], self._points["obstacle"][step]),
        )
        return max(
            side.distance(pose[:3, :3].T @ (point - pose[:3, 3]), solid=contact)
            for side, pose, point in sides
        )


def cross_check(
    answers: Sequence[SectionAnswer], progress: Callable[[int, int], None] | None = None
) -> CrossCheck:
    """The comparison of every step of all sections with FCL; steps are those of the run.

    The clocks of each section are tied: FCL measures one time only.

    Raises:
        Unavailable: python-fcl cannot be imported.
    """
    found = [_of_section(answer, progress) for answer in answers]
    checks = [check for check, _ in found]
    worst = max(checks, key=lambda check: check.greatest_difference)
    return replace(
        worst,
        n_steps=len({step for answer in answers for step in _steps_of(answer)}),
        worst_witness_error=max(check.worst_witness_error for check in checks),
        disagreements=tuple(row for check in checks for row in check.disagreements),
        n_settled=len({step for _, settled in found for step in settled}),
        greatest_settled=max(check.greatest_settled for check in checks),
    )


def _steps_of(answer: SectionAnswer) -> range:
    steps = answer.section.steps
    return range(steps.start, steps.stop)


def _of_section(
    answer: SectionAnswer, progress: Callable[[int, int], None] | None
) -> tuple[CrossCheck, list[int]]:
    """The comparison of a section, and the steps of the run that are settled for us."""
    section, first = answer.section, answer.section.phase.first
    alone = RuleAnswer("", section.in_motion.limits, answer.found)
    judged = RunAnswer((alone,), answer.found, None, answer.found, None)
    case, motions = section.phase.case, section.phase.motions
    samples = Samples(case, motions, StepColumns(case, motions, section.pairs, judged), ())
    found, settled = compared(samples, section.pairs, progress)
    rows = tuple(replace(row, step=row.step + first) for row in found.disagreements)
    moved = replace(found, worst_step=found.worst_step + first, disagreements=rows)
    return moved, (settled + first).tolist()
