"""The record as JUnit XML, so that a build server shows a violated limit as a failed test."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from clearance.report.folder import write_file
from clearance.report.wording import mm
from clearance.simulate.record import PairMinimum, Record


def write_junit(record: Record, path: str | Path) -> None:
    """Writes one test case a measured pair, one a pair left out (skipped), and one for the
    cross-check.

    A pair fails where its least clearance is below the fail limit or it touches.

    Raises:
        Unwritable: the file cannot be written; an older one is left as it was.
    """
    suite = ElementTree.Element("testsuite", name=record.case.name)
    for minimum in record.pair_minima:
        _pair(suite, record, minimum)
    for pair in record.unmeasured:
        case = ElementTree.SubElement(
            suite, "testcase", classname=pair.link, name=f"{pair.link} - {pair.obstacle}"
        )
        ElementTree.SubElement(case, "skipped", message=pair.reason)
    _cross_check(suite, record)
    for attribute, tag in (("failures", "failure"), ("skipped", "skipped")):
        suite.set(attribute, str(len(suite.findall(f"testcase/{tag}"))))
    suite.set("tests", str(len(suite)))
    suite.set("errors", "0")
    root = ElementTree.Element("testsuites")
    root.append(suite)
    ElementTree.indent(root)
    write_file(
        Path(path), ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
    )


def _pair(suite: ElementTree.Element, record: Record, minimum: PairMinimum) -> None:
    name = f"{minimum.link} - {minimum.obstacle}"
    case = ElementTree.SubElement(suite, "testcase", classname=minimum.link, name=name)
    limits = record.case.limits
    text = f"{mm(minimum.clearance)} mm at step {minimum.step}, {minimum.time:.3f} s"
    if minimum.clearance < limits.fail or minimum.clearance <= 0.0:
        message = f"clearance {text}; the fail limit is {mm(limits.fail)} mm"
        ElementTree.SubElement(case, "failure", type="LimitViolated", message=message)
    else:
        near = "near miss: " if minimum.clearance < limits.warn else ""
        ElementTree.SubElement(case, "system-out").text = f"{near}least clearance {text}"


def _cross_check(suite: ElementTree.Element, record: Record) -> None:
    check = record.cross_check
    if check is None:
        return
    case = ElementTree.SubElement(
        suite, "testcase", classname="cross_check", name=f"agrees with {check.peer}"
    )
    if not check.agrees:
        message = (
            f"{len(check.disagreements)} of {check.n_steps} steps differ by more than "
            f"{check.tolerance:g} m; "
            f"greatest difference {check.greatest_difference:g} m at step {check.worst_step}"
        )
        ElementTree.SubElement(case, "failure", type="CrossCheckDisagrees", message=message)
