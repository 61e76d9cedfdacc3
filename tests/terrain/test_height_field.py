"""The surface between the nodes of a grid, and particles below it."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.compiled import load_core

CELL = 0.5


def field_1d(heights, origin=-1.0):
    heights = np.asarray(heights, float)
    table = {"origin": [origin], "cell": CELL, "heights": heights}
    return load_core().HeightField2(table | {"unknown": np.zeros(len(heights), np.uint8)})


def field_2d(height, nodes=(9, 7), origin=(-1.0, 2.0), unknown=None):
    x = origin[0] + CELL * np.arange(nodes[0])
    y = origin[1] + CELL * np.arange(nodes[1])
    z = height(*np.meshgrid(x, y))
    unknown = np.zeros(z.shape, np.uint8) if unknown is None else unknown
    table = {"origin": list(origin), "cell": CELL, "heights": z, "unknown": unknown}
    return load_core().HeightField3(table), x, y, z


def test_it_passes_through_its_nodes():
    rng = np.random.default_rng(3)
    random = rng.normal(size=(7, 9))
    field, x, y, z = field_2d(lambda u, v: random)
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    assert field.at(places)["height"] == pytest.approx(z.reshape(-1), abs=1e-13)


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.3, 0.0), (-0.4, 1.1)])
def test_a_plane_stays_a_plane_also_beyond_the_grid(slope):
    field, *_ = field_2d(lambda x, y: 7 + slope[0] * x + slope[1] * y)
    places = np.random.default_rng(4).uniform(-8, 12, (200, 2))
    found = field.at(places)
    assert found["height"] == pytest.approx(7 + places @ slope, abs=1e-11)
    normal = np.array([-slope[0], -slope[1], 1.0])
    assert found["normal"] == pytest.approx(np.tile(normal / np.linalg.norm(normal), (200, 1)))
    assert found["area"] == pytest.approx(np.full(200, np.linalg.norm(normal)))


def test_normals_are_those_of_the_heights_and_continuous():
    field, *_ = field_2d(lambda x, y: np.sin(2 * x) + np.cos(3 * y) + x * y)
    places = np.random.default_rng(5).uniform((-1.3, 1.7), (3.3, 5.3), (300, 2))
    step = 1e-6
    slope = np.stack(
        [
            (field.at(places + e)["height"] - field.at(places - e)["height"]) / (2 * step)
            for e in step * np.eye(2)
        ],
        axis=1,
    )
    normal = np.column_stack([-slope, np.ones(len(slope))])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    assert field.at(places)["normal"] == pytest.approx(normal, abs=1e-6)
    for edge in np.arange(-1.0, 3.0, CELL):
        sides = [field.at(np.array([[edge + d, 2.9]]))["normal"] for d in (-1e-9, 1e-9)]
        assert sides[0] == pytest.approx(sides[1], abs=1e-6)


def test_a_grid_that_is_turned_round_gives_the_same_surface():
    field, _x, _y, z = field_2d(lambda u, v: np.sin(u) * np.cos(2 * v))
    table = {"cell": CELL, "unknown": np.zeros(z.T.shape, np.uint8)}
    swapped = load_core().HeightField3(
        table | {"origin": [2.0, -1.0], "heights": np.ascontiguousarray(z.T)}
    )
    places = np.random.default_rng(6).uniform((-2, 1), (4, 6), (100, 2))
    other = swapped.at(np.ascontiguousarray(places[:, ::-1]))
    assert field.at(places)["height"] == pytest.approx(other["height"], abs=1e-12)


@pytest.mark.parametrize("distance", [0.2, -0.1, 1.0])
def test_the_nearest_place_is_at_the_foot_of_the_normal(distance):
    field, *_ = field_2d(lambda x, y: 0.3 * np.sin(0.7 * x) + 0.2 * y)
    places = np.random.default_rng(7).uniform((-0.5, 2.5), (2.5, 4.5), (50, 2))
    surface = field.at(places)
    foot = np.column_stack([places, surface["height"]])
    found = field.nearest(np.ascontiguousarray(foot + distance * surface["normal"]))
    assert found["distance"] == pytest.approx(np.full(50, distance), abs=2e-3)


def test_unknown_places_are_those_of_the_map_and_beyond():
    unknown = np.zeros((7, 9), np.uint8)
    unknown[2, 3] = 1
    field, *_ = field_2d(lambda x, y: 0 * x, unknown=unknown)
    places = np.array([[0.5, 3.0], [0.5, 3.5], [-1.3, 3.0], [0.7, 2.9]])
    assert field.at(places)["unknown"].tolist() == [1, 0, 1, 1]


@pytest.mark.parametrize("steep", [0.0, 0.5, 1.0, 2.0])
def test_columns_stand_on_equal_areas_whatever_the_slope(steep):
    field, *_ = field_2d(lambda x, y: steep * x - 0.3 * steep * y)
    dp, side = 0.05, 0.4
    columns = field.layer([0.0, 3.0], side, dp, 0.0)
    area = np.sqrt(1 + steep**2 * 1.09)
    assert columns["area"].sum() == pytest.approx(side**2 * area, rel=1e-9)
    assert columns["area"] == pytest.approx(np.full(len(columns["area"]), dp**2), rel=0.08)
    assert (columns["place"] >= [0.0, 3.0]).all()
    assert (columns["place"] <= [side, 3.0 + side]).all()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"heights": np.zeros(1)}, "fewer than 2"),
        ({"heights": np.zeros((3, 3))}, "dimension"),
        ({"heights": np.array([0.0, np.nan, 1.0])}, "not finite"),
        ({"cell": 0.0}, "no cell"),
        ({"unknown": np.zeros(2, np.uint8)}, "differ in shape"),
        ({"colour": 3}, "colour"),
    ],
)
def test_what_is_no_grid_is_refused(change, said):
    table = {
        "origin": [0.0], "cell": 1.0, "heights": np.zeros(3), "unknown": np.zeros(3, np.uint8),
    }  # fmt: skip
    with pytest.raises(ValueError, match=said):
        load_core().HeightField2(table | change)
