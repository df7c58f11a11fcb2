"""A run in a notebook, and without one; rules that judge nothing are warned of."""

from __future__ import annotations

import html
import pickle
import re
import sys
from types import SimpleNamespace

import pytest

import clearance as cl
from clearance import extras
from clearance.errors import BadDimension, BadInput, Unavailable
from tests.formats.making_case import CASE, load_small
from tests.report.browser import chromium, executable


@pytest.fixture(scope="module")
def run():
    return cl.check("scenes/box_box/case.yaml")


@pytest.fixture(scope="module")
def page(run, tmp_path_factory):
    return (run.save(tmp_path_factory.mktemp("report")) / "report.html").read_text()


@pytest.fixture
def kernel(monkeypatch):
    """A kernel of Jupyter, as far as it is asked."""
    shell = SimpleNamespace(kernel=None)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setattr("webbrowser.open", None)


def test_a_notebook_shows_the_page_of_the_report(run, page, kernel):
    told = run.show(height=600)._repr_html_()
    assert html.unescape(re.fullmatch(r'<iframe srcdoc="([^"]*)" .*</iframe>', told)[1]) == page
    assert 'height="600"' in told
    with pytest.raises(BadDimension):
        run.show(height=0)


@pytest.mark.parametrize("shell", [None, SimpleNamespace()])
def test_without_a_notebook_the_browser_opens_it(run, page, shell, monkeypatch, tmp_path):
    opened = []
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setattr("webbrowser.open", lambda url, new: opened.append(url))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    shown = run.show()
    assert opened == [shown.path.as_uri()] and str(shown.path) in repr(shown)
    assert shown.path.read_text() == page


def test_a_run_is_neither_true_nor_false(run):
    """`assert cl.check(…)` would pass whatever the verdict is."""
    with pytest.raises(BadInput, match=r"neither true nor false; run\.passed is"):
        assert run


def test_a_run_is_not_pickled_and_its_record_is(run):
    with pytest.raises(BadInput, match=r"a Run cannot be pickled or copied; run\.record, or"):
        pickle.dumps(run)
    back = pickle.loads(pickle.dumps((run.record, run.summary)))
    assert back[0].clearances.tobytes() == run.record.clearances.tobytes()


def test_pandas_is_named_where_it_is_missing(run, monkeypatch):
    monkeypatch.setattr(extras, "find_spec", lambda name: None)
    with pytest.raises(Unavailable, match=r"to_pandas needs pandas, .*; pip install pandas"):
        run.to_pandas()


def test_steps_as_a_table_of_pandas(run):
    pytest.importorskip("pandas")
    table = run.to_pandas()
    assert list(table.columns) == run.steps.column_names
    assert table["clearance"].tolist() == run.steps["clearance"].to_pylist()


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_the_page_plays_within_a_notebook(run, kernel, tmp_path):
    path = tmp_path / "cell.html"
    path.write_text(f"<html><body>{run.show()._repr_html_()}</body></html>")
    with chromium() as tab:
        inside = "document.querySelector('iframe')?.contentWindow"
        tab.open(path.as_uri(), f"{inside}?.clearance")
        assert tab.run(f"{inside}.document.querySelectorAll('canvas').length") > 0
        assert not tab.errors


OWN = "{name: own, between: [upper, post], fail: 0.2}"
ALL = '{name: all, between: ["*", "*"], fail: 0.001}'


@pytest.mark.parametrize(
    "rules, idle, why",
    [
        (f"rules: [{OWN}, {ALL}]}}", ["own"], "pair: its pairs are judged by later rules"),
        (f"rules: [{ALL}, {OWN}]}}", [], ""),
        (
            f"rules: [{OWN}]}}\nallow: [[upper, post]]",
            ["own"],
            "pair: upper - post is not measured (allowed by ['upper', 'post'])",
        ),
    ],
)
def test_a_rule_without_pairs_is_warned_of(tmp_path, rules, idle, why):
    case = CASE.replace("limits: {fail: 0.005, warn: 0.02}", f"limits: {{fail: 0.005, {rules}")
    record = cl.check(load_small(tmp_path, case), certify=False).record
    told = [one.text for one in record.notices if one.kind == "rules"]
    assert [text.split("'")[1] for text in told] == idle
    assert all(why in text for text in told)


def test_a_rule_of_neighbours_alone_says_that_they_are_excused(tmp_path):
    case = CASE.replace("urdf: arm.urdf", "urdf: arm.urdf, self_clearance: true")
    rule = "rules: [{between: [base, upper], fail: 0.2}]}"
    case = case.replace("limits: {fail: 0.005, warn: 0.02}", f"limits: {{fail: 0.005, {rule}")
    record = cl.check(load_small(tmp_path, case), certify=False).record
    (text,) = [one.text for one in record.notices if one.kind == "rules"]
    assert text.endswith("pair: upper - base is not measured (excused: Adjacent)")
