"""Proves the certified bound of a run again from its receipt and the case's numbers, by other means.

Nothing that measured or certified takes part: `receipt.proof` does all that decides. Not for: writing receipts,
nor the report beside one (`verifying`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np

from clearance.errors import refuse_truth, shown
from clearance.receipt.case_data import CaseData
from clearance.receipt.claims import judged, missing
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.items import depths_reached
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.proof.proving import BadEvidence, Failure, failure_in
from clearance.receipt.receipt_file import EvidenceReader, Receipt
from clearance.record.wording import count
from clearance.world.case import LOOKUP, Case, Limits, Omission
from clearance.world.plausible_recordings import not_proven

ROUNDED = 3
"""Units by which a claim may be below what was certified (`writing.claims_of`)."""


@dataclass(frozen=True)
class Verification:
    """The result of verifying a receipt.

    Attributes:
        name: of the case. kind: "full" or "sampled".
        source: the case's file, or the zip that has it; empty where it was given as an object.
        failure: what is not proven, first of all; empty if all is.
        bounds: [m] proven of each rule that judges something, over all intervals but those of `n_contact`.
        n_pairs, n_intervals: of the run. n_claimed: intervals of which something is claimed.
        n_contact: how many of those have a bound of 0 or less by some rule, so that nothing is proven of it there.
        data: sha256 of the case's numbers. inputs: path and sha256 of the files that were read again.
        unmeasured: links and pairs that are left out, and why.
        nominal: the case has tolerances, of which the bound takes nothing off.
        n_not_ruled_out: in how many intervals tolerances leave nothing, so that nothing is proven of that.
        n_not_followed: in how many intervals joints of a program are not proven to be where the bound has them.
        below: [m] the fail limit of each of those rules whose bound is below it, as the case has it.
        beyond: [m] how much more than is proven the report certifies in some interval, by rule.
        verdict: of the case, answered again. asked: what it rests on besides the case's own file.
        further: what it does not cover, and warnings, one line each.
        not_verified: files of the report that are not as they are made again, and why; empty if all are.
    """

    name: str
    kind: str
    failure: str
    bounds: dict[str, float]
    n_pairs: int
    n_intervals: int
    n_claimed: int
    n_contact: int
    data: str
    inputs: tuple[tuple[str, str], ...]
    unmeasured: tuple[Omission, ...]
    nominal: bool
    n_not_ruled_out: int = 0
    n_not_followed: int = 0
    below: Mapping[str, float] = field(default_factory=dict)
    beyond: Mapping[str, float] = field(default_factory=dict)
    verdict: str = ""
    asked: tuple[str, ...] = ()
    further: tuple[str, ...] = ()
    not_verified: str = ""
    source: str = ""

    def __bool__(self) -> NoReturn:
        refuse_truth(self, "proven")

    @property
    def proven(self) -> bool:
        """True if all that is claimed is."""
        return not self.failure

    @property
    def files(self) -> tuple[tuple[str, str], ...]:
        """The inputs that are files; the others say which file was found for a name."""
        return tuple(one for one in self.inputs if not one[0].startswith(LOOKUP))

    @property
    def headline(self) -> str:
        """One line: the bounds that are proven, for which case; before them a verdict that fails, and all that is
        not proven."""
        sampled = "SAMPLED: " if self.kind == "sampled" else ""
        if self.failure:
            return f"{sampled}NOT PROVEN: {self.failure}"
        if self.verdict and not self.verdict.startswith(("clear", "near")):
            decision = self.verdict.partition(":")[0].partition(",")[0].upper()
            sampled = f"{decision}, as the report says. {sampled}"
        nominal = "NOMINAL ONLY, tolerances are not taken off: " if self.nominal else ""
        bounds = ", ".join(self._bound_text(rule) for rule in self.bounds) or "nothing"
        span = f"{self.n_claimed} of {self.n_intervals}" if sampled else f"{self.n_intervals}"
        not_verified = f", NOT VERIFIED: {self.not_verified}" if self.not_verified else ""
        report = "" if self.not_verified else "; every byte of the report matches a fresh run"
        asked = f" ({'; '.join(self.asked)})" if self.asked else ""
        more = "".join(f"; {one}" for one in self.further)
        return (
            f"{sampled}{nominal}PROVEN{self._exceptions}{not_verified}: {bounds} between all {self.n_pairs} pairs "
            f"over {span} interval{'s' * (span != '1')} of motion; verdict {self.verdict}{asked}{more}{report}; "
            f"{count(len(self.files), 'input')} of {shown(self.source or self.name)} unchanged, "
            f"data {self.data[:16]}"
        )

    def _bound_text(self, rule: str) -> str:
        bound = np.floor(self.bounds[rule] * 1e6) / 1e3
        text = shown(rule)
        if rule in self.below:
            text += f", BELOW ITS LIMIT of {self.below[rule] * 1e3:g} mm"
        if rule in self.beyond:
            beyond = np.ceil(self.beyond[rule] * 1e6) / 1e3
            text += f"; NOT VERIFIED: the report certifies up to {beyond:.3f} mm more"
        return f"at least {bound:.3f} mm ({text})"

    @property
    def _exceptions(self) -> str:
        """In how many intervals there is nothing to prove."""
        exceptions = (
            (self.n_not_followed, "in {} intervals, in which a program is not proven"),
            (self.n_contact, "in {} intervals, in which bodies may touch"),
            (
                self.n_not_ruled_out,
                "with tolerances in {} intervals, in which contact is not ruled out",
            ),
        )
        listed_exceptions = " and ".join(text.format(n) for n, text in exceptions if n)
        return listed_exceptions and f" EXCEPT {listed_exceptions}"


def proven(case: Case, data: CaseData, receipt: Receipt) -> Verification:
    """Whether a receipt proves what it claims of a case, by arithmetic of its own.

    Args:
        case: with the limits that were asked for. data: its numbers, as the receipt is of them.
    """
    bounds, n_nominal = _bounds(data, receipt.claims), n_without_errors(data)
    claimed = (receipt.claims != NOT_CLAIMED) & judged(data)
    open_ones = claimed & (receipt.claims <= 0)
    return Verification(
        name=data.name,
        kind=receipt.head["kind"],
        failure=_failure(data, receipt),
        bounds=bounds,
        n_pairs=data.n_pairs,
        n_intervals=data.n_intervals,
        n_claimed=int(claimed.any(axis=0).sum()),
        n_contact=int(open_ones[:n_nominal].any(axis=0).sum()),
        data=data.digest,
        inputs=tuple({one["path"]: one["sha256"] for one in receipt.head["inputs"]}.items()),
        unmeasured=data.unmeasured,
        nominal=not data.has_errors and case.tolerance is not None,
        n_not_ruled_out=int(open_ones[n_nominal:].any(axis=0).sum()),
        n_not_followed=_n_in(data.times, not_proven(case)),
        below={
            rule: limits.fail
            for rule, limits in limits_of(case, data).items()
            if rule in bounds and bounds[rule] + ROUNDED * UNIT < limits.fail
        },
    )


def _n_in(times: np.ndarray, spans: Sequence[tuple[float, float]]) -> int:
    """How many intervals between times (n,) [s] reach into spans."""
    starts, ends = np.array(spans).reshape(-1, 2).T
    return int(((times[:-1, None] < ends) & (times[1:, None] > starts)).any(axis=1).sum())


def n_without_errors(data: CaseData) -> int:
    """How many of the rules are of no tolerances; those come first."""
    return len(data.rules) // 2 if data.has_errors else len(data.rules)


def limits_of(case: Case, data: CaseData) -> dict[str, Limits]:
    """The limits of each rule, with tolerances too."""
    n = n_without_errors(data)
    return {rule: case.limits.of_rule(i % n) for i, rule in enumerate(data.rules)}


def _bounds(data: CaseData, claims: np.ndarray) -> dict[str, float]:
    """[m] what is claimed of each rule wherever that is above 0."""
    above = (claims != NOT_CLAIMED) & (claims > 0) & judged(data)
    return {
        data.rules[i]: float(claims[i, row].min()) * UNIT
        for i, row in enumerate(above)
        if row.any()
    }


def _failure(data: CaseData, receipt: Receipt) -> str:
    for rule, interval in missing(receipt.claims, data, receipt.head["kind"]):
        return f"nothing is claimed of rule {rule} in interval {interval}"
    evidence = EvidenceReader(receipt)
    try:
        depths = depths_reached(data.stretches, len(data.shapes), EvidenceReader(receipt).deeds)
        halves = halves_of(data.shapes, depths)
        found = failure_in(data.stretches, data.shapes, halves, receipt.claims, evidence)
    except BadEvidence as error:
        return f"the evidence is none: {error}"
    if found is not None:
        return _failure_text(data, receipt, found)
    return "" if evidence.at_end else "the evidence is not of this case: some is left over"


def _failure_text(data: CaseData, receipt: Receipt, failure: Failure) -> str:
    stretch = data.stretches[failure.stretch]
    names = " and ".join(data.shapes[body].name for body in stretch.pairs[failure.pair].tolist())
    claim = receipt.claims[stretch.rules[failure.pair], failure.interval] * UNIT
    last = min(failure.interval + 1, len(data.times) - 1)
    start, end = data.times[failure.interval], data.times[last]
    return (
        f"{names} in interval {failure.interval} ({start:.3f} to {end:.3f} s), claimed {claim * 1e3:.3f} mm: "
        f"{failure.reason}"
    )
