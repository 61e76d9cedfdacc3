"""Two grains collide: doseki against an independent code and against energy balance."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from doseki.solver.build import load_core

from ..cases import Case

SPEED, DIAMETER = 6.0, 0.01  # what errors of velocity and position are measured against
TIMES = ("0.0025", "0.005")
MANY = "particles_per_grain=793"
ROWS = {
    "one": [],
    "one_noAV": ["alpha=0"],
    "one_noS": ["strength=false"],
    "one_noAV_noS": ["alpha=0", "strength=false"],
    "one_h": ["h_mode=eq10"],
    "one_xi1": ["xi=1"],
}


@dataclass
class Collision:
    """Position and velocity along x of both grains at TIMES, and what else is compared."""

    x: np.ndarray  # (times, grains)
    v: np.ndarray
    closest: float  # approach of the centres, m
    momentum_drift: float  # relative
    energy_drift: float  # relative, with what the artificial viscosity took

    @property
    def restitution(self) -> float:
        """Speed of separation over speed of approach."""
        return (self.v[-1, 1] - self.v[-1, 0]) / SPEED


def energy(case):
    """Kinetic, bulk, shear and dissipated energy."""
    kinds = ("kinetic_energy", "bulk_energy", "shear_energy", "av_dissipation")
    return sum(case.totals()[kind] for kind in kinds)


@functools.cache
def collide(*overrides, look_every=1):
    """The collision with these overrides; centres are looked at every `look_every` steps."""
    case = Case("collision", *overrides)
    momentum, total = np.array(case.totals()["momentum"]), energy(case)
    x, v, closest = [], [], np.inf
    for time in map(float, TIMES):
        while case.time < time:
            case.advance(time, look_every)
            x_now = [case.mean("position", grain)[0] for grain in ("left", "right")]
            closest = min(closest, x_now[1] - x_now[0])
        x.append(x_now)
        v.append([case.mean("velocity", grain)[0] for grain in ("left", "right")])
    drift = np.abs(np.array(case.totals()["momentum"]) - momentum).max() / np.abs(momentum).max()
    return Collision(np.array(x), np.array(v), closest, drift, energy(case) / total - 1)


def reference_row(row, key):
    """(times, grains) of x or vx."""
    return np.array([[row[time][f"{key}{grain}"] for grain in (0, 1)] for time in TIMES])


@pytest.mark.parametrize("name", ROWS)
def test_one_particle_grains(name, reference_data, report):
    """Within 1e-3 of the reference in every number."""
    row = reference_data("collision/reference_collision.json")[name]
    found = collide(*ROWS[name])
    error_x = np.abs(found.x - reference_row(row, "x")).max() / DIAMETER
    error_v = np.abs(found.v - reference_row(row, "vx")).max() / SPEED
    report("error of positions / diameter", error_x, "below 1e-3")
    report("error of velocities / 6 m/s", error_v, "below 1e-3")
    report("restitution", found.restitution, row["restitution"])
    report("closest approach", 1e3 * found.closest, row["min_centre_gap_mm"], "mm")
    assert error_x < 1e-3
    assert error_v < 1e-3
    assert found.restitution == pytest.approx(row["restitution"], rel=1e-3)
    assert 1e3 * found.closest == pytest.approx(row["min_centre_gap_mm"], rel=1e-3)


@pytest.mark.validate
@pytest.mark.parametrize(
    ("name", "overrides"),
    [("p793", []), ("p793_noS", ["strength=false"])],
    ids=["strength", "no-strength"],
)
def test_lattice_grains(name, overrides, reference_data, report):
    """793 particles a grain: within 1e-2 of 6 m/s in velocity; without strength they merge."""
    row = reference_data("collision/reference_collision.json")[name]
    found = collide(MANY, *overrides, look_every=20)
    error = np.abs(found.v - reference_row(row, "vx")).max() / SPEED
    report("error of velocities / 6 m/s", error, "below 1e-2")
    report("restitution", found.restitution, row["restitution"])
    report("closest approach", 1e3 * found.closest, row["min_centre_gap_mm"], "mm")
    report("energy drift", found.energy_drift, "below 2e-3")
    assert error < 1e-2
    assert found.momentum_drift < 1e-12
    assert abs(found.energy_drift) < 2e-3


@pytest.mark.validate
def test_lattice_grains_at_full_sound_speed(reference_data, report):
    """With xi = 1 contact lasts a tenth of a millisecond; before and after is free flight."""
    row = reference_data("collision/reference_collision.json")["p793_xi1"]["0.005"]
    near, end = 0.0108, 2.5e-4
    case = Case("collision", MANY, "xi=1", f"distance={near}", f"time_max={end}")
    case.advance(end)
    flight = (0.025 - near) / SPEED  # before this run starts
    for grain, name in enumerate(("left", "right")):
        v = case.mean("velocity", name)[0]
        x = case.mean("position", name)[0] - (0.025 - near) / 2 + (5e-3 - flight - end) * v
        report(f"velocity of the {name} grain", v, row[f"vx{grain}"], "m/s")
        assert v == pytest.approx(row[f"vx{grain}"], abs=1e-2 * SPEED)
        assert x == pytest.approx(row[f"x{grain}"], abs=1e-2 * DIAMETER)


@pytest.mark.parametrize("name", ROWS)
def test_momentum_is_conserved(name, report):
    drift = collide(*ROWS[name]).momentum_drift
    report("momentum drift", drift, "below 1e-12")
    assert drift < 1e-12


def test_closest_approach_follows_from_energy(report):
    """Without strength and viscosity rho = rho0 + m W(r) exactly, so the speed of approach is
    spent when 2 m u(rho(r)) = m v^2/4; u is the bulk energy of Eq. (8).
    """
    physics = load_core().physics
    case = Case("collision", "alpha=0", "strength=false")
    state = case.simulation.state()
    m, h, rho0 = state["mass"][0], state["smoothing_length"][0], state["density"][0]
    c0 = state["sound_speed"][0]
    near, far = 0.005, 0.02
    for _ in range(60):
        r = 0.5 * (near + far)
        rho = rho0 + m * physics.two.kernel([[r], [1 / (2.5 * h)]])[0][0]
        u = physics.birch_murnaghan([[rho], [rho0], [c0]])[2][0]
        near, far = (near, r) if 2 * u < 0.25 * SPEED**2 else (r, far)
    found = collide("alpha=0", "strength=false").closest
    report("closest approach", 1e3 * found, 1e3 * r, "mm")
    assert 1e3 * r == pytest.approx(11.4615, abs=1e-4)
    assert found == pytest.approx(r, rel=1e-4)
