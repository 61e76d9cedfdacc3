"""Particles from CSV and HDF5: what is right is read, what is wrong is named."""

import h5py
import numpy as np
import pytest

from doseki.errors import UserError
from doseki.record.particles import FIXED, FREE
from doseki.scenario.load import load_scenario
from doseki.scenario.particle_files.reader import read_particles
from doseki.scene.build import build_bodies
from doseki.scene.walls.normals import wall_geometry

HEADER = "x,y,vx,vy,mass,density,material"
ROW = "0,0,0,0,1,1000,water"
CLOUD = "[body.cloud]\nshape = 'file'\nfile = 'cloud.csv'\n"


def write_csv(folder, *lines):
    path = folder / "cloud.csv"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_hdf5(folder, group="", count=3, **columns):
    path = folder / "cloud.h5"
    defaults = {name: np.ones(count) for name in ("vx", "vy", "mass", "density")}
    defaults |= {"x": np.arange(count), "y": np.zeros(count), "material": [b"water"] * count}
    with h5py.File(path, "w") as file:
        for name, values in (defaults | columns).items():
            file[f"{group}/{name}"] = values
    return path


def test_csv_becomes_particles(write, tmp_path):
    write_csv(
        tmp_path,
        "x, y, vx, vy, mass, density, material, fixed, body",
        "# a comment, then a blank line",
        "",
        "0, 0, 1, 2, 3, 1000, water, 0, left",
        "5, 6, 0, 0, 4, 2750, basalt, true, right",
    )
    scenario = load_scenario(write(tables=CLOUD))
    particles, names = build_bodies(scenario)
    assert names == ["left", "right"]
    assert [scenario.material_names[m] for m in particles.material] == ["water", "basalt"]
    np.testing.assert_array_equal(particles.position, [[0, 0], [5, 6]])
    np.testing.assert_array_equal(particles.velocity, [[1, 2], [0, 0]])
    np.testing.assert_array_equal(particles.motion, [FREE, FIXED])
    np.testing.assert_allclose(
        particles.smoothing_length, 1.2 * np.sqrt(particles.mass / particles.density)
    )


@pytest.mark.parametrize("group", ["", "particles"])
def test_hdf5_becomes_particles(tmp_path, group):
    path = write_hdf5(tmp_path, group, body=[4, 4, 7], smoothing_length=[0.1, 0.2, 0.3])
    table = read_particles(path, 2, None)
    assert (table.body_names, table.material_names) == (["4", "7"], ["water"])
    np.testing.assert_array_equal(table.position[:, 0], [0, 1, 2])
    np.testing.assert_array_equal(table.smoothing_length, [0.1, 0.2, 0.3])


def test_effective_scenario_finds_the_file_from_elsewhere(write, tmp_path):
    write_csv(tmp_path, HEADER, ROW)
    effective = load_scenario(write(tables=CLOUD)).effective_toml()
    elsewhere = tmp_path / "run" / "scenario.toml"
    elsewhere.parent.mkdir()
    elsewhere.write_text(effective)
    assert len(build_bodies(load_scenario(str(elsewhere)))[0]) == 1


def test_material_of_the_body_stands_in_for_the_column(write, tmp_path):
    write_csv(tmp_path, HEADER.removesuffix(",material"), ROW.removesuffix(",water"))
    scenario = load_scenario(write(tables=CLOUD + "material = 'basalt'\nfixed = true"))
    particles, names = build_bodies(scenario)
    assert (scenario.material_names, names) == (["basalt"], ["cloud"])
    assert particles.motion[0] == FIXED


