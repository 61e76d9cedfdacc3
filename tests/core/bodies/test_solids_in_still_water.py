"""Stiff solids in still water: pressed from all sides, nowhere pulled, and at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from doseki.assess.trust.ledger import GIVEN, HELD, TAKEN
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation

DEPTH, LOW, HIGH = 0.4, 0.1, 0.22  # m, of the water, and of the block in it
TIME = 0.05  # s, in which sound crosses the tank some ten times
TURNS = (0, 1)  # of the whole scene, by 90 degrees
# Tensions of up to six times the pressure, which is 1.8 to 2.9 kPa, broke it.
BREAKS = {"fracture": "cohesive", "tensile_strength": 8e3, "fracture_energy": 0.05}
TABLES = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 1
time_out = 1
gravity = {gravity}

[material.rock]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0
{fracture}

[body.block]
shape = "box"
material = "rock"
kinematics = "elastic"
{block}
clamped = "= 0.02 - abs({across}) - abs({up} - 0.16)"

[body.water]
shape = "box"
material = "water"
{water}
pressure = "= 9810*({depth} - ({up}))"
{walls}"""
WALL = """
[body.{name}]
shape = "box"
material = "aluminium"
fixed = true
{box}
"""


def box(low: tuple[float, float], high: tuple[float, float], turn: int) -> str:
    """The extent of a box, turned with the scene."""
    corners = np.array([low, high]) @ np.linalg.matrix_power([[0, 1], [-1, 0]], turn)
    first, last = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    return f"min = {first}\nmax = {last}"


def still(turn: int, fracture: dict[str, Any]) -> str:
    """A block that is held in its middle under still water."""
    walls = {
        "floor": box((-0.24, -0.04), (0.24, 0), turn),
        "left": box((-0.24, 0), (-0.2, 0.5), turn),
        "right": box((0.2, 0), (0.24, 0.5), turn),
    }
    lines = [f'{key} = "{value}"' if key == "fracture" else f"{key} = {value}"
             for key, value in fracture.items()]  # fmt: skip
    return TABLES.format(
        gravity=[9.81, 0] if turn else [0, -9.81],
        fracture="\n".join(lines),
        block=box((-0.06, LOW), (0.06, HIGH), turn),
        water=box((-0.2, 0), (0.2, DEPTH), turn),
        depth=DEPTH,
        across="y" if turn else "x",
        up="-x" if turn else "y",
        walls="".join(WALL.format(name=name, box=extent) for name, extent in walls.items()),
    )


def residual(before: Any, after: Any) -> float:
    """Energy that nobody gave, J/m."""

    def kept(totals: Any) -> float:
        return sum(totals[key] for key in (*HELD, *TAKEN)) - sum(totals[key] for key in GIVEN)

    return kept(after) - kept(before)


@pytest.mark.parametrize("fracture", [{}, BREAKS], ids=["whole", "breakable"])
@pytest.mark.parametrize("turn", TURNS)
def test_still_water_presses_a_stiff_solid_and_does_not_pull_it(core, tmp_path, turn, fracture):
    path = tmp_path / "still.toml"
    path.write_text(still(turn, fracture), encoding="utf-8")
    simulation, names = build_simulation(load_scenario(str(path)))
    before = simulation.totals()
    simulation.advance(limit=TIME, pause=TIME, max_steps=10**9)
    state, after = simulation.state(), simulation.totals()
    solid = state["body"] == names.index("block")
    up = state["position"][solid] @ ([-1, 0] if turn else [0, 1])
    stress = state["stress"][solid][:, :2, :2]
    pull = np.linalg.eigvalsh(stress).max(axis=1) / (9810 * (DEPTH - up))
    assert pull.max() < 0.1
    assert after["elastic_energy"] + after["damping_work"] < 5e-3
    assert after["fracture_work"] == 0
    assert after["broken_bonds"] == 0
    assert abs(residual(before, after)) < 1e-3


def test_a_restored_run_goes_on_with_the_same_bits(core, tmp_path):
    path = tmp_path / "still.toml"
    path.write_text(still(0, BREAKS), encoding="utf-8")
    scenario = load_scenario(str(path))
    simulation, names = build_simulation(scenario)
    simulation.advance(limit=0.003, pause=0.003, max_steps=10**9)
    other = empty_simulation(scenario, names)
    assert other.restore(simulation.checkpoint())
    for run in (simulation, other):
        run.advance(limit=0.006, pause=0.006, max_steps=10**9)
    after = other.state()
    for key, values in simulation.state().items():
        assert np.array_equal(values, after[key]), key
