"""The changelog and the package agree on the release."""

from __future__ import annotations

import re
import tomllib

import clearance
from tests.docs.code_blocks import ROOT


def test_the_newest_release_is_this_version():
    text = (ROOT / "clearance" / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.findall(r"^## \[(\d[^\]]*)\] - (\d{4}-\d\d-\d\d)$", text, re.MULTILINE)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert releases[0][0] == project["version"] == clearance.__version__
    assert [date for _, date in releases] == sorted((date for _, date in releases), reverse=True)
