"""A case in one zip: it holds all that the case reads, nothing is read beside it, and no zip writes elsewhere."""

from __future__ import annotations

import hashlib
import json
import shutil
import stat
import zipfile
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.case import packed
from clearance.case.packing import BEGIN, case_contents, write_pack
from clearance.cli import run
from clearance.errors import BadInput, BadPack, MissingFile
from tests.formats.making import ARM, CASE, cube_stl, write_case

WAIVERS = """- {between: [upper, post], at_least: 0.001, reason: shown, by: ann, until: 2099-01-01}
"""

SCENE = """obstacles:
- {name: post, pose: {xyz: [1.2, 0, 0]}, box: {size: [0.1, 0.1, 1]}}
- {name: near, pose: {xyz: [-2, 0, 0]}, mesh: {file: PLACE/lab/parts/cube.stl, scale: 0.1}}
- {name: brought, pose: {xyz: [0, 3, 0]}, mesh: {file: "pybullet_data:cube.obj", scale: 0.1}}
"""


def scattered_cell(home: Path) -> Path:
    """A case whose files are named in every way: above it, absolute, of packages here and of Python."""
    cell, arms, shapes = home / "lab" / "cells" / "one", home / "arms", home / "ws" / "shapes_src"
    parts = home / "lab" / "parts"
    for folder in (cell, arms, shapes / "meshes", parts):
        folder.mkdir(parents=True)
    (shapes / "package.xml").write_text("<package><name>shapes</name></package>")
    (arms / "arm.urdf").write_text(ARM.replace("upper.stl", "package://shapes/meshes/upper.stl"))
    (shapes / "meshes" / "upper.stl").write_bytes(cube_stl())
    (parts / "cube.stl").write_bytes(cube_stl())
    (home / "lab" / "scene.yaml").write_text(SCENE.replace("PLACE", str(home)))
    robot = f"robot: {{urdf: {arms}/arm.urdf}}"
    text = (
        CASE[: CASE.index("scene:")]
        + "scene: ../../scene.yaml\n"
        + CASE[CASE.index("trajectory") :]
    )
    text = text.replace("robot: {urdf: arm.urdf}", robot).replace("name: small\n", "")
    text += "waivers: [PLACE/waivers.yaml]\ntolerance: {joints: {all: 0.0001}}\n"
    write_case(cell, text.replace("PLACE", str(cell.parent)))
    (cell / "arm.urdf").unlink()
    (cell / "upper.stl").unlink()
    (cell.parent / "waivers.yaml").write_text(WAIVERS)
    return cell / "case.yaml"


