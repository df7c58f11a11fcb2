"""Scene files are read by their suffix, from one table."""

from clearance.formats.scene import formats as scene_formats
from clearance.formats.scene.request import SceneContent
from clearance.world.notice import Notice, Severity
from tests.formats.making import CASE
from tests.formats.making_case import load_small


def named(suffix):
    return CASE.partition("scene:")[0] + f"scene: cell.{suffix}\ntrajectory: path.csv\n"


POST = "obstacles: [{name: post, box: {size: [1, 1, 1]}, pose: {xyz: [3, 0, 0]}}]"


def test_a_row_of_the_table_is_a_format(tmp_path, monkeypatch):
    notice = Notice(Severity.WARNING, "geometry", "half of it is missing")
    asked = []

    def read(request):
        asked.append(request)
        row = {"name": request.files.read(request.path).decode(), "sphere": {"radius": 1.0}}
        return SceneContent({"obstacles": [row]}, ("three trees left out",), (notice,))

    monkeypatch.setitem(scene_formats.READERS, ".balls", read)
    case = load_small(tmp_path, named("BALLS"), cell__BALLS="a ball")
    assert [one.name for one in case.obstacles] == ["a ball"]
    assert case.notes[-1] == "three trees left out" and case.notices == (notice,)
    assert asked[0].path == tmp_path / "cell.BALLS" and asked[0].package_dirs == ()


def test_other_suffixes_are_yaml(tmp_path):
    for suffix in ("yaml", "yml", "txt"):
        case = load_small(tmp_path, named(suffix), **{f"cell__{suffix}": POST})
        assert [one.name for one in case.obstacles] == ["post"]


def test_the_robots_package_folders_are_the_scenes_too(tmp_path, monkeypatch):
    (tmp_path / "models").mkdir()
    asked = []

    def read(request):
        asked.append(request)
        return SceneContent({"obstacles": [{"name": "ball", "sphere": {"radius": 0.1}}]})

    monkeypatch.setitem(scene_formats.READERS, ".ball", read)
    text = named("ball").replace("arm.urdf}", "arm.urdf, package_dirs: [models]}")
    load_small(tmp_path, text, cell__ball="")
    assert asked[0].package_dirs == (tmp_path / "models",)
