"""Whatever a scenario file holds: it is read, or refused in one sentence."""

from __future__ import annotations

import pytest
from hypothesis import given

from doseki.errors import DosekiError, ResourceError, UserError
from doseki.record import particles as sets
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.scene.inflow_sections import build_inflows

from .examples import examples
from .generators import scenario_texts, tables


def read(path, overrides=()):
    """Read as `run` does, up to the particles; DosekiError is the only error there may be."""
    try:
        scenario = load_scenario(path, overrides)
        particles, names = build_bodies(scenario)
        build_inflows(scenario, names, particles)
    except (UserError, ResourceError) as error:
        assert_one_sentence(error)
        return None
    return scenario, particles


def assert_one_sentence(error: DosekiError) -> None:
    message = str(error)
    assert message.strip()
    assert "\n" not in message
    assert len(message) < 3000
    message.encode()  # it can be printed


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("fuzz")


@pytest.fixture(autouse=True)
def few_particles(monkeypatch):
    """What is refused for its size, not built: thousands of large scenarios would take hours."""
    monkeypatch.setattr(sets, "MAX_PARTICLES", 20_000)


@examples(80, 6000)
@given(text=scenario_texts())
def test_any_text(folder, text):
    (folder / "scenario.toml").write_bytes(text)
    read(folder / "scenario.toml")
    assert [file.name for file in folder.iterdir()] == ["scenario.toml"]


@examples(20, 500)
@given(table=tables())
def test_what_is_read_has_particles_in_order(folder, table):
    """And its effective form reads back to the same particles."""
    from doseki.util.toml_writer import to_toml

    try:
        text = to_toml(table).encode()
    except (TypeError, ValueError):
        return
    (folder / "scenario.toml").write_bytes(text)
    found = read(folder / "scenario.toml")
    if found is None:
        return
    scenario, particles = found
    (folder / "effective.toml").write_text(scenario.effective_toml())
    again = read(folder / "effective.toml")
    (folder / "effective.toml").unlink()
    assert again is not None
    assert again[1].position.tobytes() == particles.position.tobytes()
    assert again[1].mass.tobytes() == particles.mass.tobytes()
