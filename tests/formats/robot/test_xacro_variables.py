"""Variables that xacro files ask for, as they stand in the text."""

import pytest

from clearance.formats.robot.urdf.xacro_file import variables_asked
from clearance.world.case import Source


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("<a x='$(env LENGTH)' y='$(optenv WIDTH 0.2)'/>", ("LENGTH", "WIDTH")),
        ("<a x='$( env _A1 )$(env _A1)'/>", ("_A1",)),
        ("<a x='$(arg env) $(find env) ${env}'/>", ()),
    ],
)
def test_which_are_asked_for(text, names, tmp_path):
    path = tmp_path / "robot.urdf.XACRO"
    path.write_text(text)
    gone = Source("gone.xacro", "2", 0, str(tmp_path / "gone.xacro"))
    table = Source("t.csv", "1", len(text), str(path.with_suffix(".csv")))
    assert variables_asked([gone, Source("r", text, len(text), str(path)), table]) == names
