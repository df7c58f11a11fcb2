"""Files of points: what is read of each format, what is left out and said, and what is refused."""

import re
import struct

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.formats.cloud.formats import cloud_from_bytes, read_points
from clearance.formats.cloud.pcd_file import decompressed
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from tests.formats.making_case import changed, load_small
from tests.formats.making_clouds import XYZ, lzf, pcd, ply, table
from tests.formats.refusal import refusal

POINTS = np.array([[0.5, -1.25, 2.0], [1e-3, 0.0, 3.5], [0.1, 0.2, 0.3], [7.0, 8.0, 9.0]]).astype(
    np.float32
)
MORE = (("intensity", "F", 4, 1), ("x", "F", 4, 1), ("normal", "F", 4, 3), ("y", "F", 4, 1), ("z", "F", 4, 1),
        ("rgb", "U", 4, 1), ("_", "U", 1, 5))  # fmt: skip

FILES = {
    "ascii.pcd": pcd(POINTS, "ascii"),
    "binary.pcd": pcd(POINTS, "binary"),
    "compressed.pcd": pcd(POINTS, "binary_compressed"),
    "ascii more.pcd": pcd(POINTS, "ascii", MORE),
    "binary more.pcd": pcd(POINTS, "binary", MORE),
    "organised.pcd": pcd(POINTS, "binary", WIDTH=2, HEIGHT=2),
    "old.pcd": pcd(POINTS, "ascii", VERSION=".5", COUNT=None, POINTS=None, VIEWPOINT=None),
    "ascii.ply": ply(POINTS, "ascii"),
    "little.ply": ply(POINTS),
    "big.ply": ply(POINTS, "binary_big_endian"),
    "header.csv": table(POINTS, ",", "x,y,z"),
    "bare.xyz": table(POINTS, " ", ""),
    "semicolons.csv": table(POINTS, ";", "x;y;z"),
    "german.csv": table(POINTS, ";", "x;y;z").replace(b".", b","),
    "remarks.xyz": b"# scan 7\n\n" + table(POINTS, "  ", "") + b"// the end\n",
    "numpy.txt": b"# scan 7\n# y z x\n" + table(POINTS[:, [1, 2, 0]], " ", ""),
    "compare.txt": b"//X,Z,Y\n" + table(POINTS[:, [0, 2, 1]], " ", ""),
    "units.asc": b"#z [m], y [m], x [m]\n" + table(POINTS[:, ::-1], ";", ""),
    "windows.csv": table(POINTS, ",", "x,y,z").replace(b"\n", b"\r\n"),
    "colours.xyz": b"".join(line + b" 255 0 0\n" for line in table(POINTS, " ", "").splitlines()),
    "named.csv": b"".join(
        line + b",7\n" for line in table(POINTS, ",", "x,y,z").splitlines()
    ).replace(b"z,7", b"z,label", 1),
}


GUESSED = {
    "colours.xyz": ("no header names its 6 columns: the first three are taken for x, y and z",)
}


def as_set(points):
    return sorted(map(tuple, np.asarray(points, dtype=np.float64).tolist()))


@pytest.mark.parametrize("name", FILES)
def test_the_points_are_those_of_the_file(name):
    found = cloud_from_bytes(FILES[name], name, 0.01)
    assert as_set(found.shape.vertices) == as_set(POINTS)
    assert (found.shape.ball_radius, found.notes) == (0.01, GUESSED.get(name, ()))


@pytest.mark.parametrize("make", [pcd, ply, table])
def test_beams_that_did_not_come_back_are_left_out_and_counted(make):
    points = np.concatenate([POINTS, [[np.nan, np.nan, np.nan], [1.0, np.inf, 0.0]]])
    name = {pcd: "a.pcd", ply: "a.ply", table: "a.csv"}[make]
    found = cloud_from_bytes(make(points), name, 0.01)
    assert as_set(found.shape.vertices) == as_set(POINTS)
    assert found.notes == ("2 points are not finite (no return) and left out, of 6",)
    one = cloud_from_bytes(make(points[:5]), name, 0.01)
    assert one.notes == ("1 point is not finite (no return) and left out, of 5",)
    with pytest.raises(BadInput, match="none of the 2 points is finite"):
        cloud_from_bytes(make(points[4:]), name, 0.01)


@pytest.mark.filterwarnings("error")
def test_a_signalling_nan_is_a_point_left_out():
    data = pcd(np.arange(9.0).reshape(3, 3), "binary")[:-4] + struct.pack("<I", 0x7F800001)
    cloud = cloud_from_bytes(data, "s.pcd", 0.1)
    assert cloud.shape.n_points == 2 and "1 point is not finite" in cloud.notes[0]


