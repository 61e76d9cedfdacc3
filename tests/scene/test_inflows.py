"""Inflow sections: the rate comes out right, and up is up."""

import numpy as np
import pytest

from doseki.errors import ResourceError, UserError
from doseki.scenario.load import load_scenario
from doseki.scenario.values.directions import section_axes
from doseki.scene.build import build_bodies
from doseki.scene.inflow_sections import build_inflows


def sections(*overrides):
    scenario = load_scenario("flume", overrides)
    _, names = build_bodies(scenario)
    return scenario, names, build_inflows(scenario, names)


@pytest.mark.parametrize("dim", [2, 3])
def test_flux_through_the_section_is_the_rate(dim):
    scenario, names, (section,) = sections(f"dim={dim}")
    flux = section.density * section.speed * len(section.rows) * section.spacing ** (dim - 1)
    assert flux == pytest.approx(section.rate_mass)
    assert section.rate_mass == pytest.approx(30 if dim == 2 else 3)
    assert names[section.body] == "water"
    assert scenario.material_names[section.material] == "water"
    assert (section.start, section.stop, section.buffer_layers) == (0, 7, 8)


def test_rows_continue_the_lattice_of_the_bed():
    scenario, _, (section,) = sections()
    np.testing.assert_allclose(section.rows[:, 1], (np.arange(4) + 0.5) * scenario.dp)
    np.testing.assert_allclose(section.direction, [-1, 0])
    assert section.mass == pytest.approx(1000 * scenario.dp**2)


@pytest.mark.parametrize(
    ("direction", "gravity", "up", "across"),
    [
        ([-1.0, 0], [-3, -9], [0, 1], None),
        ([0, -1.0], [0, -9.8], [1, 0], None),
        ([0, 1.0], [0, 0], [1, 0], None),
        ([-1.0, 0, 0], [-3, 0, -9], [0, 0, 1], [0, 1, 0]),
        ([0, 1.0, 0], [0, 0, 0], [0, 0, 1], [1, 0, 0]),
        ([0, 0, -1.0], [0, 0, -9.8], [1, 0, 0], [0, 1, 0]),
    ],
)
def test_section_axes(direction, gravity, up, across):
    found_up, found_across = section_axes(np.array(direction), np.array(gravity, dtype=float))
    np.testing.assert_allclose(found_up, up, atol=1e-15)
    if across is None:
        assert found_across is None
    else:
        np.testing.assert_allclose(found_across, across, atol=1e-15)


def test_discharge_is_a_parameter_with_its_unit():
    _, _, (half,) = sections("discharge=1.5 L/s")
    _, _, (plain,) = sections("discharge=0.0015")
    assert half.rate_mass == plain.rate_mass == pytest.approx(15)


def test_what_cannot_be_held_is_refused_before_it_is_made():
    with pytest.raises(ResourceError, match=r"of them in inflow\.\w+\).*increase dp"):
        sections("inflow.water.depth=1e9")


def test_what_enters_faster_than_sound_is_refused():
    scenario, _, (section,) = sections()
    sound = scenario.xi * scenario.min_sound_speed
    most = 0.003 * sound / section.speed
    sections(f"discharge={0.99 * most:g}")
    with pytest.raises(UserError, match=r"inflow\.\w+: enters at up to .* raise xi"):
        sections(f"discharge={1.01 * most:g}")
