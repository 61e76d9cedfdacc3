"""A small run through which water and rocks come and go, made and run from Python."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

import doseki

from ..run.channel import channel_text

GAUGES = {
    "rate": {"kind": "discharge", "position": [0.1, 0], "direction": [-1, 0], "interval": 0.01},
    "profile": {
        "kind": "velocity_profile",
        "position": [0.1, 0],
        "length": 0.04,
        "count": 4,
        "interval": 0.01,
    },
}


@pytest.fixture(scope="session")
def channel() -> doseki.Scenario:
    """The scenario."""
    return doseki.Scenario(tomllib.loads(channel_text()))


@pytest.fixture(scope="session")
def recorded(channel: doseki.Scenario, tmp_path_factory: pytest.TempPathFactory) -> doseki.Run:
    """A run of it to the end, with gauges."""
    folder = tmp_path_factory.mktemp("api") / "run"
    return doseki.run(channel.changed(gauge=GAUGES), folder, threads=1, progress=False)


@pytest.fixture(scope="session")
def plain(channel: doseki.Scenario, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run without anything that looks on."""
    folder = tmp_path_factory.mktemp("api") / "plain"
    return doseki.run(channel, folder, threads=1, progress=False).directory