@pytest.mark.parametrize(
    ("lines", "part"),
    [
        ([""], "the file is empty"),
        ([HEADER], "holds no particle"),
        ([HEADER + ",colour", ROW + ",red"], 'unknown column "colour"'),
        (["x,y,z,vx,vy,mass,density,material"], 'unknown column "z"'),
        ([HEADER.replace("density", "densty"), ROW], "did you mean density?"),
        (["x,y,vx,mass,material", "0,0,0,1,water"], "missing columns vy, density"),
        ([HEADER + ",x", ROW + ",0"], 'the column "x" appears twice'),
        ([HEADER, ROW + ",7"], "line 2: 8 fields; the header has 7 columns"),
        ([HEADER, ROW, ROW.replace("1000", "-1")], "particle 2: column \"density\" has '-1'"),
        ([HEADER, ROW.replace(",1,", ",0,")], "column \"mass\" has '0', expected a number greater"),
        ([HEADER, ROW.replace("0,0,", "0,nan,", 1)], "expected a finite number"),
        ([HEADER, ROW.replace("0,0,", "0,1e999,", 1)], "expected a finite number"),
        ([HEADER, ROW.replace("0,0,", "0,,", 1)], "column \"y\" has '', expected a number"),
        ([HEADER, ROW.replace("water", "")], "expected a name"),
        ([HEADER, ROW.replace("water", "watr")], 'unknown material "watr"; did you mean water?'),
        ([HEADER + ",fixed", ROW + ",maybe"], "expected 0, 1, true or false"),
        ([HEADER, ROW.replace("1,1000", "1e-15,1e12")], "body.cloud: a mass of 1e-15 kg"),
        ([HEADER, ROW.replace("water", '"wa\nter"')], 'unknown material "wa ter"'),
        ([HEADER, "A" * 100_000], "line 2: "),
    ],
)
def test_csv_refusal(write, tmp_path, error_of, lines, part):
    write_csv(tmp_path, *lines)
    assert part in error_of(write(tables=CLOUD))


def test_files_that_are_neither(write, tmp_path, error_of):
    path = tmp_path / "cloud.csv"
    assert "no such file" in error_of(write(tables=CLOUD))
    path.write_bytes(bytes(range(256)))
    assert "not a text in UTF-8" in error_of(write(tables=CLOUD))
    path.unlink()
    path.mkdir()
    assert "a folder, not a file" in error_of(write(tables=CLOUD))


@pytest.mark.parametrize(
    ("columns", "part"),
    [
        ({"y": np.zeros(4)}, "the columns differ in length"),
        ({"y": np.zeros((3, 2))}, 'column "y" must have one dimension, not 2'),
        ({"y": np.zeros(3, complex)}, '"y" must hold numbers or strings'),
        ({"material": [1, 2, 3]}, 'column "material" must hold names, not numbers'),
        ({"body": [0.5, 1, 2]}, "expected a name or a whole number"),
        ({"fixed": [0, 1, 2]}, 'particle 3: column "fixed"'),
        ({"y": h5py.ExternalLink("other.h5", "/y")}, '"y" is a link'),
        ({"y/z": np.zeros(3)}, '"y" is not a dataset'),
    ],
)
def test_hdf5_refusal(tmp_path, columns, part):
    if "y/z" in columns:
        path = write_hdf5(tmp_path)
        with h5py.File(path, "a") as file:
            del file["y"]
            file["y/z"] = columns["y/z"]
    else:
        path = write_hdf5(tmp_path, **columns)
    with pytest.raises(UserError) as caught:
        read_particles(path, 2, None)
    assert part in str(caught.value)


def test_small_file_that_claims_to_be_huge(tmp_path):
    path = tmp_path / "bomb.h5"
    with h5py.File(path, "w") as file:
        for name in HEADER.removesuffix(",material").split(","):
            file.create_dataset(name, (10**12,), "f8", chunks=(10**6,), compression="gzip")
        file.create_dataset("material", (10**12,), "S8", chunks=(10**6,), compression="gzip")
    assert path.stat().st_size < 10**6
    with pytest.raises(UserError, match="more than this machine can hold"):
        read_particles(path, 2, None)


def test_truncated_hdf5(tmp_path):
    path = write_hdf5(tmp_path)
    path.write_bytes(path.read_bytes()[:700])
    with pytest.raises(UserError, match=r"as HDF5: it is cut short, damaged, or not HDF5$"):
        read_particles(path, 2, None)


def test_walls_of_a_file_with_body_names_need_a_shape_in_the_resolved_scheme(write, tmp_path):
    """The bodies are called otherwise than the table, which is still the one to name."""
    write_csv(tmp_path, HEADER + ",fixed,body", f"{ROW},0,left", "5,6,0,0,4,2750,basalt,1,right")
    scenario = load_scenario(write('scheme = "resolved"\nxi = 0.05', tables=CLOUD))
    particles, names = build_bodies(scenario)
    with pytest.raises(UserError, match=r"body\.cloud: a wall of points needs its normal"):
        wall_geometry(scenario, particles, names)
