"""Short tables of plain numbers: the same bits as Python's; whatever is not plain is left to the other reader."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clearance.errors import BadInput
from clearance.formats.motion.trajectory_file import parse_trajectory
from clearance.formats.table import csv_table
from clearance.formats.table.plain_table import plain_numbers

FORMS = ("%.6f", "%.17g", "%.18e", "%g", "%.3e", "%r", "%.0f", "%.9f")


def number(text: str) -> np.ndarray | None:
    return plain_numbers(text.encode(), 0, 1, ",", ".")


@settings(max_examples=150)
@given(st.floats(-1e12, 1e12), st.sampled_from(FORMS))
def test_a_number_is_read_to_the_last_bit_or_not_at_all(value: float, form: str) -> None:
    text = form % value
    found = number(text)
    if found is not None:
        assert found.tobytes() == np.array([[float(text)]]).tobytes()
    elif form in ("%.6f", "%g", "%.3e"):
        assert abs(float(text)) > 1e10 or 0.0 < abs(float(text)) < 1e-14


@settings(max_examples=200)
@given(st.integers(0, 2**64 - 1), st.integers(-24, 24))
def test_whatever_the_digits_the_nearest_double_is_found(digits: int, exponent: int) -> None:
    text = f"{digits}e{exponent}"
    found = number(text)
    assert found is None or found[0, 0] == float(text)
    if digits <= 2**53 and abs(exponent) <= 22:
        assert found is not None


@pytest.mark.parametrize(
    "text",
    ["", "-", "+1", ".", "1e", "1e+", "e5", "1.2.3", "1 2", "nan", "inf", "0x1", "1_0", '"1"', "1e999",
     "1e-30", "--1", "1-", "1\r2", "\r", " \n", "1,2", "1,", ",", "\uff11", "1\x00", "1e99999999999"],
)  # fmt: skip
def test_what_is_not_a_plain_number_is_not_read(text: str) -> None:
    found = number(text)
    assert found is None or not len(found)


TEXTS = (
    "time,a\n0,1\n1,2\n",
    "time,a\r\n0,1\r\n1,2",
    "\n\ntime,a\n\n 0 ,\t1 \n\n\n1,2\n\n",
    "time,a\n0,1\n1\n",
    "time,a\n0,1,2\n1,2\n",
    "time,a\n",
    "time,a",
    "time,a\r0,1\r1,2\r",
    "time,a\r0,1\n1,2\n2,3\n",
    "time;a\n0;1,5\n1;2,5\n",
    "time;a\n0;1.5\n1;2.5\n",
    "time;a\n0;1,5\n1;2.5\n",
    'time,"a"\n0,1\n1,"2"\n',
    'time,"a\nb"\n0,1\n1,2\n',
    "time,a\n0,+1\n1,.5\n",
    "time,a\n0,1.\n1,-.5e+1\n",
    "time,a\n0,nan\n1,2\n",
    "time,a\n0,1\n1,1e400\n",
    "time,a\n0,1\n\x00\n",
    "time,a\n0,1e-400\n1,2\n",
    "time,a\n0,1\n1,2\n \n",
    "time,a\n0,\n1,2\n",
    "\ufefftime,a\n0,1\n1,2\n",
    "time,a\n0,1\n0,2\n",
    "time,a\n0,0.1234567890123456789012345\n1,2\n",
    "time,a\n0,1\n1,é\n",
)


def told(text: str) -> object:
    try:
        found = parse_trajectory(text.encode(), "path.csv")
    except BadInput as error:
        return type(error), str(error)
    return found.joint_names, found.times.tobytes(), found.positions.tobytes()


@pytest.mark.parametrize("text", TEXTS)
def test_both_readers_tell_the_same_of_a_file(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    quick = told(text)
    monkeypatch.setattr(csv_table, "plain_numbers", lambda *_: None)
    assert told(text) == quick


@settings(max_examples=150)
@given(st.text("0123456789+-.eE,;\n\r \t_x\"'", max_size=30))
def test_both_readers_tell_the_same_of_any_text(text: str) -> None:
    text = "time,a\n0,1\n" + text
    quick = told(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv_table, "plain_numbers", lambda *_: None)
        assert told(text) == quick
