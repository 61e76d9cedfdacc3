"""The bed that [terrain] reads: windows, cells, sections, profiles, and what is refused."""

from __future__ import annotations

import time
import tracemalloc

import numpy as np
import pytest

from doseki.assess.preflight import check_scenario
from doseki.errors import UserError
from doseki.geodata.ground import read_ground, write_ground
from doseki.geodata.raster import Raster, write_raster
from doseki.record.reader import load
from doseki.running.runner import run_scenario
from doseki.scenario.islands import islands_of
from doseki.scenario.load import load_scenario
from doseki.scene.checks.terrain import HolesAsHeights, TiltedGravity, Weightless, terrain_findings

from .scenes import grid, profile, text

BLOCK = """
[body.slide]
shape = "release"
material = "water"
{place}
thickness = 0.2
"""
PLACE = {2: "between = [1, 2]", 3: "polygon = [[1, 1], [2, 1], [2, 2], [1, 2]]"}


@pytest.fixture
def path(tmp_path):
    """A 3-D scenario on a plane slope."""
    grid(tmp_path / "terrain.asc", lambda x, y: 10 - 0.5 * x + 0.1 * y)
    file = tmp_path / "case.toml"
    file.write_text(text(3, more=BLOCK.format(place=PLACE[3])))
    return file


def test_a_map_is_used_in_its_own_coordinates(path):
    bed = load_scenario(path).bed
    assert bed.origin == pytest.approx([0.05, 0.05])
    assert bed.cell == pytest.approx(0.1)
    assert bed.heights.shape == (40, 60)
    assert bed.heights[0, 0] == pytest.approx(10 - 0.025 + 0.005)
    assert bed.heights[-1, 0] > bed.heights[0, 0]  # rows go north


def test_window_cell_and_smoothing(path):
    bed = load_scenario(path, ["terrain.window=[0.5, 0.5, 3.5, 2.5]"]).bed
    low, high = bed.extent
    assert low == pytest.approx([0.5, 0.5])
    assert high == pytest.approx([3.5, 2.5])
    coarse = load_scenario(path, ["terrain.resample=0.2", "terrain.smoothing=0.5"]).bed
    assert coarse.heights.shape == (20, 30)
    x, y = (coarse.origin[k] + 0.2 * np.arange(n) for k, n in ((0, 30), (1, 20)))
    plane = 10 - 0.5 * x[None, :] + 0.1 * y[:, None]
    assert coarse.heights == pytest.approx(plane, abs=1e-9)  # a plane stays a plane


@pytest.mark.parametrize("suffix", [".asc", ".tif"])
def test_a_window_is_what_is_used_of_the_map(path, tmp_path, suffix):
    """Resampled and smoothed by itself; what lies beyond it is not looked at."""
    values = np.random.default_rng(5).normal(10, 1, (40, 60))
    values[2, 3] = -9999.0
    values[3, 3] = 1e6
    whole = Raster(values, 0.0, 0.0, 0.1, nodata=-1.0)
    write_raster(tmp_path / f"terrain{suffix}", whole)
    path.write_text(path.read_text().replace("terrain.asc", f"terrain{suffix}"))
    settings = ["terrain.resample=0.2", "terrain.smoothing=0.5"]
    bed = load_scenario(path, ["terrain.window=[0.5, 0.5, 3.5, 2.5]", *settings]).bed
    expected = whole.window(0.5, 0.5, 3.5, 2.5).resampled(0.2).smoothed(0.5)
    np.testing.assert_array_equal(bed.raster.values, expected.values)
    assert bed.raster.extent == expected.extent
    np.testing.assert_array_equal(bed.as_read.values, whole.window(0.5, 0.5, 3.5, 2.5).values)
    with pytest.raises(UserError, match=r"terrain.window: .* reaches beyond the raster"):
        load_scenario(path, ["terrain.window=[0.5, 0.5, 3.5, 4.5]"])
    with pytest.raises(UserError, match="1 cells hold -9999"):
        load_scenario(path, ["terrain.window=[0.1, 0.5, 3.5, 4]"])
    with pytest.raises(UserError, match="in the window: row 1, column 3 holds 1e\\+06"):
        load_scenario(path, ["terrain.window=[0.1, 0.5, 3.5, 3.7]"])


