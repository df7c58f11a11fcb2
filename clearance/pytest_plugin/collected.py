"""What pytest collects from `*.clearance.yaml`: rules and verdict of the case in it, or of each that it lists.

Only names are read here; a case is measured when the first of its tests runs, once for all of them in a process.
Not for: options and fixture (the package itself), nor lists of cases (`case.case_list`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from clearance.case.case_list import CASES, cases_in, mapping_in
from clearance.errors import ClearanceError, shown
from clearance.options import options_in
from clearance.pytest_plugin import PREFIX
from clearance.pytest_plugin.assertion import warn_beside
from clearance.run.options import USUAL, CheckOptions

if TYPE_CHECKING:
    from clearance.findings.finding import Finding
    from clearance.run import Run


DEFAULT = "default"
"""What the limits by themselves are called (`world.rules`)."""

MOST_LETTERS = 200
"""Of a rule's name in that of a test; nothing has checked it when tests are collected."""


class NotClear(Exception):
    """A test that fails, with what is to be told of it; one line each."""


class CaseListFile(pytest.File):
    """One `*.clearance.yaml`."""

    def collect(self) -> Iterable[pytest.Item | pytest.Collector]:
        """The tests of the case in it, or a node for each of the cases that it lists."""
        content = mapping_in(self.path)
        if CASES not in content:
            yield from _items(self, CaseRun(self.path, self.config), content)
            return
        for path in cases_in(self.path):
            name = path.relative_to(self.path.parent).as_posix()
            yield CaseNode.from_parent(self, name=name, case_path=path)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """One line for what is wrong with the file."""
        return _one_line(excinfo) or super().repr_failure(excinfo)


class CaseNode(pytest.Collector):
    """One of the cases that a file lists."""

    def __init__(self, *, case_path: Path, **given: Any) -> None:
        super().__init__(**given)
        self.case_path = case_path

    def collect(self) -> Iterator[pytest.Item]:
        """A test a rule, and one for the verdict."""
        yield from _items(self, CaseRun(self.case_path, self.config), mapping_in(self.case_path))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """One line for what is wrong with the file."""
        return _one_line(excinfo) or super().repr_failure(excinfo)


class CaseRun:
    """A case and, once one of its tests has asked for it, its run."""

    def __init__(self, path: Path, config: pytest.Config) -> None:
        self.path, self._config = path, config
        self._run: Run | ClearanceError | None = None

    def run(self) -> Run:
        """The run.

        Raises:
            ClearanceError: the same again, if the case cannot be checked.
        """
        if self._run is None:
            try:
                self._run = check_case(self.path, self._config)
            except ClearanceError as error:
                self._run = error
        if isinstance(self._run, ClearanceError):
            raise self._run
        return self._run

    @property
    def page(self) -> str:
        """Where its page is, or how to have one."""
        folder = report_folder(self.path, self._config)
        return (
            "--clearance-out DIR writes the page" if folder is None else str(folder / "report.html")
        )


class _Item(pytest.Item):
    def __init__(self, *, case_run: CaseRun, **given: Any) -> None:
        super().__init__(**given)
        self.case_run = case_run
        if self.config.pluginmanager.hasplugin("xdist"):  # one worker measures a case, if asked so
            self.add_marker(pytest.mark.xdist_group(str(case_run.path)))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """What is to be told, without a traceback of ours."""
        return _one_line(excinfo) or super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """File and name."""
        return self.path, None, f"{_below_root(self.case_run.path, self.config)}: {self.name}"

    def failure(self, lines: Iterable[str]) -> NotClear:
        """The failure that says some lines and where the page is."""
        return NotClear("\n".join([*lines, f"page: {self.case_run.page}"]))


