"""A wetted bed starts at the density from which its cover brings it to rest."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.scene.wetting import covered_share
from doseki.solver.build import load_core


def lattice_sum(rows: np.ndarray, dim: int) -> float:
    """Sum of W dp^dim over whole rows at the given heights, spacing 1, support 3."""
    lateral = np.arange(-3.0, 4.0)
    r = np.sqrt(sum(a**2 for a in np.meshgrid(*[lateral] * (dim - 1), rows))).ravel()
    physics = getattr(load_core().physics, {2: "two", 3: "three"}[dim])
    return float(np.sum(physics.kernel([list(r), [1 / 3] * len(r)])[0]))


@pytest.mark.parametrize("dim", [2, 3])
def test_above_level_and_below_make_a_full_lattice(dim: int):
    above = covered_share(np.array([0.5]), 1.0, 3.0, dim)[0]
    full = lattice_sum(np.arange(-3.0, 4.0), dim)
    assert 2 * above + lattice_sum(np.zeros(1), dim) == pytest.approx(full, rel=1e-12)
    assert full == pytest.approx({2: 1.0032, 3: 1.0035}[dim], abs=1e-4)


def test_deep_rows_see_nothing_of_the_cover():
    share = covered_share(np.array([0.5, 1.5, 2.5, 3.5]), 1.0, 3.0, 2)
    assert share[0] > share[1] > 0.0
    assert np.all(share[2:] == 0.0)


def test_the_cover_brings_the_bed_to_rest(tmp_path):
    """The deficit is the cover's mass times its kernel sum, so that rho0 is what comes of it."""
    text = """
dim = 2
dp = 0.01
time_max = 1
time_out = 1
[body.bed]
shape = "box"
material = "aluminium"
fixed = true
min = [0, -0.03]
max = [1, 0]
WETTED
[body.cover]
shape = "box"
material = "water"
min = [0, 0]
max = [1, 0.03]
"""
    path = tmp_path / "bed.toml"

    def top_row(wetted: str) -> tuple[float, float]:
        path.write_text(text.replace("WETTED", wetted))
        particles, _ = build_bodies(load_scenario(str(path)))
        bed, cover = particles.motion == 1, particles.motion == 0
        top = np.argmin(np.linalg.norm(particles.position - [0.505, -0.005], axis=1))
        r = np.linalg.norm(particles.position[cover] - particles.position[top], axis=1)
        weight, _ = load_core().physics.two.kernel([list(r), [1 / 0.03] * len(r)])
        assert bed[top]
        return particles.density[top], float(np.sum(particles.mass[cover] * weight))

    dry, arriving = top_row("")
    wet, _ = top_row('wetted_by = "water"')
    assert dry == 2700.0
    assert arriving == pytest.approx(185.606, abs=1e-3)
    assert wet + arriving == pytest.approx(2700.0, rel=1e-12)
