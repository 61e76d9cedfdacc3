"""Runs of the tank to start from."""

from __future__ import annotations

import pytest

from .tank import continued, run, tank_text

TANK = tank_text()


@pytest.fixture(scope="session")
def tank(tmp_path_factory):
    """A run of the tank, its folder beside its scenario."""
    return run(TANK, tmp_path_factory.mktemp("tank") / "tank.toml")


@pytest.fixture
def later(tank, tmp_path):
    """Writes a scenario that starts from the tank, and returns its file."""

    def write(*keys, text=TANK, folder=tank.directory):
        file = tmp_path / "later.toml"
        file.write_text(
            continued(text.replace("time_max = 0.03", "time_max = 0.05"), folder, *keys)
        )
        return file

    return write
