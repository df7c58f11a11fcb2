"""What a run has come to, for who asked: verdict, worst moment, events, tables, and a report on disk.

Not for: finding it (`answers`), nor how a report looks (room `report`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from clearance.errors import BadInput, Unavailable, refuse_truth
from clearance.extras import is_installed, require
from clearance.record.certificate import Certificate
from clearance.record.moment import Moment
from clearance.record.names import LINK_AND_OBSTACLE, SIDES, columns_of
from clearance.record.record import CrossCheck, PairMinimum, Record
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows

if TYPE_CHECKING:
    import pyarrow as pa

    from clearance.findings.comparison import Comparison
    from clearance.findings.finding import Finding
    from clearance.findings.findings_file import FindingList
    from clearance.findings.judgement import Judgement
    from clearance.findings.verdict import Verdict
    from clearance.record.levels import Event
    from clearance.record.replay import Replay
    from clearance.report.model import ReportModel
    from clearance.report.notebook import ShownPage
    from clearance.report.output import Drawings
    from clearance.run.question import Question
    from clearance.run.session import RunSession


@dataclass(frozen=True, eq=False)
class Run:
    """A case and its answer.

    Attributes:
        session: what works out on demand what the record leaves open.
        rows: where what the record shows of its rows is kept; the report is written by way of it.
        question: what was asked.
    """

    record: Record
    session: RunSession
    question: Question
    rows: MeasuredRows = IN_MEMORY

    @cached_property
    def steps(self) -> pa.Table:
        """One row a step, as `Record.steps`, with penetration [m] and volume [m3] of contacts.

        Both are null at steps with pairs in contact that are not worked out, and upper bounds where not exact.
        With tolerances, `proven_between` [m] is the bound of the motion from the step to the next.

        Raises:
            Unavailable: pyarrow is not installed.
        """
        from clearance.budget.columns import with_proven_between
        from clearance.record.contact_columns import with_contact_columns

        record = self.record
        with_contacts = with_contact_columns(record.rows, record.contacts)
        return with_proven_between(with_contacts, record.budget).arrow()

    @property
    def pairs(self) -> pa.Table | None:
        """One row a step and pair, columns as in `EveryPair.table`; None unless that was asked for."""
        every = self.record.every_pair
        return None if every is None else every.table

    @property
    def worst(self) -> dict:
        """The most critical moment, as a row of `steps`: worst against its rule, or least clearance without rules.

        Beside waivers it is of what decides the verdict. `nearest` has the least clearance, also beside rules.

        Bodies have both names of their columns: `link` and `body_a`, `obstacle` and `body_b`. If the certificate
        found a worse moment between two steps, `between` is true and `step` is the step before it. In contact it
        is the deepest moment, with its `penetration` if that is known.
        """
        return self._of_moment(self.verdict.worst)

    @property
    def nearest(self) -> dict:
        """The moment of least clearance of all pairs, as `worst` has it, whatever judges or waives it."""
        return self._of_moment(self.record.nearest)

    @property
    def worst_sample(self) -> dict:
        """The row of the most critical step, with the status of that step alone: the deepest in contact, else
        the first."""
        return self._of_moment(self.verdict.worst_sample)

    def _of_moment(self, moment: Moment) -> dict:
        """The row of a moment's step, with what is so at that moment of its pair."""
        row = self._row(moment.step)
        measured = {"time": moment.time, "clearance": moment.clearance, "rule": moment.rule}
        measured |= {"between": moment.between, "status": self.record.status_of(moment)}
        for sides in (SIDES, LINK_AND_OBSTACLE):
            measured |= _measured_columns(sides, moment)
        if "time_b" in row:
            measured["time_b"] = moment.time_b
        if "move" in row:
            measured["move"] = self.record.moves.at(moment.time) or None
        if moment.depth is not None:
            measured["penetration"] = moment.depth.penetration
        return row | measured

    def _row(self, step: int) -> dict:
        row = self.record.rows.row(step)
        columns = zip(columns_of(LINK_AND_OBSTACLE), columns_of(SIDES), strict=True)
        row = {name: row[side] for name, side in columns} | row
        if row.get("between"):
            known = row["clearance"]
            rule = self.record.rule(row["rule"])
            moment = None if known is None else self.session.moment_at(rule, step)
            status = None if moment is None else self.record.status_of(moment)
            row |= {"between": False, "status": status}
        return row

    @property
    def pair_minima(self) -> tuple[PairMinimum, ...]:
        """The least clearance of each pair at the steps, least first; empty if `need` asks for less."""
        return self.session.pair_minima()

    @cached_property
    def report(self) -> ReportModel:
        """What the run comes to, for whoever tells it; each part is worked out when it is asked for."""
        from clearance.report.model import ReportModel

        return ReportModel(self.session)

    @property
    def judgement(self) -> Judgement:
        """The rules of the run with its waivers."""
        return self.report.judgement

    @property
    def of_tolerances(self) -> tuple[Finding, ...]:
        """The limits that are not proven with the case's tolerances."""
        return self.report.of_tolerances

    @property
    def verdict(self) -> Verdict:
        """What the run comes to, why, and what that rests on."""
        return self.report.verdict

    @property
    def passed(self) -> bool:
        """True if nothing is in contact or below the fail limit, at the steps or as far as proven between them,
        every profile is kept, no input is suspect and no peer disagrees."""
        return self.verdict.passed

    @property
    def status(self) -> str:
        """The worst of "clear", "near", "violated" and "contact"; "violated" where a sweep does not keep to a
        profile of the case; "suspect" where input is in doubt and the case does not accept it."""
        return self.verdict.status

    @property
    def events(self) -> list[Event]:
        """The moments at which a limit was entered or left, in order of time."""
        return self.session.events

    @property
    def summary(self) -> dict[str, Any]:
        """What `summary.json` holds, as plain data."""
        from clearance.report.summary import summary_of

        return summary_of(self.report)

    @property
    def certificate(self) -> Certificate | None:
        """What is proven of the motion between the steps; None where only the samples were looked at."""
        return self.record.certificate

    @property
    def cross_check(self) -> CrossCheck | None:
        """How a peer's answers compare, if that was asked for."""
        return self.record.cross_check

    def __bool__(self) -> NoReturn:
        refuse_truth(self, "passed")

    def __reduce__(self) -> NoReturn:
        raise BadInput("a Run cannot be pickled or copied", valid="run.record, or run.summary")

    def __repr__(self) -> str:
        from clearance.report.notebook import run_text

        return f"<Run {run_text(self.report)}>"

    def __str__(self) -> str:
        """The same, with what must be known beside it below."""
        return "\n  ".join((repr(self), *self.verdict.reservations))

    def _repr_html_(self) -> str:
        """The verdict and the closest pairs, for a notebook."""
        from clearance.report.notebook import run_html

        return run_html(self.report)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What each rule comes to between which bodies, the worst first; what is waived is among it."""
        return self.report.findings

    @property
    def finding_list(self) -> FindingList:
        """What `findings.json` holds: the findings, and what is needed to compare them with another run's."""
        return self.report.finding_list

    def save(
        self,
        folder: str | Path,
        comparison: Comparison | None = None,
        *,
        earlier: Run | None = None,
    ) -> Path:
        """Writes steps.parquet, steps.csv, findings.json, summary.json and report.html into `folder`; returns it.

        Args:
            comparison: with a baseline, for the page. earlier: a run of the same bodies before a change, which the
                replay shows as well.

        Raises:
            BadInput: no path. Unwritable: nothing is left half-written.
        """
        from clearance.report.output import write

        if not isinstance(folder, str | PathLike) or not str(folder):
            raise BadInput(f"the folder is {folder!r:.60}", valid="a path of a folder is needed")
        write(self.report, self._drawn(earlier), folder, self.rows, comparison)
        return Path(folder)

    def _drawn(self, earlier: Run | None = None) -> Drawings:
        from clearance.report.output import Drawings

        replay = self.replay()
        before = [] if earlier is None else earlier.session.earlier_motion(replay)
        return Drawings(replay, self.session.pictures, before)

    def replay(self) -> Replay:
        """The drawing data of the run."""
        return self.session.replay(self.rows, self.verdict.worst)

    def page(self) -> str:
        """`report.html`, the page of the report.

        Raises:
            Unavailable: a library of the extra `report` is missing.
        """
        require("report", "the page")
        from clearance.report.output import page_text

        return page_text(self.report, self._drawn(), self.rows)

    def show(self, height: int = 800) -> ShownPage:
        """The page of the report, with verdict, curve and replay: a notebook shows it, else the browser opens it.

        Args:
            height: in a notebook [pixels].

        Raises:
            Unavailable: a library of the extra `report` is missing.
        """
        from clearance.report.notebook import shown_page

        return shown_page(self.page(), height)

    def to_pandas(self) -> Any:
        """`steps` as a `pandas.DataFrame`.

        Raises:
            Unavailable: pandas or pyarrow is not installed.
        """
        if not is_installed("pandas"):
            valid = "pip install pandas; `steps` needs none"
            raise Unavailable("to_pandas needs pandas, which is not installed", valid=valid)
        return self.steps.to_pandas()


def _measured_columns(sides: tuple[str, str], moment: Moment) -> dict[str, Any]:
    """Names and witness points of a moment, as the columns of a table have them."""
    values = (moment.link, moment.obstacle, *moment.point_link, *moment.point_obstacle)
    return dict(zip(columns_of(sides), values, strict=True))