@pytest.mark.slow
def test_a_packed_case_is_checked_where_nothing_of_it_is(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{tmp_path / 'home' / 'ws' / 'shapes_src'}")
    case_file = scattered_cell(tmp_path / "home")
    before, target = cl.check(case_file).summary, tmp_path / "cell.zip"
    n_files = write_pack(case_contents(case_file), target, {})
    again = tmp_path / "again.zip"
    write_pack(case_contents(case_file), again, {})
    assert target.read_bytes() == again.read_bytes()
    assert n_files == len(before["inputs"]) + 1  # the manifest of the package
    shutil.rmtree(tmp_path / "home")
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/elsewhere")
    run = cl.check(target)
    assert run.summary == before
    assert set(run.record.case.files_read) == {str(target)}
    assert any("$ROS_PACKAGE_PATH leads to package://shapes" in note for note in before["notes"])


def test_a_cell_in_one_folder_says_nothing_of_this_machine(tmp_path):
    (tmp_path / "cell").mkdir()
    write_pack(
        case_contents(write_case(tmp_path / "cell")), tmp_path / "cell.zip", {"clearance": "1"}
    )
    with zipfile.ZipFile(tmp_path / "cell.zip") as archive:
        names, told = archive.namelist(), archive.read(packed.MANIFEST)
    assert names[1:] == [
        f"files/cell/{name}" for name in ("arm.urdf", "case.yaml", "path.csv", "upper.stl")
    ]
    assert str(tmp_path).encode() not in told and b'"clearance": "1"' in told


@pytest.mark.cold
def test_what_means_something_else_elsewhere_is_not_packed(tmp_path):
    text = ARM.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    text = text.replace('name="tip"', 'name="$(optenv ARM_TIP tip)"')
    case = CASE.replace("arm.urdf}", "arm.urdf, xacro: true}")
    pytest.importorskip("xacro")
    with pytest.raises(BadPack, match=r"asks for \$ARM_TIP, which is another on every machine"):
        write_pack(case_contents(write_case(tmp_path, case, text)), tmp_path / "cell.zip", {})
    assert not (tmp_path / "cell.zip").exists()


@pytest.fixture
def parts(tmp_path):
    """Manifest and members of a zip that is in order."""
    (tmp_path / "cell").mkdir()
    write_pack(case_contents(write_case(tmp_path / "cell")), tmp_path / "cell.zip", {})
    with zipfile.ZipFile(tmp_path / "cell.zip") as archive:
        members = {one.filename: archive.read(one) for one in archive.infolist()}
    return json.loads(members.pop(packed.MANIFEST)), members


def zipped(folder, manifest, members, **attributes) -> Path:
    """A zip of these parts; its list has what it holds, if it has something else the caller says so."""
    path = folder / "odd.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(packed.MANIFEST, json.dumps(manifest))
        for name, data in members.items():
            info = zipfile.ZipInfo(name, BEGIN)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = attributes.get("mode", 0o100644) << 16
            archive.writestr(info, data)
    return path


def listed(manifest, members):
    digests = {name: hashlib.sha256(data).hexdigest() for name, data in members.items()}
    return manifest | {"files": digests}


CELL = "files/cell"


@pytest.mark.parametrize(
    ("more", "said", "is_listed", "told"),
    [
        ({"files/../../outside.txt": b"x"}, {}, True, "leads outside"),
        ({"/tmp/outside.txt": b"x"}, {}, True, "leads outside"),
        ({f"{CELL}/more.txt": b"x"}, {}, False, "not those of its list"),
        ({f"{CELL}/path.csv": b"time,shoulder\n0,0\n1,0.4\n"}, {}, False, "not as it was packed"),
        ({}, {"entry": "files/../../../etc/passwd"}, False, "leads outside"),
        ({}, {"variables": {"PATH": ["cell"]}}, False, "does not lead to packages"),
        ({f"{CELL}/path.csv/more": b"x"}, {}, True, "cannot be unpacked"),
        ({f"{CELL}/zeros": bytes(2**22)}, {}, True, "at most 200 times as many"),
        ({f"{CELL}/path.csv": b"time,shoulder\n0,0\n1,0.4\n"}, {}, True, "is not what it was when it was"),
    ],
)  # fmt: skip
def test_a_zip_that_is_not_as_it_should_be_is_refused(
    tmp_path, parts, monkeypatch, more, said, is_listed, told
):
    monkeypatch.setattr(packed, "SMALL", 2**16)
    manifest, members = parts[0] | said, parts[1] | more
    manifest = listed(manifest, members) if is_listed else manifest
    with pytest.raises(BadPack, match=rf"^odd\.zip: .*{told}"):
        cl.load_case(zipped(tmp_path, manifest, members))


def test_links_are_refused(tmp_path, parts):
    with pytest.raises(BadPack, match="is a link or no file"):
        cl.load_case(zipped(tmp_path, *parts, mode=stat.S_IFLNK | 0o777))


def test_a_zip_with_any_byte_changed_is_read_as_it_was_or_refused(tmp_path, parts):
    """Bytes of no file's content, as its time, may be others."""
    path, rng, n_refused = tmp_path / "cell.zip", np.random.default_rng(3), 0
    whole = path.read_bytes()
    for place in rng.integers(0, len(whole), 60):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            with packed.unpacked(path) as found:
                files = {name: (found.folder / name).read_bytes() for name in found.manifest.files}
                assert files == parts[1]
        except BadInput:
            n_refused += 1
    assert n_refused > 30


def test_a_case_that_reads_beside_its_zip_is_refused(tmp_path, parts):
    manifest, members = parts
    (tmp_path / "away.csv").write_bytes(members["files/cell/path.csv"])
    text = members["files/cell/case.yaml"].replace(b"path.csv", f"{tmp_path}/away.csv".encode())
    members["files/cell/case.yaml"] = text
    manifest = listed(manifest, members)
    digest = dict(manifest["reads"])["path.csv"]
    manifest["reads"] = [
        ["../../../..", digest] if one[0] == "path.csv" else one for one in manifest["reads"]
    ]
    with pytest.raises(BadPack, match=r"is read, and not packed|is not what it was"):
        cl.load_case(zipped(tmp_path, manifest, members))


@pytest.mark.slow
def test_no_message_shows_where_a_zip_is_unpacked(tmp_path, capsys):
    """A report in which a file is missing; a case that breaks its limit, which is annotated on the zip."""
    (tmp_path / "cell").mkdir()
    case, zip_file = write_case(tmp_path / "cell"), tmp_path / "cell.zip"
    write_pack(case_contents(case), zip_file, {})
    words = ["--fail-mm", "1900", "--warn-mm", "1900", "--github", "-q", "--accept", "units"]
    assert run(["check", str(zip_file), *words]) == 1
    assert f"::error file={zip_file},title=" in capsys.readouterr().out
    check = ["check", str(case), "--out", str(tmp_path / "r"), "--receipt", "--quiet"]
    assert run(check) == 0 and run(["pack", str(tmp_path / "r"), str(tmp_path / "r.zip")]) == 0
    with zipfile.ZipFile(tmp_path / "r.zip") as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    gone = next(name for name in members if name.endswith("r/summary.json"))
    manifest = json.loads(members.pop("clearance-pack.json"))
    del members[gone], manifest["files"][gone]
    zipped(tmp_path, manifest, members).rename(tmp_path / "r.zip")
    capsys.readouterr()
    assert run(["verify", str(tmp_path / "r.zip")]) == 2
    assert capsys.readouterr().err.startswith(f"error: r.zip: {gone}: there is none; ")


def test_other_zips_and_packed_cases_are_told_apart(tmp_path, parts):
    path = tmp_path / "some.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("case.yaml", CASE)
    with pytest.raises(BadPack, match="holds no packed case"):
        cl.load_case(path)
    with pytest.raises(BadPack, match="is a zip; unzip it"):
        case_contents(tmp_path / "cell.zip")
    with pytest.raises(BadPack, match="a packed case; clearance check takes it"):
        from clearance.receipt.verifying import verify

        verify(tmp_path / "cell.zip")


def test_what_cannot_be_read_is_said_as_of_any_case(tmp_path):
    for path, told in ((tmp_path / "none.zip", "there is no file"), (tmp_path, "is a folder")):
        with pytest.raises(MissingFile, match=told):
            cl.load_case(path)
    long = tmp_path / ("x" * 300)
    with pytest.raises(MissingFile, match="name too long"):
        cl.load_case(long)
