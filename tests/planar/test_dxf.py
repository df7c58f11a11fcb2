"""DXF files: the header's unit is obeyed, and whatever is wrong in them ends with a message."""

import ezdxf
import numpy as np
import pytest

from clearance.errors import BadSyntax, ClearanceError, MissingFile
from clearance.planar.dxf import read_dxf


def drawing(tmp_path, unit, draw=lambda space: space.add_line((0, 0), (2, 1))):
    made = ezdxf.new()
    made.header["$INSUNITS"] = unit
    draw(made.modelspace())
    made.saveas(tmp_path / "d.dxf")
    return str(tmp_path / "d.dxf")


@pytest.mark.parametrize(
    ("unit", "metres"), [(0, 1.0), (6, 1.0), (4, 1e-3), (1, 0.0254), (5, 0.01)]
)
def test_the_unit_of_the_header_is_obeyed(tmp_path, unit, metres):
    curve = read_dxf(drawing(tmp_path, unit))
    assert curve.box == pytest.approx(np.array([[0, 0], [2 * metres, metres]]))


def test_an_unknown_unit_is_refused(tmp_path):
    with pytest.raises(BadSyntax, match=r"d\.dxf: \$INSUNITS is 77; 0 to 16"):
        read_dxf(drawing(tmp_path, 77))


def test_a_missing_drawing_is_named():
    with pytest.raises(MissingFile, match=r"nowhere\.dxf: no such file"):
        read_dxf("nowhere.dxf")


@pytest.mark.parametrize("start", [1e18, -1e18, 1e300])
def test_arcs_from_angles_of_many_turns_end_with_a_message(tmp_path, start):
    path = drawing(tmp_path, 6, lambda space: space.add_arc((0, 0), 1, start, 10))
    with pytest.raises(ClearanceError, match="degrees; -360 to 360"):
        read_dxf(path)


def test_arcs_from_angles_of_a_few_turns_are_read(tmp_path):
    path = drawing(tmp_path, 6, lambda space: space.add_arc((0, 0), 1, 720, 90))
    assert read_dxf(path).box == pytest.approx(np.array([[0, 0], [1, 1]]), abs=1e-12)
