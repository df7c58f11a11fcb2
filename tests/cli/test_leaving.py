"""Leaving with an error depends on no other process: every bad input, three times."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.test_check_command import BAD, CASE, PATH, ROOT, URDF

TIMES = 3

LEAVING = """
import json, os, sys
import clearance.cli.check, clearance.cli.commands, clearance.files
import clearance.compile.calls, clearance.case.case_file
import clearance.formats.message.times, clearance.formats.robot.urdf.robot
import clearance.query.pair_query, clearance.files, clearance.report.output, clearance.run
import encodings.utf_8_sig, lxml.etree, markupsafe, ruamel.yaml
from clearance import cli
from clearance.case import case_file
ends = {}
for name in sys.argv[2:]:
    found = set()
    for i in range(int(sys.argv[1])):
        child = os.fork()
        if child == 0:
            with open(f"{name}/out", "wb") as out, open(f"{name}/err", "wb") as err:
                os.dup2(out.fileno(), 1), os.dup2(err.fileno(), 2)
            cli.main(["check", f"{name}/case.yaml", "--out", f"{name}/report"])
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        found.add((code, open(f"{name}/out").read(), open(f"{name}/err").read()))
    ends[name] = sorted(found)
print(json.dumps(ends))
"""


def write_case(folder: Path, fault: str | None) -> None:
    folder.mkdir()
    texts = {"cart.urdf": URDF, "case.yaml": CASE, "path.csv": PATH}
    if fault is not None:
        name, good, bad, _ = BAD[fault]
        texts[name] = texts[name].replace(good, bad, 1)
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "none.stl").write_text("solid none\nendsolid none\n")


def ends_of(folder: Path, faults: list[str], times: int, **environment: str) -> dict[str, list]:
    """The different ends that so many processes came to, for each fault: exit code, stdout, stderr.

    Each is forked off one that has only imported all that they need, which costs a fiftieth of a start.
    """
    for fault in faults:
        write_case(folder / fault, fault)
    done = subprocess.run(
        [sys.executable, "-c", LEAVING, str(times), *faults], cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment}, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


@pytest.mark.cold
@pytest.mark.skipif(not hasattr(os, "fork"), reason="forks")
def test_every_bad_input_ends_each_time_in_the_same_way(tmp_path: Path) -> None:
    ends = ends_of(tmp_path, [*BAD], TIMES, CLEARANCE_COMPILES_AHEAD="1")
    for fault, found in ends.items():
        ((code, out, err),) = found
        assert (code, out, err.count("\n")) == (2, "", 1), fault
        assert err.startswith("error: ") and BAD[fault][3] in err
