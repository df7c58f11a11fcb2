"""The picture of the worst moment and the model: pixels held against rays, what hides what, the same bytes."""

from __future__ import annotations

import io
import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import clearance as cl
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from clearance.report import picture
from clearance.report.glb import glb_of
from clearance.report.picture import HEIGHT, WIDTH, drawn, png_of
from clearance.report.raster import Screen, surface
from clearance.report.still import (
    COLOURS,
    MOST_POINTS,
    Camera,
    as_solids,
    at_gap,
    overview,
    rgb,
    still_of,
)
from tests.findings.test_verdict import CASES
from tests.made_cases import at, flying
from tests.profiles.moving import slab, turning
from tests.report.cells import box
from tests.report.made import replay_of, run_of
from tests.report.records import record

pytest.importorskip("matplotlib", reason="sets the words")

NONE = -1

FORWARD = Camera(np.zeros(3), np.array([[0.0, -1, 0], [0, 0, 1], [1, 0, 0]]), 0.01)
"""Looks along x, z up."""


def slow_owners(screen: Screen, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(rows, columns) which triangle a ray through each pixel's centre meets first, and how clearly it does."""
    x = (np.arange(screen.width) + 0.5 - screen.width / 2) / screen.scale
    y = (screen.height / 2 - np.arange(screen.height) - 0.5) / screen.scale
    rays = (
        np.stack([*np.meshgrid(x, y), np.ones((screen.height, screen.width))], -1)
        @ screen.camera.axes
    )
    a, b, c = np.moveaxis(corners - screen.camera.eye, 1, 0)
    normals = np.cross(b - a, c - a)
    along = (normals * a).sum(1) / (rays @ normals.T)
    at = along[..., None] * rays[:, :, None]
    sides = [
        (np.cross(q - p, at - p) * normals).sum(-1) / (normals**2).sum(-1)
        for p, q in ((a, b), (b, c), (c, a))
    ]
    inside = np.min(sides, axis=0)
    hit = (inside >= 0.0) & (along > screen.camera.near)
    far = np.where(hit, along, np.inf)
    owners = np.where(hit.any(-1), far.argmin(-1), NONE)
    return owners, (np.abs(inside) > 1e-6).all(-1)


@pytest.mark.parametrize("seed", range(6))
def test_every_pixel_shows_what_a_ray_meets_first(seed):
    """Triangles that reach behind the camera and beside the picture are among them."""
    rng = np.random.default_rng(seed)
    screen = Screen(FORWARD, 48, 32)
    corners = rng.uniform(-3, 3, (12, 1, 3)) + rng.uniform(-2, 2, (12, 3, 3)) + [2.0, 0, 0]
    found = surface(screen, corners)
    owners = np.full(32 * 48, NONE)
    owners[found.pixels] = found.owner
    expected, is_sure = slow_owners(screen, corners)
    assert (owners.reshape(32, 48) == expected)[is_sure].all()
    assert is_sure.mean() > 0.9 and len(set(expected[is_sure].tolist())) > 1


@pytest.mark.parametrize("look", [overview, at_gap])
def test_the_line_is_in_the_picture_in_the_colour_of_its_status(look):
    run = record()
    still = still_of(replay_of(run))
    camera = look(still)
    image = drawn(still, camera, 320, 200)
    screen = Screen(camera, 320, 200)
    for end in still.line:
        x, y, _ = screen.point(end)
        expected = np.round(rgb(COLOURS[run.status_of(run.worst)]) * 255)
        assert np.abs(image[int(y), int(x)] - expected).max() <= 1
    assert len(np.unique(image.reshape(-1, 3), axis=0)) > 50


@pytest.mark.slow
def test_the_picture_is_a_png_of_its_size_and_the_same_each_time(monkeypatch):
    monkeypatch.setattr(picture, "FINER", 1)
    run = record()
    asked = run, replay_of(run), run_of(run).verdict
    first = png_of(*asked)
    assert Image.open(io.BytesIO(first)).size == (WIDTH, HEIGHT) == (1280, 800)
    assert np.asarray(Image.open(io.BytesIO(first)).convert("RGB")).std() > 10
    assert png_of(*asked) == first


@pytest.mark.slow
def test_names_of_any_letters_are_words_not_formulas(monkeypatch):
    monkeypatch.setattr(picture, "FINER", 1)
    run = record()
    odd = replace(run, case=replace(run.case, name="$x^{2$ 机器人 " + "long " * 90))
    assert png_of(odd, replay_of(odd), run_of(odd).verdict).startswith(b"\x89PNG")


def words_of(run, monkeypatch) -> str:
    """All that is written into the picture of a record."""
    from matplotlib.figure import Figure

    found = []
    monkeypatch.setattr(
        picture, "_with_inset", lambda still: np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    )
    monkeypatch.setattr(Figure, "text", lambda self, x, y, text, **style: found.append(text))
    png_of(run, replay_of(run), run_of(run).verdict)
    return "\n".join(found)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["suspect", "profile", "rule", "warned"])
