"""What the view of a run holds: places, colours and bodies, and no more than there is room for."""

from __future__ import annotations

import base64
import zlib

import numpy as np
import pytest

from doseki.record.reader import load
from doseki.report.view.box import box_of
from doseki.report.view.coding import morton_order, packed, wide
from doseki.report.view.rigid import rigid_shapes
from doseki.report.view.scene import make_scene
from doseki.report.view.terrain import NO_DATA, STEPS, contour_interval, grid_below, grid_of
from doseki.report.view.thinning import Thinning, hidden, spread, thinned

from .conftest import CORNER, map_state, record_map

PLENTY = 1e9  # bytes


def unpacked(text, kinds):
    """Planes of "w" (16 bits) and "s" (8 bits) as browser/unpack.js reads them, for n numbers."""
    data = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    count = len(data) // sum(2 if kind == "w" else 1 for kind in kinds)
    planes, at = [], 0
    for kind in kinds:
        if kind == "s":
            planes.append(np.cumsum(data[at : at + count], dtype=np.int64) % 256)
            at += count
            continue
        low, high = data[at : at + count].astype(int), data[at + count : at + 2 * count].astype(int)
        folded = low | high << 8
        planes.append(np.cumsum((folded >> 1) ^ -(folded & 1)) % 65536)
        at += 2 * count
    return planes


@pytest.mark.parametrize("seed", range(3))
def test_numbers_come_back_as_they_were(seed):
    random = np.random.default_rng(seed)
    words = random.integers(0, 65536, 1000).astype(np.uint16)
    small = random.integers(0, 256, 1000).astype(np.uint8)
    words[:4] = [65535, 0, 65535, 32768]
    text = packed([words, small, words[::-1]])
    found = unpacked(text, "wsw")
    for got, given in zip(found, (words, small, words[::-1]), strict=True):
        assert np.array_equal(got, given)


def test_the_order_along_the_curve_keeps_neighbours_together():
    place = wide(np.random.default_rng(0).uniform(size=(4000, 3)))

    def mean_step(order):
        return np.linalg.norm(np.diff(place[order].astype(float), axis=0), axis=1).mean()

    order = morton_order(place)
    assert sorted(order) == list(range(4000))
    assert mean_step(order) < 0.2 * mean_step(np.arange(4000))


@pytest.mark.parametrize("frame", [0, 4])
def test_places_on_a_map_are_true_to_a_part_of_the_box(map_run, frame):
    run = load(map_run)
    scene = make_scene(run, PLENTY)
    snapshot, table = run[frame], scene.table
    shown = ~snapshot["fixed"] & (snapshot["grain"] < 0)
    planes = unpacked(scene.blocks[f"flow{frame}"], "wwww" + "s" * len(table["fields"]))
    place = np.stack(planes[:3], axis=1) / 65535 * table["size"] + table["corner"]
    assert table["frames"][frame]["flow"]["count"] == shown.sum() == len(place)
    nearest = np.abs(place[:, None] - snapshot["position"][shown]).max(axis=2).min(axis=1)
    assert nearest.max() <= 0.51 * max(table["size"]) / 65535 < 5e-5


def test_fields_span_what_moves(map_run):
    run = load(map_run)
    scene = make_scene(run, PLENTY)
    fields = {each["name"]: each for each in scene.table["fields"]}
    assert list(fields) == ["speed", "pressure", "depth", "material", "body"]
    assert fields["speed"]["low"] == 0
    assert fields["speed"]["high"] == pytest.approx(1.5, rel=0.01)
    assert fields["depth"]["high"] == pytest.approx(0.6, rel=0.25)
    assert fields["pressure"]["unit"] == "Pa"
    assert fields["material"]["names"] == ("water", "basalt", "aluminium")
    assert fields["material"]["colours"][2] == ""  # nothing of it moves
    planes = unpacked(scene.blocks["flow4"], "wwww" + "sssss")
    speeds = np.sort(
        np.linalg.norm(run[4]["velocity"][~run[4]["fixed"] & (run[4]["grain"] < 0)], axis=1)
    )
    shown = np.sort(planes[4]) / 255 * fields["speed"]["high"]
    assert np.abs(shown - np.minimum(speeds, fields["speed"]["high"])).max() < 0.6 * 1.5 / 255


