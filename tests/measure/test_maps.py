"""Maps of flows that are known exactly: depth, speed, pressures, arrival, deposit, run-out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from doseki.errors import UserError
from doseki.geodata.grid import Raster
from doseki.measure.maps.columns import columns_over
from doseki.measure.maps.files import rasters_of, read_maps, write_maps
from doseki.measure.maps.grid import MapSettings, few_particles, map_grid
from doseki.measure.maps.peaks import Peaks, beside_deposit, deposit
from doseki.measure.maps.profile import along_path, beside_map, path_lines
from doseki.measure.maps.runout import runout, runout_lines
from doseki.record.folder import RunFolder

WEST, SOUTH = 460_000.0, 5_200_000.0
G, RHO = 9.8, 1500.0
FREE, FIXED, DRIVEN, BOUND = 0, 1, 2, 3


def bed(rows=10, cols=20, cell=1.0, slope=0.0, west=WEST, south=SOUTH):
    """A plane that falls towards the east."""
    grid = Raster(np.zeros((rows, cols)), west, south, cell)
    return grid.with_values(np.tile(900.0 - slope * (grid.x - west), (rows, 1)))


def slab(low, high, dp, velocity=(0.0, 0.0, 0.0), motion=FREE):
    """Particles on a lattice that fills a box of the map, from z = 900 m."""
    axes = [np.arange(a + dp / 2, b, dp) for a, b in zip(low, high, strict=True)]
    position = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    n = len(position)
    return {
        "id": np.arange(n),
        "position": position + np.array([WEST, SOUTH, 900.0]),
        "velocity": np.tile(velocity, (n, 1)),
        "mass": np.full(n, RHO * dp**3), "density": np.full(n, RHO),
        "motion": np.full(n, motion, np.int32),
    }  # fmt: skip


def joined(*states):
    found = {name: np.concatenate([state[name] for state in states]) for name in states[0]}
    return found | {"id": np.arange(len(found["mass"]))}


def peaks_of(grid, *states, min_depth=0.05):
    peaks = Peaks(grid, min_depth, G)
    for time, state in enumerate(states):
        peaks.look(float(time), state)
    return peaks


@pytest.mark.parametrize("dp", [0.25, 0.3, 0.37])
def test_depth_is_volume_over_area_whatever_the_lattice(dp):
    """Cells that the slab fills have its depth to rounding, though no lattice fits them."""
    state = slab((0, 0, 0), (20 * dp, 20 * dp, 4 * dp), dp)
    peaks = peaks_of(bed(), state)
    inner = peaks.map_of("peak_depth")[::-1][: int(20 * dp), : int(20 * dp)]
    np.testing.assert_allclose(inner, 4 * dp, rtol=1e-9)
    total = peaks_of(bed(), state, min_depth=1e-9).map_of("peak_depth").sum()
    assert total == pytest.approx(4 * 20**2 * dp**3, rel=1e-9)
    # Whole particles in whole cells would be far off.
    cells = np.floor(state["position"][:, 0] - WEST)
    counts = np.bincount(cells.astype(int))[: int(20 * dp)]
    if dp != 0.25:
        assert np.ptp(counts) > 0.1 * counts.mean()


@pytest.mark.parametrize("angle", [0.3, 1.1, 2.6])
def test_turning_and_shifting_the_flow_changes_nothing(angle):
    """Volume, largest depth and speed of a heap under a rotation about the middle of the map."""
    random = np.random.default_rng(4)
    x = random.normal(0, 1.0, (5000, 3)) * (1.5, 1.5, 0.3)
    state = slab((0, 0, 0), (1, 1, 1), 1.0)
    state = {name: np.repeat(values, 5000, axis=0) for name, values in state.items()}
    state["mass"] = np.full(5000, RHO * 0.1**3)

    def mapped(turn, shift):
        c, s = np.cos(turn), np.sin(turn)
        rotation = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        state["position"] = x @ rotation.T + (WEST + 10 + shift, SOUTH + 10 + shift, 900)
        state["velocity"] = np.tile(rotation @ (3.0, 1.0, 0.0), (5000, 1))
        grid = bed(20, 20, west=WEST + shift, south=SOUTH + shift)
        peaks = peaks_of(grid, state, min_depth=1e-3)
        return [peaks.map_of(name) for name in ("peak_depth", "peak_speed")]

    base, turned, shifted = mapped(0, 0), mapped(angle, 0), mapped(0, 1000.0)
    np.testing.assert_allclose(shifted[0], base[0], atol=1e-8)
    assert turned[0].sum() == pytest.approx(base[0].sum(), rel=2e-3)
    assert turned[0].max() == pytest.approx(base[0].max(), rel=0.15)
    assert turned[1].max() == pytest.approx(np.hypot(3, 1), rel=1e-9)


def test_the_pressures_and_the_flux():
    slope = 0.75
    state = slab((0, 0, 0), (5, 5, 1), 0.25, velocity=(3.0, 0.0, -4.0))
    peaks = peaks_of(bed(slope=slope), state)
    at = peaks.map_of("peak_depth") > 0
    values = {name: peaks.map_of(name)[at] for name in peaks.values}
    np.testing.assert_allclose(values["peak_speed"], 5.0, rtol=1e-12)
    np.testing.assert_allclose(values["peak_pressure"], RHO * 25, rtol=1e-12)
    np.testing.assert_allclose(values["peak_momentum_flux"], 25.0, rtol=1e-12)
    weight = RHO * G * 1.0 / (1 + slope**2)  # cos2 of the slope
    np.testing.assert_allclose(values["peak_total_pressure"], RHO * 25 + weight, rtol=1e-12)
    assert at.sum() == 25


def test_speed_is_that_of_the_centre_of_mass():
    """Halves that move apart have none together; a mean of speeds would say 2 m/s."""
    one = slab((0, 0, 0), (5, 5, 0.5), 0.25, velocity=(2.0, 0, 0))
    other = slab((0, 0, 0.5), (5, 5, 1.0), 0.25, velocity=(-2.0, 0, 0))
    other = other | {name: 3 * other[name] for name in ("mass", "density")}
    speed = peaks_of(bed(), joined(one, other)).map_of("peak_speed")
    assert speed.max() == pytest.approx(1.0)


def test_peaks_last_and_arrivals_are_the_first():
    states = [
        slab((3 * k, 0, 0), (3 * k + 2, 2, height), 0.25, velocity=(k, 0, 0))
        for k, height in enumerate([1.0, 0.5, 0.75])
    ]
    states.append(slab((0, 0, 0), (2, 2, 0.25), 0.25))
    peaks = peaks_of(bed(), *states)
    depth, arrival = peaks.map_of("peak_depth")[-1], peaks.map_of("arrival_time")[-1]
    np.testing.assert_allclose(depth[:8], [1, 1, 0, 0.5, 0.5, 0, 0.75, 0.75])
    np.testing.assert_array_equal(arrival[:8], [0, 0, np.nan, 1, 1, np.nan, 2, 2])


def test_splashes_do_not_count():
    drop = slab((8, 8, 3), (8.25, 8.25, 3.25), 0.25, velocity=(30, 0, 0))
    water = slab((0, 0, 0), (2, 2, 1), 0.25)
    peaks = peaks_of(bed(), joined(water, drop), min_depth=0.125)
    assert peaks.map_of("peak_speed").max() == 0.0
    assert peaks_of(bed(), joined(water, drop), min_depth=0.01).map_of("peak_speed").max() == 30.0


def test_what_counts_as_flow():
    """Bodies that move count by their points; walls and what waits behind an inflow do not."""
    parts = [
        slab((5 * k, 0, 0), (5 * k + 2, 2, 1), 0.25, motion=motion)
        for k, motion in enumerate([FREE, FIXED, DRIVEN, BOUND])
    ]
    depth = peaks_of(bed(), joined(*parts)).map_of("peak_depth")[-1]
    np.testing.assert_allclose(depth[[0, 5, 10, 15]], [1, 0, 0, 1])


def test_the_deposit_is_what_is_slow():
    slow = slab((0, 0, 0), (2, 2, 0.5), 0.25, velocity=(0.05, 0, 0))
    fast = slab((0, 0, 0.5), (2, 2, 1), 0.25, velocity=(0.2, 0, 0))
    found = deposit(bed(), joined(slow, fast), speed=0.1, depth=0.1)
    assert found.sum() == pytest.approx(2.0)
    assert found.max() == pytest.approx(0.5)


def test_what_is_beside_the_map_is_told():
    half = slab((-2, 0, 0), (2, 2, 1), 0.25)
    peaks = peaks_of(bed(), half)
    assert peaks.outside == pytest.approx(0.5)
    assert peaks.map_of("peak_depth").sum() == pytest.approx(4.0)
    assert columns_over(bed(), half).outside == pytest.approx(4.0)
    far = half | {"position": half["position"] + 1e7}
    assert len(columns_over(bed(), far).cells) == 0


def test_the_state_goes_on_to_the_same_bits():
    random = np.random.default_rng(1)
    states = []
    for k in range(4):
        state = slab((k, 0, 0), (k + 4, 6, 1), 0.25, velocity=(k, 1, 0))
        state["position"] += random.normal(0, 0.1, state["position"].shape)
        states.append(state)
    straight = peaks_of(bed(), *states)
    before = peaks_of(bed(), *states[:2])
    after = Peaks(bed(), 0.05, G)
    after.state = {name: values.copy() for name, values in before.state.items()}
    for time in (2, 3):
        after.look(float(time), states[time])
    for name, values in straight.values.items():
        assert values.tobytes() == after.values[name].tobytes(), name
    assert after.outside == straight.outside


@pytest.mark.parametrize(
    "harm",
    [
        lambda s: s.pop("cells"),
        lambda s: s.pop("peak_speed"),
        lambda s: s.update(other=np.zeros(1)),
        lambda s: s.update(cells=s["cells"] + 10**6),
        lambda s: s.update(cells=s["cells"] - 10**6),
        lambda s: s.update(cells=s["cells"].astype(float)),
        lambda s: s.update(peak_depth=s["peak_depth"][:-1]),
        lambda s: s.update(peak_depth=s["peak_depth"] * np.nan),
        lambda s: s.update(outside=np.zeros(0)),
    ],
)
def test_the_state_of_another_map_is_refused(harm):
    state = peaks_of(bed(), slab((0, 0, 0), (4, 4, 1), 0.25)).state
    harm(state)
    with pytest.raises(ValueError, match=r"map"):
        Peaks(bed(), 0.05, G).state = state


@pytest.mark.parametrize("driver", ["AAIGrid", "GTiff"])
def test_maps_are_files_in_the_format_of_the_terrain(tmp_path, driver):
    if driver == "GTiff":
        rasterio = pytest.importorskip("rasterio", reason="pip install 'doseki[terrain]'")
    heights = bed().values.copy()
    heights[0, :3] = np.nan
    utm = "EPSG:32633" if driver == "GTiff" else None
    grid = Raster(heights, WEST, SOUTH, 1.0, utm, driver, 0.0)  # zero is no data of the terrain
    peaks = peaks_of(grid, slab((0, 0, 0), (4, 4, 1), 0.25))
    rasters = rasters_of(peaks, slab((0, 0, 0), (4, 4, 1), 0.25), MapSettings(0.25))
    folder = RunFolder(tmp_path)
    files = write_maps(folder, rasters, MapSettings(0.25), 2.5)
    assert len(files) == 8
    assert {file.suffix for file in files} == {grid.suffix}
    back = read_maps(folder)
    for name, raster in rasters.items():
        np.testing.assert_array_equal(back[name].values, raster.values)
        assert back[name].nodata == -9999.0
    depth = back["peak_depth"].values
    assert np.isnan(depth[0, :3]).all()
    assert depth[0, 4] == 0.0
    assert np.nanmax(back["deposit"].values) == pytest.approx(1.0)
    if driver == "GTiff":
        assert "32633" in back["peak_depth"].crs
        with rasterio.open(tmp_path / "maps/peak_depth.tif") as dataset:
            tags = dataset.tags()
        assert (tags["avaframe"], tags["unit"], tags["simulated_time"]) == ("pft", "m", "2.5 s")


def terrain_folder(path, raster):
    from doseki.geodata.raster import write_raster

    write_raster(path / "terrain.asc", raster)
    return RunFolder(path)


def test_the_grid_is_that_of_the_terrain(tmp_path):
    folder = terrain_folder(tmp_path, bed(slope=0.1))
    assert map_grid(folder, MapSettings(0.25)).same_grid(bed())
    coarse = map_grid(folder, MapSettings(0.25, cell=2.0))
    assert coarse.shape == (5, 10)
    part = map_grid(folder, MapSettings(0.25, extent=[WEST + 2.5, SOUTH, WEST + 5, SOUTH + 3]))
    assert part.extent == (WEST + 2, SOUTH, WEST + 5, SOUTH + 3)


@pytest.mark.parametrize(
    ("settings", "word"),
    [
        (MapSettings(0.25, cell=1.5), "^maps: maps.cell = 1.5 m is no whole multiple"),
        (MapSettings(0.25, cell=1.5, named="--"), "^--cell = 1.5 m is no whole multiple"),
        (MapSettings(2.0), "smaller than a particle .* give maps.cell of 2 dp or more"),
        (MapSettings(2.0, named="--"), "smaller than a particle .* give --cell of 2 dp or more"),
        (MapSettings(0.25, extent=[WEST - 1, SOUTH, WEST + 5, SOUTH + 3]), "beyond the raster"),
        (MapSettings(0.25, extent=[WEST + 5, SOUTH, WEST, SOUTH + 3]), "west < east"),
        (MapSettings(0.25, extent=[np.nan, SOUTH, WEST, SOUTH + 3]), "west < east"),
    ],
)
def test_a_grid_that_does_not_fit_is_refused(tmp_path, settings, word):
    with pytest.raises(UserError, match=word):
        map_grid(terrain_folder(tmp_path, bed()), settings)


def test_without_a_terrain_the_grid_is_given(tmp_path):
    with pytest.raises(UserError, match=r"has no terrain; give maps.extent .* and maps.cell, m"):
        map_grid(RunFolder(tmp_path), MapSettings(0.1, cell=1.0))
    with pytest.raises(UserError, match=r"has no terrain; give --extent .* and --cell, m"):
        map_grid(RunFolder(tmp_path), MapSettings(0.1, cell=1.0, named="--"))
    extent = [WEST, SOUTH, WEST + 3.5, SOUTH + 2]
    grid = map_grid(RunFolder(tmp_path), MapSettings(0.1, cell=1.0, extent=extent))
    assert grid.shape == (2, 4)
    with pytest.raises(UserError, match="at most"):
        map_grid(RunFolder(tmp_path), MapSettings(1e-9, cell=1e-6, extent=extent))


def test_small_cells_are_warned_of():
    assert few_particles(bed(), 0.5) is None
    assert "maps.cell = 1.2" in few_particles(bed(), 0.6)
    assert "--cell = 1.2" in few_particles(bed(), 0.6, "--")


def test_the_runout():
    """From the top of the release to the farthest cell that was covered."""
    grid = bed(slope=0.5)
    states = [slab((k, 3, 0), (k + 2, 5, 1), 0.25) for k in (2, 8, 14)]
    maps = rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25))
    found = runout(maps, grid)
    assert (found.area, found.deposit_area) == (12.0, 4.0)
    assert found.deposit_volume == pytest.approx(4.0)
    assert found.top[0] == WEST + 2.5
    assert found.toe[0] == WEST + 15.5
    assert found.distance == pytest.approx(np.hypot(13, 1))
    assert found.angle == pytest.approx(np.degrees(np.arctan2(6.5, np.hypot(13, 1))))


def test_there_is_no_runout_before_the_flow_has_left_its_beginning():
    """An inflow 6 m wide that has come 1 m is as long as it is wide, and no run-out."""
    grid = bed(slope=0.5)
    states = [slab((2, 2, 0), (k, 8, 1), 0.25, velocity=(1, 0, 0)) for k in (3, 4, 12)]
    for count, reach in ((1, None), (2, None), (3, np.hypot(9, 5))):
        peaks = peaks_of(grid, *states[:count])
        found = runout(rasters_of(peaks, states[count - 1], MapSettings(0.25)), grid)
        assert found.distance == (reach and pytest.approx(reach))
        assert (found.angle is None) == (reach is None)
        _, line = runout_lines(found, MapSettings(0.25))
        assert line.startswith("no run-out: the flow" if reach is None else "run-out 10.3 m at")


def test_what_flows_upwards_has_no_angle():
    grid = bed(slope=-0.5)
    states = [slab((k, 3, 0), (k + 2, 5, 1), 0.25, velocity=(12, 0, 0)) for k in (2, 14)]
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    assert found.distance > 10
    assert found.angle is None
    assert "not downhill" in list(runout_lines(found, MapSettings(0.25)))[1]


def spread(x, y, lengths):
    """That flow at each look; it leaves a film behind."""
    return [slab((x, y, 0), (x + k, y + 2, 1), 0.25, velocity=(4.0, 0, 0)) for k in lengths]


def test_still_water_is_no_part_of_a_flow():
    """A lake farther down than the flow comes is neither covered nor its toe."""
    grid = bed(rows=20, cols=60, slope=0.5)
    flow = spread(2, 8, (3, 6, 9, 12))
    lake = slab((40, 2, 0), (55, 18, 2), 0.5, velocity=(0.02, 0, 0))
    alone = peaks_of(grid, *flow)
    both = peaks_of(grid, *(joined(each, lake) for each in flow))
    found = runout(rasters_of(both, joined(flow[-1], lake), MapSettings(0.25)), grid)
    without = runout(rasters_of(alone, flow[-1], MapSettings(0.25)), grid)
    same = [(f.top, f.toe, f.distance, f.angle, f.area) for f in (found, without)]
    assert same[0] == same[1]
    assert found.distance == pytest.approx(np.hypot(11, 1))
    assert (found.still_area, found.still_volume) == pytest.approx((240.0, 480.0))
    assert (
        "480 m3 of what lies never moved: still water on 240 m2"
        in list(runout_lines(found, MapSettings(0.25)))[1]
    )
    assert (without.still_area, len(list(runout_lines(without, MapSettings(0.25))))) == (0.0, 2)


def test_a_lake_that_is_hit_and_moves_is_reached():
    """The control: the flow runs into it and all of it moves."""
    grid = bed(rows=20, cols=60, slope=0.5)
    lake = slab((12, 8, 0), (20, 10, 2), 0.5)
    moving = lake | {"velocity": np.tile((0.5, 0, 0), (len(lake["mass"]), 1))}
    states = [joined(each, lake) for each in spread(2, 8, (3, 6, 9))]
    states.append(joined(*spread(2, 8, (10,)), moving))
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    assert found.distance == pytest.approx(np.hypot(17, 1))
    assert found.still_area == 0.0


def test_the_runout_of_two_releases():
    """Of flows in two valleys it is the longer one; of flows that meet it begins at the upper."""
    grid = bed(rows=40, cols=80, slope=0.5)
    upper, lower = spread(2, 2, (3, 6, 9, 12)), spread(30, 34, (3, 8, 16, 24))
    states = [joined(*pair) for pair in zip(upper, lower, strict=True)]
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    assert found.top[0] == WEST + 30.5
    assert found.distance == pytest.approx(np.hypot(23, 1))
    below = spread(20, 2, (3, 8, 16, 24))
    states = [joined(*pair) for pair in zip(spread(2, 2, (3, 6, 12, 20)), below, strict=True)]
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    assert found.top[0] == WEST + 2.5
    assert found.distance == pytest.approx(np.hypot(41, 1))
    assert found.angle == pytest.approx(np.degrees(np.arctan2(20.5, np.hypot(41, 1))))


def test_an_inflow_above_a_lake_begins_where_it_enters():
    """Nothing of it is there at the first look; the lake, which trembles at its rim, is."""
    grid = bed(rows=20, cols=60, slope=0.5)
    lake, rim = slab((40, 2, 0), (54, 18, 2), 0.5), slab((54, 2, 0), (55, 18, 1), 0.5)
    rim["velocity"][:, 0] = 0.3
    flow = [[], *([each] for each in spread(2, 8, (3, 6, 9)))]
    states = [joined(lake, rim, *each) for each in flow]
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    assert found.top[0] == WEST + 2.5
    assert found.distance == pytest.approx(np.hypot(8, 1))


@pytest.mark.parametrize(
    ("length", "hole", "said"),
    [
        (18, None, "at the edge of the map: the flow may go on there"),
        (8, 10, "at cells without data: the flow may go on there"),
        (8, None, None),
    ],
)
def test_a_runout_that_ends_with_the_map_is_a_least_one(length, hole, said):
    grid = bed(slope=0.5)
    if hole is not None:
        grid.values[:, hole] = np.nan
    states = spread(2, 4, (3, length))
    found = runout(rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25)), grid)
    line = list(runout_lines(found, MapSettings(0.25)))[1]
    assert ("at least " in line) == (said is not None)
    assert line.endswith(said or " m")


def test_a_path_that_runs_uphill_is_called_that():
    grid = bed(slope=0.5)
    states = spread(2, 4, (3, 12))
    maps = rasters_of(peaks_of(grid, *states), states[-1], MapSettings(0.25))
    path = np.array([[WEST + 1, SOUTH + 4.5], [WEST + 18, SOUTH + 4.5]])
    for points, said in ((path, "m, at 26.6 degrees"), (path[::-1], "26.6 degrees uphill: ")):
        (line,) = path_lines(along_path(maps, grid, points))
        assert said in line


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ([[1, 1], [9, 1]], None),
        ([[0, 0], [0, 8]], None),
        ([[1, 1], [9, 1], [9, -90]], "90 of its 99 m"),
        ([[-3, -4], [3, 4]], "5 of its 10 m"),
        ([[-6, 5], [-2, 5], [2, 5], [2, 1]], "6 of its 12 m"),
        ([[-1, 1], [-1, 5], [1, 5]], "5 of its 6 m"),
    ],
)
def test_how_much_of_a_path_lies_beside_the_map_is_told(path, said):
    """Exactly, whatever the cells are; cells without data are on the map."""
    grid = bed()
    points = np.array(path, float) + np.array([WEST, SOUTH])
    assert list(beside_map(grid.with_values(np.full(grid.shape, np.nan)), points)) == list(
        beside_map(grid, points)
    )
    found = list(beside_map(grid, points))
    assert len(found) == (said is not None)
    if said is not None:
        assert said in found[0]


@pytest.mark.parametrize("driver", ["AAIGrid", "GTiff"])
@pytest.mark.parametrize(
    ("own", "used"),
    [(None, -9999), (-32768, -32768), (0, -9999), (9999, -9999), (-3.4e38, -3.4e38), (1e38, 1e38)],
)
def test_no_data_is_the_number_of_the_terrain_where_it_can_be_no_result(own, used, driver):
    grid = Raster(bed().values, WEST, SOUTH, 1.0, None, driver, own)
    state = slab((0, 0, 0), (4, 4, 1), 0.25)
    rasters = rasters_of(peaks_of(grid, state), state, MapSettings(0.25))
    assert {raster.nodata for raster in rasters.values()} == {used}


def test_only_geotiffs_have_nan_for_no_data():
    state = slab((0, 0, 0), (4, 4, 1), 0.25)
    for driver, same in (("AAIGrid", False), ("GTiff", True)):
        grid = Raster(bed().values, WEST, SOUTH, 1.0, None, driver, np.nan)
        rasters = rasters_of(peaks_of(grid, state), state, MapSettings(0.25))
        assert np.isnan(rasters["peak_depth"].nodata) == same


def test_the_runout_without_heights_or_flow():
    grid = bed()
    flat = grid.with_values(np.full(grid.shape, np.nan))
    state = slab((0, 0, 0), (2, 2, 1), 0.25)
    found = runout(rasters_of(peaks_of(flat, state), state, MapSettings(0.25)), flat)
    assert (found.area, found.angle) == (4.0, None)
    nothing = slab((0, 0, 0), (2, 2, 1), 0.25, motion=FIXED)
    found = runout(rasters_of(peaks_of(grid, nothing), nothing, MapSettings(0.25)), grid)
    assert (found.area, found.deposit_volume, found.angle) == (0.0, 0.0, None)


def test_a_profile():
    grid = bed(slope=0.5)
    state = slab((2, 3, 0), (6, 7, 1), 0.25, velocity=(2, 0, 0))
    maps = rasters_of(peaks_of(grid, state), state, MapSettings(0.25))
    path = np.array([[WEST + 1, SOUTH + 5.5], [WEST + 9, SOUTH + 5.5], [WEST + 9, SOUTH + 99.0]])
    found = along_path(maps, grid, path)
    wet = (found["x"] > WEST + 2) & (found["x"] < WEST + 6)
    np.testing.assert_allclose(found["peak_depth"][wet], 1.0)
    np.testing.assert_allclose(found["peak_depth"][~wet & (found["y"] < SOUTH + 6)], 0.0)
    np.testing.assert_allclose(found["bed"][wet], 900 - 0.5 * (found["x"][wet] - WEST))
    assert found["distance"][-1] == pytest.approx(8 + 93.5)
    assert np.isnan(found["peak_depth"][-1])  # beside the map


@pytest.mark.parametrize(
    ("path", "word"),
    [
        ([[0, 0]], "two points"),
        ([[1, 1], [1, 1]], "two points"),
        ([[0, 0], [5, 5]], "beside the map, which has x from [0-9.]* to .* m and y"),
    ],
)
def test_a_path_that_is_none_is_refused(path, word):
    state = slab((2, 3, 0), (6, 7, 1), 0.25)
    maps = rasters_of(peaks_of(bed(), state), state, MapSettings(0.25))
    with pytest.raises(UserError, match=word):
        along_path(maps, bed(), np.array(path, float))


def test_what_is_not_in_the_deposit_is_told_with_why():
    """Half a metre of 16 m2 lies, and 0.2 m; a cube is fast, and a strip lies beside the map."""
    grid = bed(slope=0.5)
    parts = [
        slab((0, 0, 0), (4, 4, 1), 0.5),
        slab((8, 0, 0), (12, 4, 0.2), 0.2),
        slab((14, 4, 0), (16, 6, 1), 0.5, velocity=(0.2, 0, 0)),
        slab((-4, 0, 0), (-1, 2, 1), 0.5),
    ]
    state, settings = joined(*parts), MapSettings(0.5)
    beside = beside_deposit(grid, state, settings.speed_deposit, settings.dry_below)
    assert beside == pytest.approx({"moving": 4.0, "thin": 3.2, "beside": 6.0})
    found = runout(rasters_of(peaks_of(grid, state), state, settings), grid)
    assert found.deposit_volume == pytest.approx(16.0)
    first, second, *_ = runout_lines(replace(found, beside_deposit=beside), settings)
    assert first.endswith("16 m3 lie on 16 m2")
    assert second == (
        "not in the deposit: 4 m3 faster than 0.1 m/s, "
        "3.2 m3 in cells less than 0.25 m deep (maps.min_depth), 6 m3 beside the map"
    )
    whole = beside_deposit(grid, parts[0], settings.speed_deposit, settings.dry_below)
    lines = list(runout_lines(replace(found, beside_deposit=whole), settings))
    assert not any("not in the deposit" in line for line in lines)