def test_numbers_that_are_no_heights_are_refused(path, tmp_path):
    """A map that does not say that -9999 means no data would have a pit of ten kilometres."""
    kept = (tmp_path / "terrain.asc").read_text()
    lines = [line for line in kept.splitlines() if not line.lower().startswith("nodata")]
    lines[-1] = " ".join(["-9999", *lines[-1].split()[1:]])
    (tmp_path / "terrain.asc").write_text("\n".join(lines) + "\n")
    with pytest.raises(UserError, match="1 cells hold -9999, which is no height"):
        load_scenario(path)


@pytest.mark.parametrize(("value", "rise"), [(0.0, 1000.0), (1e4, 5.0)])
def test_holes_that_are_written_as_heights_are_told(path, tmp_path, value, rise):
    """A map of 1000 m has pits of 1000 m where holes are 0, also where cells are averaged."""

    def hills(x, y):
        return rise + 0.5 * x + np.sin(x + 2 * y)

    grid(tmp_path / "terrain.asc", hills)
    assert load_scenario(path).bed.islands is None
    holes = [(2.85, 1.05), (2.85, 1.15), (2.95, 1.15), (4.05, 3.05)]

    def with_holes(x, y):
        is_hole = sum(np.isclose(x, a) & np.isclose(y, b) for a, b in holes)
        return np.where(is_hole, value, hills(x, y))

    grid(tmp_path / "terrain.asc", with_holes)
    for settings in ([], ["terrain.resample=0.2"]):
        (said,) = told_of_holes(load_scenario(path, settings))
        assert said.startswith(f"terrain.file: 4 cells stand at {value:g} m, ")
        assert "as at [4.05, 3.05] m" in said
        assert f"gdal_edit -a_nodata {value:g} IN; .asc: a line NODATA_value {value:g}" in said
    assert told_of_holes(load_scenario(path, ["terrain.window=[0, 0, 2.5, 4]"])) == []


def test_holes_of_several_heights_have_no_one_number(path, tmp_path):
    """The file can name one number for no data alone, with all of its digits."""

    def holes(low, high):
        def height(x, y):
            hole = np.where(x > 3, high, low)
            return np.where(np.isclose(y, 1.05) & (np.abs(x - 3) < 0.1), hole, 1000 + x)

        return height

    grid(tmp_path / "terrain.asc", holes(12.3456789, 12.3456789))
    (said,) = told_of_holes(load_scenario(path))
    assert "-a_nodata 12.3456789 IN; .asc: a line NODATA_value 12.3456789)" in said
    grid(tmp_path / "terrain.asc", holes(12.0, 12.5))
    (said,) = told_of_holes(load_scenario(path))
    assert "2 cells stand at 12 to 12.5 m" in said
    assert "nodata" not in said.lower()


@pytest.mark.parametrize(("low", "told"), [(5.0, False), (1000.0, True)])
def test_large_parts_at_0_are_a_sea_unless_they_are_far_below(path, tmp_path, low, told):
    """40 % of a map: the sea at a quay of 5 m, or what a map of mountains does not know."""
    grid(tmp_path / "terrain.asc", lambda x, y: np.where(x < 0.4 * 6, 0.0, low + 0.1 * x))
    assert bool(told_of_holes(load_scenario(path))) == told


def test_the_floor_of_a_flume_is_no_hole(path, tmp_path):
    def flume(x, y):
        return np.where(np.abs(y - 2) < 0.5, 0.0, 4.0)

    grid(tmp_path / "terrain.asc", flume)
    assert load_scenario(path).bed.islands is None


def test_parts_wind_around_cells_without_data():
    """The only way between two plateaus leads around a corner; cells without data are none."""
    values = np.full((40, 40), 100.0)
    values[10:13, 10:13], values[11, 11] = 0.0, np.nan
    values[20, 5:], values[20, 39] = np.nan, 100.0
    values[30, 30:33] = values[31, 32] = values[32, 32] = 0.0
    found = islands_of(Raster(values, 0.0, 0.0, 1.0))
    assert (found.cells, found.low, found.high, found.jump) == (8 + 5, 0.0, 0.0, 100.0)
    assert found.place == (10.5, 29.5)


