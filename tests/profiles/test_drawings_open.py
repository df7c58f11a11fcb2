"""A profile's drawings as others open them: an SVG in mm fits into the window, a DXF states its unit."""

from __future__ import annotations

import re

import pytest

import clearance as cl
from clearance.profiles.profile_file import write_profile
from tests.profiles.moving import slab, turning
from tests.report.browser import chromium, executable


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """A profile of some metres, as SVG and DXF."""
    folder = tmp_path_factory.mktemp("drawn")
    profile = cl.swept_profile(turning(slab([2.0, -0.1, 0], [3.0, 0.1, 0.1]), [0, 0.8]))
    for name in ("p.svg", "p.dxf"):
        write_profile(profile, folder / name)
    return profile, folder


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_an_svg_of_metres_is_seen_whole(drawn):
    _, folder = drawn
    with chromium() as page:
        page.open((folder / "p.svg").as_uri(), "document.documentElement", width=900, height=700)
        box = page.box("path")
    assert 0.0 <= box["x"] and box["x"] + box["width"] <= 900.0
    assert 0.0 <= box["y"] and box["y"] + box["height"] <= 700.0
    assert max(box["width"] / 900.0, box["height"] / 700.0) > 0.8


def test_the_dxf_says_metres(drawn):
    _, folder = drawn
    words = (folder / "p.dxf").read_text().split()
    assert words[words.index("$INSUNITS") + 2] == "6"


def test_its_size_is_in_millimetres(drawn):
    profile, folder = drawn
    text = (folder / "p.svg").read_text()
    width = float(re.search(r'width="([\d.]+)mm"', text)[1])
    extent = float((profile.curve.box[1] - profile.curve.box[0])[0]) * 1000.0
    assert extent < width < 1.2 * extent
