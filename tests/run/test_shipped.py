"""Every shipped scenario runs a few coarse steps and leaves a record that can be read."""

from __future__ import annotations

import numpy as np
import pytest
from tests.shipped import CASES, FIRST, NAMES, PARTS

import doseki
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.scene.build import build_bodies
from doseki.solver.build import build_simulation

STEPS = 12
MOST_PARTICLES = 20_000

# Scenarios that are of the resolved scheme, which runs in double precision.
RESOLVED = {
    "brazil-test", "breaking-flume", "channel", "dam-step", "drip", "drop-weight", "drum",
    "elastic-gate", "flood-log", "flume-3d",
    "flume-strip", "gate-release", "gate-release-3d", "mud-slump", "saturated-slide", "segregation",
    "slide-wave", "slit-dam", "valley", "voellmy-chute",
}  # fmt: skip
# Coarser than shipped, where a 3-D run would have too many particles for a quick test.
COARSE = {
    ("flume", 3): 0.025,
    ("flume-strength", 3): 0.025,
    ("dambreak", 3): 0.03,
    ("channel", 3): 0.0075,
    ("flume-strip", 3): 0.005,
}


def coarse_scenario(name, dim, *more):
    """The scenario in `dim` dimensions, short enough for a few steps."""
    overrides = [f"dim={dim}", *PARTS.get(name, []), *more]
    if (name, dim) in COARSE:
        overrides.append(f"dp={COARSE[name, dim]}")
    simulation, _ = build_simulation(load_scenario(name, overrides))
    time = (STEPS - 0.5) * simulation.rates()["timestep"]  # no step ends a rounding before it
    return load_scenario(name, [*overrides, f"time_max={time}", f"time_out={time / 2}"])


def run(scenario, folder):
    """The record of a run on one thread."""
    run_scenario(scenario, folder, RunOptions(threads=1))
    return doseki.load(folder)


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_runs_and_leaves_a_record(name, dim, tmp_path):
    scenario = coarse_scenario(name, dim)
    record = run(scenario, tmp_path / "run")
    np.testing.assert_allclose(record.times, scenario.time_max * np.array([0, 0.5, 1]), rtol=1e-12)
    assert record.summary["status"] == "done"
    assert record.summary["step"] >= STEPS // 2
    rounding = 1e-9 + 1e-14 * record.summary["mass_initial"]
    assert record.summary["ledger_residual"] == pytest.approx(0, abs=rounding)
    assert record[0]["mass"].size <= MOST_PARTICLES
    for snapshot in record:
        check_snapshot(snapshot, scenario)
    for column in record.history.columns:
        assert np.isfinite(record.history[column]).all(), column
    assert (np.diff(record.history["time"]) > 0).all()


def check_snapshot(snapshot, scenario):
    """Fields are finite, of the right shape, and name materials and bodies of the scenario."""
    n = len(snapshot["id"])
    shapes = {"position": (n, scenario.dim), "velocity": (n, scenario.dim), "stress": (n, 3, 3)}
    for field in snapshot:
        values = snapshot[field]
        assert values.shape == shapes.get(field, values.shape)
        assert len(values) == n
        assert values.dtype.kind in "Ub" or np.isfinite(values).all(), field
    assert set(snapshot["material"]) <= set(scenario.material_names)
    assert set(snapshot["body"]) <= {*scenario.body, "terrain", *scenario.inflow}
    np.testing.assert_array_equal(snapshot["id"], np.unique(snapshot["id"]))


@pytest.mark.parametrize(("name", "dim"), FIRST)
def test_effective_scenario_repeats_the_run(name, dim, tmp_path):
    """What the record keeps as its scenario gives the same particles at the end, bit for bit."""
    first = run(coarse_scenario(name, dim), tmp_path / "first")
    again = run(load_scenario(tmp_path / "first" / "scenario.toml"), tmp_path / "again")
    for field in ("position", "velocity", "density", "material", "motion"):
        np.testing.assert_array_equal(again[-1][field], first[-1][field])


@pytest.mark.parametrize("name", [name for name in NAMES if name not in RESOLVED])
def test_runs_in_single_precision(name, tmp_path):
    double = run(coarse_scenario(name, 2), tmp_path / "double")
    single = run(coarse_scenario(name, 2, "precision=float"), tmp_path / "single")
    scale = np.abs(double[-1]["velocity"]).max()
    np.testing.assert_allclose(
        single[-1]["velocity"], double[-1]["velocity"], atol=1e-3 * scale, rtol=0
    )


def moves_at_once(scenario, name):
    """Whether a fixed body has a motion that begins with the run."""
    motion = getattr(scenario.body.get(name), "motion", None)
    return motion is not None and motion.start < scenario.time_max


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_fixed_bodies_stay(name, dim, tmp_path):
    scenario = coarse_scenario(name, dim)
    particles, names = build_bodies(scenario)
    moves = [k for k, name in enumerate(names) if moves_at_once(scenario, name)]
    fixed = particles.id[(particles.motion == 1) & ~np.isin(particles.body, moves)]
    snapshot = run(scenario, tmp_path / "run")[-1]
    kept = np.isin(snapshot["id"], fixed)
    assert kept.sum() == len(fixed)
    np.testing.assert_array_equal(snapshot["position"][kept], particles.position[fixed])
    assert snapshot["fixed"][kept].all()