def test_holes_are_looked_for_when_asked_and_fast(path, tmp_path, monkeypatch):
    """Once for all that ask; a map of four million cells takes 0.2 s and six times its size."""
    grid(tmp_path / "terrain.asc", lambda x, y: np.where((x < 0.2) & (y < 0.1), 0, 1000 + x))
    calls = []
    monkeypatch.setattr(
        "doseki.scenario.bed.islands_of", lambda r: calls.append(r) or islands_of(r)
    )
    scenario = load_scenario(path)
    assert not calls
    assert told_of_holes(scenario) == told_of_holes(scenario) != []
    assert len(calls) == 1
    values = 1000 + np.add.outer(np.zeros(2000), np.arange(2000.0) % 7)
    values[100:103, 200:204] = 0.0
    tracemalloc.start()
    began = time.process_time()
    assert islands_of(Raster(values, 0.0, 0.0, 1.0)).cells == 12
    assert time.process_time() - began < 1.0
    assert tracemalloc.get_traced_memory()[1] < 6 * values.nbytes
    tracemalloc.stop()


def told_of_holes(scenario):
    found = terrain_findings(scenario, {})
    return [str(each) for each in found if isinstance(each, HolesAsHeights)]


def test_steep_ground_and_steps_are_no_holes(path, tmp_path):
    """A wall of ten cells that a path leads up to, and a tower that is not sheer enough."""

    def cliff(x, y):
        ramp = np.clip(x - 1, 0, 4) / 4
        return np.where(y > 2, 2.0, 2.0 * ramp) + np.where((x > 5) & (y > 3), 3.0, 0.0)

    grid(tmp_path / "terrain.asc", cliff)
    assert load_scenario(path).bed.islands is None


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("number", ["1e30", "-3.40282346639e+38", "123456"])
def test_numbers_that_no_ground_reaches_are_refused(path, tmp_path, number):
    lines = (tmp_path / "terrain.asc").read_text().splitlines()
    words = lines[-3].split()
    lines[-3] = " ".join([*words[:7], number, *words[8:]])
    (tmp_path / "terrain.asc").write_text("\n".join(lines) + "\n")
    with pytest.raises(UserError, match=r"terrain.asc: row 38, column 8 holds .* within 100000 m"):
        load_scenario(path)


def test_cells_without_data_are_filled_and_said(path, tmp_path):
    x, y = np.meshgrid(np.arange(60), np.arange(40))
    values = np.where((x > 45) & (y > 25), np.nan, 10 - 0.05 * x)
    write_raster(tmp_path / "terrain.asc", Raster(values[::-1], 0.0, 0.0, 0.1))
    bed = load_scenario(path).bed
    assert np.isfinite(bed.heights).all()
    assert bed.unknown.sum() == 14 * 14
    assert bed.unknown_share == pytest.approx(196 / 2400)


