"""Proves the certified bound of a run again from its receipt and the case's files, by other means.

Nothing that measured or certified takes part: `receipt.proof` does all that decides. Not for: writing receipts.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import field, replace
from os import PathLike
from pathlib import Path

import numpy as np

from clearance import __version__
from clearance.errors import BadInput, BadSyntax, MissingFile, at, shown
from clearance.late_dataclass import dataclass
from clearance.receipt.case_data import CaseData, case_data
from clearance.receipt.claims import judged, missing
from clearance.receipt.proof.depths import depths_reached
from clearance.receipt.proof.halving import halves_of
from clearance.receipt.proof.motion_data import NOT_CLAIMED, UNIT
from clearance.receipt.proof.proving import BadEvidence, Failure, failure_in
from clearance.receipt.receipt_file import DAMAGED, FILE_NAME, EvidenceReader, Receipt, read_receipt
from clearance.receipt.report_told import ROUNDED, Told, overstated, require_report, told_by
from clearance.world.case import Case, Omission


@dataclass(frozen=True)
class Verification:
    """What a receipt comes to.

    Attributes:
        name: of the case. kind: "full" or "sampled".
        failure: what is not proven, first of all; empty if all is.
        bounds: [m] proven of each rule that judges something, over all intervals but those of `n_contact`.
        n_pairs, n_intervals: of the run. n_claimed: intervals of which something is claimed.
        n_contact: how many of those have a bound of 0 or less by some rule, so that nothing is proven of it there.
        data: sha256 of the case's numbers. inputs: path and sha256 of the files that were read again.
        not_read: path and sha256 that inputs of the run had which the case does not name, as tolerances given
            beside it: they are no part of the proof, and whether they are as they were is not known.
        unmeasured: links and pairs that are left out, and why.
        nominal: the case has tolerances, of which the bound takes nothing off.
        n_not_ruled_out: in how many intervals tolerances leave nothing, so that nothing is proven of that.
        below: [m] the fail limit of each of those rules whose bound is below it, as the report has it.
        verdict: of the report.
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
    not_read: tuple[tuple[str, str], ...] = ()
    n_not_ruled_out: int = 0
    below: Mapping[str, float] = field(default_factory=dict)
    verdict: str = ""

    @property
    def proven(self) -> bool:
        """True if all that is claimed is."""
        return not self.failure

    @property
    def headline(self) -> str:
        """One line: what is proven, of what; what is not comes before all figures."""
        sampled = "SAMPLED: " if self.kind == "sampled" else ""
        if self.failure:
            return f"{sampled}NOT PROVEN: {self.failure}"
        nominal = "NOMINAL ONLY, tolerances are not taken off: " if self.nominal else ""
        bounds = ", ".join(self._bound_text(rule) for rule in self.bounds) or "nothing"
        span = f"{self.n_claimed} of {self.n_intervals}" if sampled else f"{self.n_intervals}"
        inputs = f"{len(self.inputs)} inputs unchanged"
        if self.not_read:
            names = ", ".join(shown(path) for path, _ in self.not_read)
            inputs += f", {len(self.not_read)} not read again ({names})"
        return (
            f"{sampled}{nominal}PROVEN{self._left_out}: {bounds} between all {self.n_pairs} pairs over {span} "
            f"intervals of motion; the report's verdict is {self.verdict}; {inputs}, data {self.data[:16]}"
        )

    def _bound_text(self, rule: str) -> str:
        bound = np.floor(self.bounds[rule] * 1e6) / 1e3
        below = f", BELOW ITS LIMIT of {self.below[rule] * 1e3:g} mm" if rule in self.below else ""
        return f"at least {bound:.3f} mm ({shown(rule)}{below})"

    @property
    def _left_out(self) -> str:
        """In how many intervals there is nothing to prove."""
        told = ""
        if self.n_contact:
            told = f" EXCEPT in {self.n_contact} intervals, in which bodies may touch"
        if self.n_not_ruled_out:
            told += f"{' and' if told else ' EXCEPT'} with tolerances in {self.n_not_ruled_out} intervals"
            told += ", in which contact is not ruled out"
        return told


