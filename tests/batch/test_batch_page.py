"""The page of a batch in a real browser: it sorts, filters, draws what is in view, and says how to see one
case."""

import numpy as np
import pytest

from clearance.batch.answer import BatchAnswer
from clearance.batch.page import page_of
from tests.batch.batches import run_here, write_cell
from tests.report.browser import Page, chromium, executable

MANY = 10_000


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    """The answer of six cases, repeated under other names; one of them is bad input."""
    folder = tmp_path_factory.mktemp("page")
    manifest = write_cell(folder / "in", [0.5, 0.2, 0.04, 0.35, -0.1])
    (folder / "in" / "t005.csv").write_text("time,rail\n0,0\n1,</script><b>x\n")
    _, found = run_here(manifest, folder / "store")
    rows = found.rows.take(np.arange(MANY) % found.n_cases)
    rows = rows.set_column(0, "case", [[f"it's {i:05d}" for i in range(MANY)]])
    page = folder / "store" / "batch.html"
    page.write_text(page_of(BatchAnswer(rows), folder / "store"))
    return page


@pytest.mark.slow
def test_ten_thousand_cases_are_a_small_file(many):
    assert many.stat().st_size < 5_000_000
    assert b"</script><b>" not in many.read_bytes()


@pytest.fixture(scope="module")
def page(many) -> Page:
    if executable() is None:
        pytest.skip("no Chromium is installed")
    with chromium() as page:
        page.open(many.as_uri(), "document.querySelector('.row')", width=1400, height=900)
        yield page


def shown(page, column=0):
    cells = f"[...document.querySelectorAll('.row')].map(r => r.children[{column}].innerText)"
    return page.run(cells)


@pytest.mark.browser
def test_what_fails_stands_first(page):
    assert set(shown(page, 1)) == {"error"}
    page.run("document.getElementById('view').scrollTop = 32 * 1700")
    page.settle()
    assert set(shown(page, 1)) == {"contact"} and set(shown(page, 2)) == {"100.000 deep"}
    page.run("document.getElementById('view').scrollTop = 0")
    page.settle()


@pytest.mark.browser
def test_lengths_are_not_rounded_up(page):
    """4.9999 mm shown as 5.0 would be taken for kept."""
    page.run("document.querySelector('[data-key=bound]').click()")
    page.settle()
    told = page.run("JSON.parse(document.getElementById('data').textContent)")
    number = {name: i for i, name in enumerate(told["names"])}
    rows = [(number[name], text) for name, text in zip(shown(page), shown(page, 3), strict=True)]
    known = [(told["bound"][i], text) for i, text in rows if told["bound"][i] is not None]
    assert known and all(float(text) <= bound for bound, text in known)
    assert {len(text.partition(".")[2]) for _, text in known} == {3}


@pytest.mark.browser
def test_only_what_is_in_view_is_drawn(page):
    assert page.run("document.getElementById('shown').value") == "10,000 of 10,000 cases"
    assert 10 < page.run("document.querySelectorAll('.row').length") < 60
    page.run("document.querySelector('[data-key=name]').click()")
    page.run("document.getElementById('view').scrollTop = 32 * 9000")
    page.settle()
    assert "it's 09000" in shown(page)
    page.run("document.getElementById('view').scrollTop = 0")
    page.settle()


@pytest.mark.browser
def test_it_filters_by_verdict_body_and_name(page):
    choose = "document.getElementById('{}').value = '{}';"
    changed = "document.getElementById('filters').dispatchEvent(new Event('input'))"
    page.run(choose.format("by-status", "error") + changed)
    assert set(shown(page, 1)) == {"error"}
    page.run(choose.format("by-body", "wall") + changed)
    assert shown(page) == []
    page.run(choose.format("by-status", "") + choose.format("find", "00017") + changed)
    assert shown(page) == []  # 17 is bad input, of no body
    page.run(choose.format("by-body", "") + changed)
    assert shown(page) == ["it's 00017"]


@pytest.mark.browser
def test_a_row_says_why_and_how_to_see_its_case(page):
    page.run("document.querySelector('.row').click()")
    told = page.run("document.getElementById('chosen').innerText")
    assert "is not a number" in told and "clearance view store 'it'\\''s 00017'" in told
    assert page.errors == [] and all(url.startswith("file:") for url in page.requests)