def test_a_cube_is_a_hull_and_a_sphere_is_a_ball(map_run, tmp_path):
    run = load(map_run)
    shapes = rigid_shapes(run, run[2])  # whatever way it lies
    ((corners, triangles),) = shapes.hulls
    assert np.allclose(np.abs(corners), 0.15)
    assert len(corners) == 8
    assert len(triangles) == 12
    assert shapes.of_bodies(run[0]).sum() == 27
    ball = load(record_map(tmp_path / "ball", "sphere", 1))
    shapes = rigid_shapes(ball, ball[0])
    assert shapes.hulls == []
    assert shapes.shape == [-1]
    assert shapes.radius == pytest.approx([0.15 * np.sqrt(3)])


def test_deformable_bodies_are_their_particles(map_run, tmp_path):
    run = load(record_map(tmp_path / "elastic", "box", 1, "elastic"))
    scene = make_scene(run, PLENTY)
    assert "bodies" not in scene.table
    assert scene.table["flow"] == "flow and deformable bodies"
    assert scene.table["frames"][0]["flow"]["count"] == 240 + 27
    assert make_scene(load(map_run), PLENTY).table["flow"] == "flow"


def test_what_is_the_same_everywhere_is_no_scale(tmp_path, record_run):
    def state(_time):
        made, _ = map_state(0.0)
        made["grain"][:] = -1
        return made | {"pressure": np.zeros(len(made["id"])), "velocity": 0 * made["velocity"]}

    record_run(tmp_path / "run", dim=3, times=(0.0,), state_at=state, tables="")
    scene = make_scene(load(tmp_path / "run"), PLENTY)
    fields = {each["name"]: each for each in scene.table["fields"]}
    assert "pressure" not in fields
    assert (fields["speed"]["low"], fields["speed"]["high"]) == (0, 0)


def test_bodies_stand_where_they_stood(map_run):
    run = load(map_run)
    scene = make_scene(run, PLENTY)
    box = box_of(run)
    planes = unpacked(scene.blocks["bodies3"], "wwwwwwwssss")
    place = np.array([plane[0] for plane in planes[:3]]) / 65535 * box.size + box.corner
    assert np.abs(place - run[3].grains["position"][0]).max() < 5e-5
    turn = np.array([plane[0] for plane in planes[3:7]]) / 32767.5 - 1
    assert np.allclose(turn, run[3].grains["orientation"][0], atol=4e-5)
    assert planes[7][0] > 0


def test_hidden_particles_are_those_inside():
    position = 0.1 * np.stack(np.meshgrid(*[np.arange(12)] * 3, indexing="ij"), -1).reshape(-1, 3)
    surface = np.any((position < 0.05) | (position > 1.05), axis=1)
    inside = hidden(position, 0.1)
    assert not inside[surface].any()
    assert inside.sum() > 0.5 * (~surface).sum()
    assert not hidden(position[:, :2][surface] * 50, 0.1).any()
    assert hidden(position + CORNER, 0.1).sum() == pytest.approx(inside.sum(), rel=0.5)


def test_snapshots_are_spread_evenly():
    assert spread(5, 5) == [0, 1, 2, 3, 4]
    assert spread(3, 101) == [0, 50, 100]
    assert spread(1, 1) == [0]


def test_what_is_left_out_goes_in_order():
    """Particles inside, then snapshots, then particles at random."""

    def cost(thinning):
        count = 1000 * thinning.share * (0.5 if thinning.shell else 1.0)
        return 6.0 * count, int(count)

    plenty, less, little, least = (thinned(100, True, most, cost) for most in (1e6, 4e5, 2e5, 1e4))
    assert plenty == Thinning(100)
    assert (less.frames, less.shell, less.share) == (100, True, 1.0)
    assert (little.frames, little.share) == (66, 1.0)
    assert least.frames < 40
    assert least.share < 1
    for most, found in ((1e6, plenty), (4e5, less), (2e5, little), (1e4, least)):
        assert cost(found)[0] * found.frames <= most
    assert not thinned(100, False, 4e5, cost).shell


