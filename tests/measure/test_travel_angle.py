"""Travel angles of particles whose way is known, and contours of the largest depth."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.geodata.features import read_features
from doseki.geodata.grid import Raster
from doseki.measure.maps.contours import contours, levels_of, write_contours
from doseki.measure.maps.peaks import Peaks
from doseki.measure.maps.quantities import PEAK_DEPTH, PEAK_TRAVEL_ANGLE

WEST, SOUTH = 460_000.0, 5_200_000.0


def grid(rows=20, cols=40, values=0.0):
    return Raster(np.full((rows, cols), values), WEST, SOUTH, 1.0)


def state(place, numbers=None, motion=0):
    """Particles of 1 m3 at places (n, 3) of the map."""
    place = np.array(place, dtype=float)
    n = len(place)
    return {
        "id": np.arange(n) if numbers is None else np.array(numbers),
        "position": place + np.array([WEST, SOUTH, 0.0]),
        "velocity": np.zeros((n, 3)), "mass": np.full(n, 1000.0), "density": np.full(n, 1000.0),
        "motion": np.full(n, motion, np.int32),
    }  # fmt: skip


def angles(*states, min_depth=1e-3, periods=()):
    peaks = Peaks(grid(), min_depth, 9.8, periods)
    for k, each in enumerate(states):
        peaks.look(float(k), each)
    return peaks


def angle_at(peaks, x, y):
    return peaks.map_of(PEAK_TRAVEL_ANGLE.name)[::-1][int(y), int(x)]


def slide(steps, tilt, turn=0.0):
    """Down a slope, along a direction on the map."""
    way = np.array([np.cos(turn), np.sin(turn)])
    return [state([[*(np.array([5.5, 5.5]) + s * way), 100 - tilt * s]]) for s in steps]


@pytest.mark.parametrize("turn", [0.0, 0.6, np.pi / 2])
def test_a_slide_down_a_plane_has_the_angle_of_the_plane(turn):
    peaks = angles(*slide(np.arange(0, 9.0), 0.4, turn))
    place = np.array([5.5, 5.5]) + 8.0 * np.array([np.cos(turn), np.sin(turn)])
    assert angle_at(peaks, *place) == pytest.approx(np.degrees(np.arctan(0.4)))


@pytest.mark.parametrize(("axis", "sign"), [(0, 1), (0, -1), (1, 1)])
def test_along_a_periodic_axis_the_way_is_that_to_the_nearest_image(axis, sign):
    """Out at one side of the map and in at the other."""
    low = (WEST, SOUTH)[axis]
    length = (40.0, 20.0)[axis]
    states = []
    for s in np.arange(0, 9.0):
        place = np.array([5.5, 5.5, 100 - 0.4 * s])
        place[axis] = ((length - 3.5 if sign > 0 else 3.5) + sign * s) % length
        states.append(state([place]))
    end = states[-1]["position"][0, :2] - (WEST, SOUTH)
    peaks = angles(*states, periods=[(axis, low, low + length), (2, 0.0, 200.0)])
    assert angle_at(peaks, *end) == pytest.approx(np.degrees(np.arctan(0.4)))
    assert angle_at(angles(*states), *end) < 10  # the control


def test_the_way_counts_and_not_the_distance():
    """There and back: at the place where it began it has fallen 2 m on a way of 8 m."""
    way = [[5.5, 5.5, 100], [9.5, 5.5, 99], [5.5, 5.5, 98]]
    peaks = angles(*(state([place]) for place in way))
    assert angle_at(peaks, 5.5, 5.5) == pytest.approx(np.degrees(np.arctan(2 / 8)))


def test_the_largest_of_all_particles_and_times_stays():
    high = [[2.5, 5.5, 110.0], [12.5, 5.5, 100.0]]
    low = [[10.5, 5.5, 100.5], [12.5, 5.5, 100.0]]
    peaks = angles(*(state([a, b]) for a, b in zip(high, low, strict=True)), state([[30, 5, 90.0]]))
    assert angle_at(peaks, 12.5, 5.5) == pytest.approx(np.degrees(np.arctan(10 / 10)))


def test_what_falls_on_the_spot_and_what_enters_later_has_none():
    falls = [state([[5.5, 5.5, z]], [7]) for z in (100.0, 90.0)]
    enters = state([[5.5, 5.5, 90.0], [20.5, 5.5, 50.0]], [7, 9])
    peaks = angles(*falls, enters)
    assert not peaks.map_of(PEAK_TRAVEL_ANGLE.name).any()


def test_numbers_may_come_in_any_order_and_the_state_goes_on():
    first = state([[5.5, 5.5, 100.0], [5.5, 9.5, 100.0]], [4, 2])
    second = state([[15.5, 9.5, 95.0], [15.5, 5.5, 90.0]], [2, 4])
    whole, before, after = angles(first, second), angles(first), angles()
    assert angle_at(whole, 15.5, 5.5) == pytest.approx(45.0)
    assert angle_at(whole, 15.5, 9.5) == pytest.approx(np.degrees(np.arctan(0.5)))
    after.state = before.state
    after.look(1.0, second)
    for name, values in whole.values.items():
        np.testing.assert_array_equal(after.values[name], values)


@pytest.mark.parametrize(
    "harm",
    [
        lambda s: s.update(travel_id=s["travel_id"][::-1]),
        lambda s: s.update(travel_id=s["travel_id"].astype(float)),
        lambda s: s.update(travel_place=s["travel_place"][:1]),
        lambda s: s.update(travel_start=s["travel_start"] * np.nan),
        lambda s: s.update(travel_length=s["travel_length"] - 1),
    ],
)
def test_a_damaged_state_is_refused(harm):
    kept = angles(state([[5.5, 5.5, 100.0], [5.5, 9.5, 100.0]], [2, 4])).state
    harm(kept)
    with pytest.raises(ValueError, match="map"):
        angles().state = kept


def cone():
    x, y = np.meshgrid(np.arange(40) + 0.5, np.arange(20) + 0.5)
    return np.maximum(4.0 - 0.5 * np.hypot(x - 20, y - 10), 0.0)[::-1]


def test_contours_of_a_cone_are_circles_at_map_coordinates():
    raster = grid().with_values(cone())
    (found,) = contours(raster, [1.0])
    (line,) = found["geometry"]["coordinates"]
    points = np.array(line) - [WEST + 20, SOUTH + 10]
    np.testing.assert_allclose(np.hypot(*points.T), 6.0, atol=0.06)
    np.testing.assert_array_equal(points[0], points[-1])
    assert contours(raster, [5.0]) == []


def test_levels_are_round_and_end_below_the_largest():
    raster = grid().with_values(cone())
    levels = levels_of(raster, 0.05)
    assert levels == [0.05, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5]
    assert levels_of(grid(), 0.05) == []


def test_a_flow_at_the_edge_has_a_closed_line():
    raster = grid(values=1.0)
    (found,) = contours(raster, [0.5])
    (line,) = found["geometry"]["coordinates"]
    assert line[0] == line[-1]


@pytest.mark.parametrize("crs", [None, "EPSG:32633"])
def test_the_file_is_read_back_as_lines(tmp_path, crs):
    raster = Raster(cone(), WEST, SOUTH, 1.0, crs)
    path = tmp_path / "contours.geojson"
    write_contours(path, raster, PEAK_DEPTH, 0.05)
    table = json.loads(path.read_text())
    assert [f["properties"]["level"] for f in table["features"]][:2] == [0.05, 0.5]
    assert all(f["properties"]["unit"] == "m" for f in table["features"])
    found = read_features(path)
    assert len(found.lines) >= 8
    assert (table.get("crs") is None) == (crs is None)