def test_a_first_column_that_counts_the_points_is_no_x():
    counted = b"".join(
        b"%d %s\n" % (i, line) for i, line in enumerate(table(POINTS, " ", "").splitlines(), 7)
    )
    with pytest.raises(BadInput, match=r"its first column counts the rows.*a header that names"):
        cloud_from_bytes(counted, "a.xyz", 0.01)
    named = cloud_from_bytes(b"number x y z\n" + counted, "a.xyz", 0.01)
    assert as_set(named.shape.vertices) == as_set(POINTS)


def test_copies_viewpoints_and_faces_are_said():
    twice = cloud_from_bytes(pcd(np.concatenate([POINTS, POINTS[:1]])), "a.pcd", 0.01)
    assert twice.notes == ("1 of its points are there more than once and count once",)
    (told,) = cloud_from_bytes(pcd(POINTS, VIEWPOINT="0 0 1 1 0 0 0"), "a.pcd", 0.01).notes
    assert "VIEWPOINT" in told and "not applied" in told
    (told,) = cloud_from_bytes(ply(POINTS, faces=[(0, 1, 2)]), "a.ply", 0.01).notes
    assert told == "its faces are passed over: only the vertices are taken"


def test_scale_and_units():
    scaled = cloud_from_bytes(pcd(POINTS), "a.pcd", 0.01, (1.0, 2.0, -1.0)).shape
    assert as_set(scaled.vertices) == as_set(POINTS.astype(float) * [1.0, 2.0, -1.0])
    assert scaled.ball_radius == 0.01
    for name, data in (("a.pcd", pcd(POINTS)), ("a.csv", table(POINTS))):
        in_mm = cloud_from_bytes(data, name, 0.01, in_millimetres=True).shape
        assert as_set(in_mm.vertices) == as_set(POINTS.astype(float) / 1000.0)
    for header in ("x [mm],y [mm],z [mm]", "x_mm,y_mm,z_mm"):
        for told in (True, False):
            found = cloud_from_bytes(table(POINTS, ",", header), "a.csv", 0.01, in_millimetres=told)
            assert as_set(found.shape.vertices) == as_set(POINTS.astype(float) / 1000.0)
            assert found.notes == ("read in millimetres: 'x', 'y', 'z'",)


FAULTS = {
    "no data line": (b"VERSION 0.7\nFIELDS x y z\n", "not a PCD file"),
    "another line": (pcd(POINTS, more=["POINTZ 4"]), "'POINTZ'; did you mean 'POINTS'?"),
    "twice": (pcd(POINTS, more=["WIDTH 4"]), "has WIDTH twice"),
    "no fields": (pcd(POINTS, FIELDS=None), "has no FIELDS"),
    "no z": (pcd(POINTS, FIELDS="x y w"), "no one field 'z'"),
    "two z": (pcd(POINTS, fields=(*XYZ, XYZ[2])), "no one field 'z'"),
    "sizes": (pcd(POINTS, SIZE="4 4"), "SIZE is '4 4'; 3 whole numbers"),
    "no number": (pcd(POINTS, SIZE="4 4 a"), "'a' is not a whole number"),
    "type": (pcd(POINTS, TYPE="F F D"), "TYPE 'D' and SIZE 4"),
    "counts": (pcd(POINTS, POINTS=5), "POINTS is 5; WIDTH times HEIGHT, 4"),
    "form": (pcd(POINTS, DATA="zip"), "DATA is 'zip'"),
    "version": (pcd(POINTS, VERSION="1.0"), "version is '1.0'"),
    "more than there are": (pcd(POINTS, WIDTH=10**15, POINTS=10**15), "cut off"),
    "as text": (pcd(POINTS, "ascii", WIDTH=10**15, POINTS=10**15), "cut off"),
    "compressed": (pcd(POINTS, "binary_compressed", WIDTH=10**9, POINTS=10**9), "bytes are compressed"),
    "much from little": (
        pcd(POINTS, DATA="binary_compressed", WIDTH=350_000_000, POINTS=350_000_000).partition(b"compressed\n")[0]
        + b"compressed\n" + struct.pack("<II", 4, 4_200_000_000) + b"\0\0\0\0",
        "it is too short",
    ),
    "more bytes": (pcd(POINTS) + b"1", "1 bytes more than its header says"),
    "more rows": (pcd(POINTS, "ascii") + b"1 2 3\n", "5 of 4 rows"),
    "a word": (pcd(POINTS, "ascii").replace(b"0.5", b"0,5"), "'0,5' is not a number"),
    "a long row": (pcd(POINTS, "ascii").replace(b"0.5", b"0.5 1"), "point 0 has 4 numbers; 3"),
    "no points": (pcd(POINTS[:0]), "there are no points"),
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_a_pcd_file_that_is_not_as_it_says_is_refused(fault):
    data, told = FAULTS[fault]
    with pytest.raises(BadInput, match=re.escape(told)) as caught:
        cloud_from_bytes(data, "a.pcd", 0.01)
    assert str(caught.value).startswith("a.pcd: ")


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", "there are no rows"),
        (b"x,y,z\n", "no rows below the header"),
        (b"1,2\n", "line 1: 2 columns; three or more"),
        (b"//X Y Z\n2\n1 2 3\n4 5 6\n", "line 2: 1 column; three or more: x, y, z; remove a line"),
        (b"1 2 3\n4 5\n", "line 2: 2 columns; there are 3 names"),
        (b"1 2 3\n4 5 a\n", "line 2: 'a' in column 'z' is not a number"),
        (b"1;2;3,5\n4;5;6.5\n", "line 2: '6.5' in column 'z' is not a number; decimals have commas"),
        (b"x [mm],y,z\n1,2,3\n", "some of x, y and z name a unit"),
        (b"x [deg],y [deg],z [deg]\n1,2,3\n", "is a length, not in deg"),
    ],
)  # fmt: skip
def test_a_table_that_is_no_points_is_refused(data, told):
    assert told in refusal(cloud_from_bytes, data, "a.xyz", 0.01, of=BadInput)


