"""Small cases with receipts, and receipts with something changed, checksum and all."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.receipt.case_data import CaseData, case_data
from clearance.receipt.fronts import EvidenceList
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import UNIT
from clearance.receipt.proof.stage import Stage
from clearance.receipt.receipt_file import FILE_NAME, read_receipt, receipt_bytes
from clearance.receipt.search import MOST_ITEMS, EvidenceSearch
from clearance.world.robot import Joint, JointKind, Robot
from tests import cells


def evidence_for(
    stretches, shapes, halves, claims, most_items=MOST_ITEMS, lowest=None
) -> EvidenceList:
    """What proves all that is claimed."""
    search = EvidenceSearch(stretches, shapes, halves, claims, lowest)
    search.foresee(most_items)
    return search.finish(most_items)


def turning_arm(turn: float = 1.2, far: float = 0.9, n_steps: int = 5) -> cl.Case:
    """A bar that turns past a block, a beam and a plate, which it comes nearest to between its samples."""
    joint = Joint("turn", JointKind.REVOLUTE, "base", "bar", np.eye(4), np.array([0.0, 0.0, 1.0]))
    at = np.eye(4)
    at[0, 3] = 0.4
    bar = cl.Body("bar", cl.box((0.8, 0.1, 0.1)).transformed(at))
    robot = Robot("arm", ("base", "bar"), (joint,), (bar,))
    times = np.arange(n_steps) * 0.5
    angles = np.linspace(-turn, turn, n_steps)[:, None]
    block, plate = np.eye(4), np.eye(4)
    block[0, 3], plate[2, 3] = far, -0.3
    return cl.Case(
        "turning_arm",
        (cl.PlacedRobot(robot, cl.Trajectory(times, ("turn",), angles)),),
        (
            cl.Obstacle(cl.Body("block", cl.box((0.1, 0.1, 0.1))), block),
            cl.Obstacle(cl.Body("plate", cl.box((2.0, 2.0, 0.1))), plate),
        ),
        cl.Limits(0.01, 0.02),
    )


@functools.lru_cache
def everything_moves(seed: int) -> cl.Case:
    """Cubics, slides, mounts, tables of poses and parts in hands."""
    return cells.cell(seed, apart=1.5)


def stage_of(data: CaseData, i_stretch: int, claim: float = UNIT) -> Stage:
    """A stretch of a case of which everywhere the same [m] is claimed."""
    claims = np.full((len(data.rules), data.n_intervals), round(claim / UNIT))
    return Stage(data.stretches[i_stretch], data.shapes, halves_of(data.shapes), claims)


def saved(case, folder, kind="full"):
    """The report of a case with its receipt."""
    run = cl.check(case)
    run.save(folder)
    cl.write_receipt(run, folder, kind=kind)
    return case_data(case)


def rewritten(folder, **changes):
    """Writes the receipt in a folder with something else in it, and the checksum that goes with that."""
    path = folder / FILE_NAME
    path.write_bytes(receipt_bytes(replace(read_receipt(path), **changes)))


class Said:
    """Evidence in the order in which it was found."""

    def __init__(self, found: EvidenceList) -> None:
        self._deeds, self._codes = found.all_deeds, found.all_codes

    def deeds(self, n: int) -> np.ndarray:
        own, self._deeds = self._deeds[:n], self._deeds[n:]
        return own

    def codes(self, n: int, most: int) -> np.ndarray:
        own, self._codes[most] = self._codes[most][:n], self._codes[most][n:]
        return own