def test_all_that_bears_on_the_verdict_is_in_the_picture(name, monkeypatch):
    run, status, _ = CASES[name]
    verdict, words = run_of(run).verdict, words_of(run, monkeypatch)
    assert verdict.status == status
    told = [*verdict.beside, *verdict.warnings, *(one.line for one in verdict.suspects)]
    assert told and all(text[:100] in words for text in told)


@pytest.mark.slow
def test_the_limits_in_the_picture_are_those_that_judge(monkeypatch):
    posts = [
        box("post", (0.1, 0.1, 0.1), at(0.0, 0.6)),
        box("knob", (0.1, 0.1, 0.1), at(0.0, -0.4)),
    ]
    rules = (cl.Rule(("*", "knob"), name="tight", fail=0.4, warn=0.45),)
    case = turning(slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1]), [0.0, 0.5, 1.0])
    case = replace(case, obstacles=tuple(posts), limits=cl.Limits(0.001, 0.05, rules=rules))
    words = words_of(cl.check(case).record, monkeypatch)
    limits = "fail below 400 mm, warn below 450 mm of rule 'tight'"
    assert words.splitlines()[2].startswith(limits)


RUN = record()
REPLAY = replay_of(RUN)
DATA = glb_of(RUN, REPLAY, RUN.worst)


def document() -> dict:
    (length,) = struct.unpack("<I", DATA[12:16])
    return json.loads(DATA[20 : 20 + length])


def test_it_is_the_same_each_time_and_as_long_as_it_says():
    assert glb_of(RUN, replay_of(RUN), RUN.worst) == DATA
    magic, version, length = struct.unpack("<4sII", DATA[:12])
    assert (magic, version, length) == (b"glTF", 2, len(DATA)) and length % 4 == 0


def test_nodes_are_the_bodies_and_the_line():
    nodes = document()["nodes"]
    names = [nodes[i]["name"] for i in nodes[0]["children"]]
    assert names[:-1] == [body.name for body in REPLAY.bodies] and names[-1] == "witness line"
    extras = next(node for node in nodes if node["name"] == "witness line")["extras"]
    assert extras["clearance"] == RUN.worst.clearance
    assert extras["points"] == [list(RUN.worst.point_link), list(RUN.worst.point_obstacle)]
    assert extras["status"] == "contact" and extras["bodies"] == [
        RUN.worst.link,
        RUN.worst.obstacle,
    ]


def test_trimesh_finds_names_places_and_colours():
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.load(io.BytesIO(DATA), file_type="glb")
    still = still_of(REPLAY)
    y_up = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    for body in still.bodies:
        pose, name = scene.graph[body.name]
        assert np.abs(pose - y_up @ body.pose).max() < 1e-6
        assert len(scene.geometry[name].faces) == len(still.shapes[body.i_shape][1])
        assert scene.geometry[name].visual.material.baseColorFactor[3] == round(255 * body.opacity)
    for side, end in zip(("first", "second"), still.line, strict=True):
        pose, _ = scene.graph[f"witness line: {side} point"]
        assert np.abs(pose[:3, 3] - y_up[:3, :3] @ end).max() < 1e-6


def scanned() -> cl.Case:
    """A small box that goes past a wall of points, and a block beside it that is nearest."""
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 60), np.linspace(-1.0, 1.0, 60))
    wall = np.stack([u, np.full_like(u, 0.8), v], axis=-1).reshape(-1, 3)
    way = np.linspace([-0.5, 0, 0, 0, 0, 0], [0.5, 0, 0, 0, 0, 0], 5)
    case = flying("scanned", cl.box([0.1, 0.1, 0.1]), [(cl.box([0.1, 0.1, 0.1]), below())], way)
    scan = cl.Obstacle(cl.Body("scan", cl.PointCloud(wall, 0.02)))
    return replace(case, obstacles=(*case.obstacles, scan))


def below() -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = -0.3
    return pose


@pytest.mark.slow
def test_stills_show_points_as_solids():
    """In a picture and in a model; of many points some."""
    run = cl.check(scanned())
    record, replay = run.record, run.session.replay()
    still = still_of(replay)
    sizes = sorted(len(triangles) for _, triangles in still.shapes)
    assert sizes[-1] == 8 * 3600
    assert png_of(record, replay, run.verdict).startswith(b"\x89PNG")
    shape = mesh_from_bytes(glb_of(record, replay, record.worst), "moment.glb")
    assert shape.n_triangles > 8 * 3600
    points = (
        np.random.default_rng(1).uniform(-1.0, 1.0, (2 * MOST_POINTS + 1, 3)).astype(np.float32)
    )
    vertices, triangles = as_solids(points, np.empty((0, 3), dtype=np.int32))
    assert len(triangles) == 8 * (len(points) // 3 + 1)
    assert np.abs(vertices[:6] - points[0]).max() == pytest.approx(0.002, rel=1e-3)
    solid = cl.Polyhedron.from_triangles(vertices[:6], triangles[:8])
    assert solid.closed and solid.volume > 0.0
