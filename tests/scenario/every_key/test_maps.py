"""Every key of [maps] changes what is mapped, or when: see walk.py."""

from __future__ import annotations

import hashlib

import numpy as np

from doseki.driver.maps import RunningMaps
from doseki.driver.ranks import OneRank
from doseki.errors import UserError
from doseki.record.folder import RunFolder
from doseki.scenario.load import load_scenario
from doseki.scenario.tables.terrain.maps import Maps
from doseki.solver.build import filled_simulation

from .walk import BLOCK, NONE, REFUSED, ignored, text_of

TABLE = """
[maps]
cell = 0.2
extent = [-0.4, -0.4, 1.6, 0.8]
"""
VALUES = {
    "interval": ["0.05"],
    "cell": ["0.25"],
    "extent": ["[-0.4, -0.4, 1.2, 0.8]"],
    "min_depth": ["0.35"],
    "speed_deposit": ["1.3"],
}


def test_the_table_of_maps(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(text_of("resolved", 3, BLOCK + TABLE))

    def outcome(file, settings):
        try:
            scenario = load_scenario(file, settings)
            simulation, _, _ = filled_simulation(scenario)
            simulation.start()
            maps = RunningMaps(scenario, list(scenario.body), RunFolder(tmp_path), OneRank())
            maps.look(simulation)
            maps.write(simulation)
        except UserError:
            return REFUSED
        files = sorted((tmp_path / "maps").glob("*.asc"))
        digest = hashlib.sha256(b"".join(file.read_bytes() for file in files))
        digest.update(np.array([maps.times.after(0.0)]).tobytes())
        return digest.hexdigest()

    assert outcome(str(path), ()) != REFUSED
    keys = sorted(Maps.model_fields)
    assert ignored(str(path), "maps.", keys, VALUES, outcome) == NONE
