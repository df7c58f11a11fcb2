"""What tests of whole reports share: a copy of the module's `report` that a test may spoil."""

import shutil
from pathlib import Path

import pytest


@pytest.fixture
def folder(report, tmp_path):
    """The module's `report`, copied."""
    return Path(shutil.copytree(report, tmp_path / "report"))