def verify(
    folder: str | PathLike[str],
    case: Case | str | PathLike[str] | None = None,
    tolerance: str | PathLike[str] | None = None,
) -> Verification:
    """Whether the receipt in a report's folder proves the bound that was certified, by arithmetic of its own.

    Args:
        folder: of a report with `receipt.bin`.
        case: the case or its file, where it is not where it was when the receipt was written.
        tolerance: the same of a file of tolerances that was given beside the case.

    Raises:
        BadInput: no receipt, a damaged one, or one of other inputs or another report: which.
    """
    place = Path(folder)
    receipt = read_receipt(place / FILE_NAME)
    require_report(place, receipt)
    told = told_by(place)
    given = case if isinstance(case, Case) else _loaded(place, receipt, case)
    given = _with_tolerance(given, place, receipt, tolerance)
    _require_inputs(given, receipt)
    data = case_data(replace(given, tolerance=None) if receipt.head["nominal"] else given)
    _require_data(data, receipt)
    failure = _failure(data, receipt) or overstated(told, data, receipt)
    inputs, read = _inputs_of(receipt), {source.path for source in given.sources}
    bounds = _bounds(data, receipt.claims)
    n_nominal = len(data.rules) // 2 if data.has_errors else len(data.rules)
    claimed = (receipt.claims != NOT_CLAIMED) & judged(data)
    open_ones = claimed & (receipt.claims <= 0)
    has_tolerances = told.left is not None or given.tolerance is not None
    return Verification(
        name=data.name,
        kind=receipt.head["kind"],
        failure=failure,
        bounds=bounds,
        n_pairs=data.n_pairs,
        n_intervals=data.n_intervals,
        n_claimed=int(claimed.any(axis=0).sum()),
        n_contact=int(open_ones[:n_nominal].any(axis=0).sum()),
        data=data.digest,
        inputs=tuple(one for one in inputs if one[0] in read),
        unmeasured=data.unmeasured,
        nominal=not data.has_errors and (receipt.head["nominal"] or has_tolerances),
        not_read=tuple(one for one in inputs if one[0] not in read),
        n_not_ruled_out=int(open_ones[n_nominal:].any(axis=0).sum()),
        below=_below(bounds, data, told),
        verdict=told.verdict,
    )


def _bounds(data: CaseData, claims: np.ndarray) -> dict[str, float]:
    """[m] what is claimed of each rule wherever that is above 0."""
    above = (claims != NOT_CLAIMED) & (claims > 0) & judged(data)
    return {
        data.rules[i]: float(claims[i, row].min()) * UNIT
        for i, row in enumerate(above)
        if row.any()
    }


def _below(bounds: dict[str, float], data: CaseData, told: Told) -> dict[str, float]:
    """[m] the limits that bounds are below."""
    n_nominal = len(data.rules) // 2 if data.has_errors else len(data.rules)
    found = {}
    for i, rule in enumerate(data.rules):
        limit = told.limits.get(data.rules[i % n_nominal], {"fail": 0.0})["fail"]
        if rule in bounds and bounds[rule] + ROUNDED * UNIT < limit:
            found[rule] = limit
    return found


def _inputs_of(receipt: Receipt) -> tuple[tuple[str, str], ...]:
    """Path and sha256 of all inputs of the run."""
    return tuple((one["path"], one["sha256"]) for one in receipt.head["inputs"])


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


def _loaded(place: Path, receipt: Receipt, case: str | PathLike[str] | None) -> Case:
    from clearance.load.case.case_file import load_case

    if case is None:
        way = receipt.head["case"]
        if not way:
            raise BadInput("the receipt is of a case without a file", valid="give the case")
        path = place / way
        if not os.path.isfile(path):
            raise MissingFile(
                f"there is no {shown(way)}", where=str(place / FILE_NAME), valid="--case CASE.yaml"
            )
        return load_case(path)
    return load_case(case)


def _with_tolerance(
    case: Case, place: Path, receipt: Receipt, tolerance: str | PathLike[str] | None
) -> Case:
    """The case with the file of tolerances that it was measured with, if there was one."""
    from clearance.load.tolerance.tolerance_file import with_tolerance

    way = receipt.head["tolerance"]
    if tolerance is None and not way:
        return case
    path = place / way if tolerance is None else Path(tolerance)
    if not os.path.isfile(path):
        raise MissingFile(
            f"there is no {shown(path.name)}",
            where=str(place / FILE_NAME),
            valid="--tolerance FILE",
        )
    return with_tolerance(case, path)


def _require_inputs(case: Case, receipt: Receipt) -> None:
    """Nothing, if every file that the case is read from is as it was.

    Raises:
        BadSyntax: the first that is not, or was none.
    """
    known = dict(_inputs_of(receipt))
    for source in case.sources:
        if known.get(source.path) != source.sha256:
            problem = "was no input of the run" if source.path not in known else "has changed"
            raise BadSyntax(
                f"it {problem}", where=source.path, valid="the files that the receipt was made of"
            )


def _require_data(data: CaseData, receipt: Receipt) -> None:
    """Nothing, if the numbers of the case are those of the receipt.

    Raises:
        BadSyntax: they are not.
    """
    with at(FILE_NAME):
        if data.digest != receipt.head["data"] or list(data.rules) != receipt.head["rules"]:
            raise BadSyntax(
                f"it is of other numbers than those of case {data.name!r}{_other_version(receipt)}",
                valid="the case that the receipt was made of, with its tolerances",
            )
        if receipt.claims.shape != (len(data.rules), data.n_intervals):
            raise BadSyntax(DAMAGED, valid="claims of every rule and interval")


def _other_version(receipt: Receipt) -> str:
    """That another version wrote the receipt, which may read the same files as other numbers."""
    written, own = receipt.head["version"], __version__
    return "" if written == own else f"; clearance {written} wrote it, this is {own}"