class RuleItem(_Item):
    """Whether one rule of a case is kept."""

    def __init__(self, *, rule: str, **given: Any) -> None:
        super().__init__(**given)
        self.rule = rule

    def runtest(self) -> None:
        """Fails with each finding that breaks the rule; is skipped where all that does is waived, and where the
        run is in doubt."""
        from clearance.findings.finding_text import finding_line, waived_text

        run = self.case_run.run()
        if not any(answer.name == self.rule for answer in run.record.rules):
            pytest.skip("no pair is judged by this rule")
        found = [one for one in run.findings if one.rule == self.rule and one.broken]
        failing = [one for one in found if one.fails]
        if failing:
            raise self.failure(_finding_text(one) for one in failing)
        doubts = _in_doubt(run)
        if doubts:  # kept, as far as such input says anything
            pytest.skip(f"the test of the verdict fails: {'; '.join(doubts)}")
        if found:
            pytest.skip("; ".join(f"{waived_text(one)} ({finding_line(one)})" for one in found))


class VerdictItem(_Item):
    """Whether a case is passed as a whole: all rules, profiles, waivers, and input that is not suspect."""

    def runtest(self) -> None:
        """Fails with the reasons; warns of what stands beside a verdict that passes."""
        run = self.case_run.run()
        verdict = run.verdict
        if not verdict.passed:
            raise self.failure([f"{run.record.case.name}: {verdict.headline()}", *verdict.reasons])
        warn_beside(run)


def _in_doubt(run: Run) -> list[str]:
    """Why nothing that passes in a run counts for much: suspect input, unproven programs, peers that disagree."""
    verdict = run.verdict
    parts = [f"suspect {one.kind}" for one in verdict.suspects]
    parts += verdict.unproven_motion
    return parts if verdict.disputed_by is None else [*parts, f"{verdict.disputed_by} disagrees"]


def _finding_text(finding: Finding) -> str:
    from clearance.findings.finding_text import finding_line

    return f"{finding_line(finding)} (finding {finding.id})"


def _items(parent: Any, case_run: CaseRun, content: dict[str, Any]) -> Iterator[pytest.Item]:
    for rule in _rule_names(content):
        name = f"rule {shown(rule)[:MOST_LETTERS]}"
        yield RuleItem.from_parent(parent, name=name, rule=rule, case_run=case_run)
    yield VerdictItem.from_parent(parent, name="verdict", case_run=case_run)


def _rule_names(content: dict[str, Any]) -> Iterator[str]:
    """The names of the rules in a case file; what is wrong with them is said when it is checked."""
    yield DEFAULT
    limits = content.get("limits")
    rules = limits.get("rules") if isinstance(limits, dict) else None
    for rule in rules if isinstance(rules, list) else []:
        given = rule if isinstance(rule, dict) else {}
        between = given.get("between")
        pair = " - ".join(map(str, between)) if isinstance(between, list) else ""
        yield str(given.get("name") or pair or "without a name")


def _one_line(excinfo: pytest.ExceptionInfo[BaseException]) -> str | None:
    """What is to be told of an error of ours; None for others, which keep their traceback."""
    error = excinfo.value
    if isinstance(error, ClearanceError):
        return error.line
    return str(error) if isinstance(error, NotClear) else None


def check_case(path: Path, config: pytest.Config) -> Run:
    """The run of a case; its report is written where `--clearance-out` says, and an older one there is withdrawn.

    Raises:
        BadInput: with the file and the field.
    """
    from clearance.run import check

    given = {name: config.getoption(f"{PREFIX}{name}", None) for name in options_in(CheckOptions)}
    said = {name: one for name, one in given.items() if one is not None}
    folder = report_folder(path, config)
    if folder is not None and folder.is_dir():
        from clearance.report.withdrawn import withdraw_report

        withdraw_report(folder)
    run = check(path, **USUAL | said)
    if folder is not None:
        run.save(folder)
    return run


def report_folder(path: Path, config: pytest.Config) -> Path | None:
    """Where the report of a case goes, by the path of its file; None where none is wanted."""
    out = config.getoption("--clearance-out")
    if not out:
        return None
    known = _below_root(path, config)
    return config.invocation_params.dir / out / known.relative_to(known.anchor)


def _below_root(path: Path, config: pytest.Config) -> Path:
    """A path as seen from the root of the tests, if it is below it."""
    path = path.absolute()
    return path.relative_to(config.rootpath) if path.is_relative_to(config.rootpath) else path