@pytest.mark.parametrize("driver", ["AAIGrid", "GTiff"])
def test_the_ground_may_have_the_number_for_no_data_of_its_file(tmp_path, driver):
    """Of cells with 0 and 2 m the mean is the 1 m that means no data in the file."""
    if driver == "GTiff":
        pytest.importorskip("rasterio", reason="pip install 'doseki[terrain]'")
    values = np.tile([[0.0, 2.0], [2.0, 0.0]], (10, 15))
    values[:4, :4] = np.nan
    raster = Raster(values, 0.0, 0.0, 0.1, None, driver, 1.0)
    file = f"terrain{raster.suffix}"
    write_raster(tmp_path / file, raster)
    path = tmp_path / "case.toml"
    more = BLOCK.format(place=PLACE[3])
    path.write_text(text(3, more=more).replace("terrain.asc", file))
    ground = load_scenario(path, ["terrain.resample=0.2"]).bed.ground
    assert (ground.values[2:] == 1.0).all()
    (tmp_path / "run").mkdir()
    write_ground(tmp_path / "run", ground)
    np.testing.assert_array_equal(read_ground(tmp_path / "run").values, ground.values)


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        (["terrain.window=[-5, 0, 3, 2]"], "reaches beyond the raster"),
        (["maps.cell=0.15"], "no whole multiple of the terrain's 0.1 m"),
        (["maps.extent=[1, 1, 9, 2]"], "maps: extent .* reaches beyond the raster"),
        (["terrain.window=[3, 0, 1, 2]"], "smaller ones first"),
        (["terrain.window=[3, 0, 1]"], "terrain.window"),
        (["terrain.resample=9"], "terrain.resample: .* larger than the raster"),
        (["terrain.smoothing=900"], "longer than the raster"),
        (["terrain.material=water"], "a fluid; a bed is a solid"),
        (["terrain.material=cheese"], "not a known material"),
        (["terrain.section=[[0, 0], [1, 1]]"], "2-D"),
        (["terrain.file=nothing.asc"], "nothing.asc: no such file in /"),
        (["terrain.digest=" + "0" * 32], "is not the file that was meant"),
        (["terrain.fiel=x"], "fiel is not a known key.*file"),
        (["terrain.wall=rough"], "a rough wall needs ks"),
        (["terrain.wall=voellmy", "terrain.mu=0.2", "terrain.ks=0.1"], "ks goes with"),
        (["terrain.wall=voellmy"], "needs mu"),
        (["attraction=1"], "attraction"),
        (["periodic=['y']", "domain_min=[0,0,0]", "domain_max=[6,4,20]"], "not periodic"),
        (["dp=1e-6"], "columns|particles"),
        (["gravity=[0, -9.8, 0]"], r"90 degrees off the downward z .* gravity = \[0, 0, -9.8\]"),
        (["gravity=[0, 0, 9.8]"], "gravity = .* 180 degrees off the downward z"),
        (["gravity=[7, 0, -6.9]"], "45.4 degrees .* at most 45"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(path, settings, said):
    with pytest.raises(UserError, match=said) as caught:
        load_scenario(path, settings)
    assert str(caught.value).startswith("--set ")


@pytest.mark.parametrize(
    ("gravity", "said"),
    [
        ("[0, 0, -1e-6]", []),
        ("[0.1, 0, -9.8]", []),
        ("[0, 6.9, -7]", ["terrain: gravity is 44.6 degrees off the downward z"]),
        ("[0, 0, 0]", ["gravity is zero: nothing flows down the terrain"]),
    ],
)
def test_gravity_that_tilts_a_terrain_is_told(path, gravity, said):
    found = terrain_findings(load_scenario(path, [f"gravity={gravity}"]), {})
    told = [str(each) for each in found if isinstance(each, TiltedGravity | Weightless)]
    assert len(told) == len(said)
    assert all(text.startswith(start) for text, start in zip(told, said, strict=True))


def test_a_body_may_not_have_the_name_of_the_bed(path):
    path.write_text(path.read_text().replace("[body.slide]", "[body.terrain]"))
    with pytest.raises(UserError, match='the bed has the name "terrain"'):
        load_scenario(path)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("x,z\n0,0\n", "two rows or more"),
        ("x,z\n0,0\n1,1\n0.5,2\n", "x must go up"),
        ("x,y\n0,0\n1,1\n", "z"),
        ("x,z\n0,zero\n1,1\n", "zero|number"),
        ("x,z\n0,nan\n1,1\n", "finite|number"),
        ("", "CSV|column|x"),
    ],
)
def test_what_is_no_profile_is_refused(tmp_path, content, said):
    (tmp_path / "terrain.csv").write_text(content)
    path = tmp_path / "case.toml"
    path.write_text(text(2, more=BLOCK.format(place=PLACE[2])))
    with pytest.raises(UserError, match=said):
        load_scenario(path)