def test_what_was_compressed_comes_back():
    random = np.random.default_rng(3)
    for data in (
        b"",
        b"a",
        b"a" * 5000,
        b"abcabc" * 700,
        random.bytes(9000),
        bytes(random.integers(0, 3, 9000)),
    ):
        assert decompressed(lzf(data), len(data)) == data


@pytest.mark.parametrize("data", [b"\x05ab", b"\x20", b"\xe0\x01", b"\x00a\x20\x05", b"\x00a\xe0"])
def test_damaged_compression_is_refused(data):
    assert "compressed points cannot be read" in refusal(decompressed, data, 200, of=BadInput)


def test_a_public_reader(tmp_path):
    (tmp_path / "scan.pcd").write_bytes(pcd(POINTS))
    cloud = read_points(tmp_path / "scan.pcd", 0.02, 0.5)
    assert as_set(cloud.vertices) == as_set(POINTS.astype(float) * 0.5)
    assert cl.read_points is read_points
    with pytest.raises(
        BadInput, match=r"scan.las: unknown format of points '.las'; .pcd, .ply, .csv"
    ):
        (tmp_path / "scan.las").write_bytes(b"")
        read_points(tmp_path / "scan.las", 0.02)
    assert "radius is 0" in refusal(read_points, tmp_path / "scan.pcd", 0.0, of=BadInput)


@pytest.mark.parametrize(
    ("name", "data"),
    [("a.ply", ply(POINTS)), ("a.pcd", pcd(POINTS)), ("a.xyz", table(POINTS, " ", ""))],
)
def test_a_scan_under_mesh_is_told_where_it_belongs(name, data):
    with pytest.raises(BadInput, match=re.escape("a scan is read as points: {file: …, radius: …}")):
        mesh_from_bytes(data, name)


def test_a_case_with_a_scan(tmp_path):
    scan = "points: {file: scan.csv, radius: 0.3, scale: 10, units: {length: mm}}"
    content = table(POINTS.astype(float) * 100.0, ",", "x,y,z")
    case = load_small(
        tmp_path,
        changed("box: {size: [0.1, 0.1, 1]}", scan).replace("[1.2, 0, 0]", "[0, 0, 0]"),
        scan__csv=content,
    )
    (obstacle,) = case.obstacles
    assert obstacle.body.origin == "scan.csv" and obstacle.body.is_cloud
    assert obstacle.body.shape.ball_radius == 0.3
    assert np.allclose(as_set(obstacle.body.shape.vertices), as_set(POINTS), rtol=1e-15, atol=0.0)
    assert "scan.csv" in {source.path for source in case.sources}
    (told,) = [notice.text for notice in case.notices if "radius" in notice.text]
    assert "each point of 'post' has a radius of 0.3 m" in told
    run = cl.check(case)
    assert (run.worst["clearance"], run.worst["obstacle"], run.status) == (0.0, "post", "suspect")