def test_the_size_is_kept_and_what_is_left_out_is_told(map_run):
    run = load(map_run)
    whole = make_scene(run, PLENTY)
    assert whole.notes == []
    needed = sum(map(len, whole.blocks.values()))
    small = make_scene(run, 0.4 * needed)
    assert sum(map(len, small.blocks.values())) < 0.55 * needed
    assert any("% of the particles that move are shown" in note for note in small.notes)
    assert small.table["swell"] > 1
    counts = [frame["flow"]["count"] for frame in small.table["frames"]]
    assert max(counts) < 240


def test_the_same_particles_are_kept_at_all_times():
    thinning = Thinning(1, share=0.3)
    ids = np.arange(10000)
    kept = thinning.kept(np.zeros((10000, 3)), 0.1, ids)
    assert 0.27 < kept.mean() < 0.33
    later = thinning.kept(np.zeros((5000, 3)), 0.1, ids[5000:])
    assert np.array_equal(later, kept[5000:])


class Raster:
    """Heights of a plane that falls to the north, with a hole."""

    def __init__(self, rows, columns):
        self.x, self.y = (
            5.0 * np.arange(columns) + CORNER[0],
            5.0 * np.arange(rows)[::-1] + CORNER[1],
        )
        self.values = 1500.0 + 0.1 * np.tile((self.y.max() - self.y)[:, None], columns)
        self.values[3, 4] = np.nan


def test_terrain_is_a_grid_from_the_south_west(map_run):
    raster = Raster(40, 30)
    grid = grid_of(raster)
    run = load(map_run)
    scene = make_scene(run, PLENTY, grid)
    table = scene.table["terrain"]
    assert (table["columns"], table["rows"]) == (30, 40)
    corner = np.array(scene.table["corner"]) + table["origin"]
    assert np.allclose(corner, [*CORNER[:2], 1500.0])
    assert np.allclose(table["spacing"], [5.0, 5.0, 19.5])
    heights = unpacked(scene.blocks["terrain"], "w")[0].reshape(40, 30)
    assert heights[36, 4] == NO_DATA  # the fourth row from the north
    assert heights[0, 0] == STEPS
    assert heights[39, 29] == 0
    assert grid_of(Raster(1200, 30)).heights.shape == (400, 10)


def test_the_ground_of_a_slice_reaches_from_below_to_its_profile(drawn_flow):
    x, z = np.array([-2.0, 0.0, 6.0]), np.array([1.0, 0.0, -3.0])
    scene = make_scene(load(drawn_flow), PLENTY, grid_below(x, z))
    table = scene.table["terrain"]
    assert table["upright"]
    corner = np.array(scene.table["corner"]) + table["origin"]
    assert np.allclose(corner, [-2.0, -3.0 - 0.05 * 8.0, 0.0])
    low, surface = unpacked(scene.blocks["terrain"], "w")[0].reshape(2, 3)
    heights = corner[1] + surface / STEPS * table["spacing"][2]
    places = corner[0] + table["spacing"][0] * np.arange(3)
    assert np.all(low == 0)
    assert np.allclose(heights, np.interp(places, x, z), atol=1e-4)


@pytest.mark.parametrize(
    ("height", "interval"), [(0.0, 1.0), (25.0, 1.0), (30.0, 2.0), (900, 50.0)]
)
def test_contours_are_some_twenty(height, interval):
    assert contour_interval(height) == pytest.approx(interval)


def test_strays_and_what_is_no_number_are_left_out(tmp_path, record_run):
    def state(_time):
        made, _ = map_state(0.0)
        made["position"][0] = np.nan
        made["position"][1] += 1e6
        made["grain"][:] = -1
        return made

    record_run(tmp_path / "run", dim=3, times=(0.0, 1.0), state_at=state, tables="")
    scene = make_scene(load(tmp_path / "run"), PLENTY)
    assert max(scene.table["size"]) < 100
    assert scene.notes == [
        *(
            f"{number:06d}.vtkhdf: 1 position is not finite: the snapshot is damaged; what is there"
            " is left out."
            for number in range(2)
        ),
        "2 particles far from all others are left out (all snapshots).",
    ]
