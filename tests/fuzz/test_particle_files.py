"""Whatever a particle file holds: it is read, or refused in one sentence."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.hostile_hdf5 import HARMS, spoil

import doseki
from doseki.errors import UserError
from doseki.scenario.particle_files.reader import read_particles

from .examples import FREE, examples
from .generators import csv_files, hdf5_file


def read(path):
    """True if the file is read; UserError is the only error there may be."""
    try:
        table = read_particles(path, 2, None)
    except UserError as error:
        message = str(error)
        assert message.strip()
        assert "\n" not in message
        message.encode()
        return False
    assert len(table) > 0
    for values in (table.position, table.velocity, table.mass, table.density):
        assert np.isfinite(values).all()
    assert (table.mass > 0).all()
    return True


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("particles")


@examples(100, 4000)
@given(data=csv_files())
def test_any_csv(folder, data):
    (folder / "p.csv").write_bytes(data)
    read(folder / "p.csv")


# In a process of its own: damage that got past the checks could crash the HDF5 library.
DAMAGE_HDF5 = """
import random, sys
from pathlib import Path
from doseki.errors import UserError
from doseki.scenario.particle_files.reader import read_particles

whole, path = Path(sys.argv[1]).read_bytes(), Path(sys.argv[2])
generator = random.Random(1)
counts = {True: 0, False: 0}
for number in range(int(sys.argv[3])):
    data = bytearray(whole)
    for _ in range(generator.choice([1, 1, 2, 20])):
        data[generator.randrange(len(data))] = generator.choice([0, 255, generator.randrange(256)])
    if generator.random() < 0.2:
        del data[generator.randrange(len(data)):]
    path.write_bytes(data)
    try:
        read_particles(path, 2, None)
        counts[True] += 1
    except UserError as error:
        assert str(error).strip() and "\\n" not in str(error)
        counts[False] += 1
print(counts[True], counts[False])
"""


def damage_many(folder: Path, compressed: bool, count: int) -> list[int]:
    """How many damaged HDF5 files were read all the same, and refused."""
    (folder / "whole.h5").write_bytes(hdf5_file(compressed))
    paths = os.pathsep.join(
        [str(Path(doseki.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    )
    done = subprocess.run(
        [sys.executable, "-c", DAMAGE_HDF5, folder / "whole.h5", folder / "p.h5", str(count)],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": paths},
    )
    assert done.returncode == 0, done.stderr
    return [int(word) for word in done.stdout.split()]


@pytest.mark.parametrize("compressed", [False, True])
def test_damaged_hdf5(tmp_path, compressed):
    count = 1000 if FREE else 50
    assert sum(damage_many(tmp_path, compressed, count)) == count


@examples(30, 1500)
@given(
    name=st.sampled_from(["x", "mass", "density", "material"]),
    harm=st.sampled_from(sorted(HARMS)),
    data=st.data(),
)
def test_any_hdf5(folder, name, harm, data):
    """A file in which a column does harm, whole or damaged."""
    path = folder / "harm.h5"
    path.write_bytes(hdf5_file(data.draw(st.booleans())))
    spoil(path, name, harm)
    assert not read(path)


def test_a_decompression_bomb_is_refused_by_its_claim(tmp_path):
    """A few kilobytes that claim, and would unpack to, more than the machine holds."""
    with h5py.File(tmp_path / "bomb.h5", "w") as file:
        for name in ("x", "y", "vx", "vy", "mass", "density"):
            file.create_dataset(name, (10**12,), "f8", compression="gzip", chunks=(10**6,))
        file.create_dataset("material", (10**12,), "S6", compression="gzip", chunks=(10**6,))
    assert (tmp_path / "bomb.h5").stat().st_size < 100_000
    with pytest.raises(UserError, match="more than this machine can hold"):
        read_particles(tmp_path / "bomb.h5", 2, None)