def test_a_profile_may_have_units_and_uneven_steps(tmp_path):
    (tmp_path / "terrain.csv").write_text("x [cm],z [mm]\n0,1000\n150,400\n400,400\n")
    path = tmp_path / "case.toml"
    path.write_text(text(2, more=BLOCK.format(place=PLACE[2])))
    bed = load_scenario(path).bed
    assert bed.origin == pytest.approx([0.0])
    assert bed.heights[:3] == pytest.approx([1.0, 0.96, 0.92])
    assert bed.heights[-1] == pytest.approx(0.4)


def test_a_section_cuts_a_map_along_a_line(tmp_path):
    grid(tmp_path / "map.asc", lambda x, y: 10 - 0.5 * x + 0.1 * y, shift=(1000.0, 2000.0, 0.0))
    path = tmp_path / "case.toml"
    lines = 'file = "map.asc"\nsection = [[1000.5, 2000.5], [1004.5, 2003.5]]'
    path.write_text(
        text(2, more=BLOCK.format(place=PLACE[2])).replace('file = "terrain.csv"', lines)
    )
    bed = load_scenario(path).bed
    x = bed.origin[0] + bed.cell * np.arange(len(bed.heights))
    assert x[-1] == pytest.approx(5.0)
    exact = 10 - 0.5 * (0.5 + 0.8 * x) + 0.1 * (0.5 + 0.6 * x)
    assert bed.heights == pytest.approx(exact, abs=1e-9)
    with pytest.raises(UserError, match="no data"):
        load_scenario(path, ["terrain.section=[[900, 2000], [1004, 2003]]"])
    kept = path.read_text()
    path.write_text(kept.replace(lines, 'file = "map.asc"'))
    with pytest.raises(UserError, match="section is missing"):
        load_scenario(path)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_run_keeps_its_ground_and_goes_on_without_the_file(tmp_path, dim):
    name = "terrain.csv" if dim == 2 else "terrain.asc"
    if dim == 2:
        profile(tmp_path / name, lambda x: 3 - 0.5 * x)
    else:
        grid(tmp_path / name, lambda x, y: 3 - 0.5 * x)
    path = tmp_path / "case.toml"
    path.write_text(text(dim, dp=0.1, time=0.02, more=BLOCK.format(place=PLACE[dim])))
    scenario = load_scenario(path)
    folder = tmp_path / "run"
    run_scenario(scenario, folder)
    (tmp_path / name).unlink()
    again = load_scenario(folder / "scenario.toml")
    assert np.array_equal(again.bed.heights, scenario.bed.heights)
    ground = read_ground(folder)
    heights = ground.z if dim == 2 else ground.values[::-1]
    assert np.array_equal(heights, scenario.bed.heights)
    assert load(folder).ground is not None


def test_a_run_that_goes_on_cannot_be_buried(tmp_path):
    """Another terrain may lie lower than that of the earlier run, but not above its flow."""
    profile(tmp_path / "terrain.csv", lambda x: 3 - 0.5 * x)
    path = tmp_path / "case.toml"
    words = text(2, dp=0.1, time=0.02, more=BLOCK.format(place=PLACE[2]))
    path.write_text(words)
    run_scenario(load_scenario(path), tmp_path / "run")
    path.write_text(words.replace("= 0.02", "= 0.04") + '[start]\nfrom = "run"\n')
    for rise, name in ((-0.05, "lower"), (0.3, "higher")):
        profile(tmp_path / "terrain.csv", lambda x, up=rise: 3 + up - 0.5 * x)
        if name == "lower":
            assert run_scenario(load_scenario(path), tmp_path / name)["status"] == "done"
        else:
            with pytest.raises(UserError, match=r"lie in the ground, up to 0\.2"):
                run_scenario(load_scenario(path), tmp_path / name)


def test_friction_of_the_bed_is_warned_about_as_that_of_a_body(path):
    """A liquid shears over the layer that Voellmy's bed holds; sand rougher than a flow is deep."""
    for settings, said in (
        (["terrain.wall=voellmy", "terrain.mu=0.3"], "terrain.mu = 0.3"),
        (["terrain.wall=rough", "terrain.ks=9"], "terrain.ks"),
    ):
        report = check_scenario(load_scenario(path, settings))
        assert f"warning: {said}" in report
        assert f"warning: {said}" not in check_scenario(load_scenario(path))
