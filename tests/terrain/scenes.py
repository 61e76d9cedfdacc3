"""Slopes and lakes on terrains, as scenario files."""

from __future__ import annotations

import numpy as np

from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.solver.build import filled_simulation

HEAD = """
dim = {dim}
dp = {dp}
time_max = {time}
time_out = {time}
scheme = "resolved"
gravity = {gravity}
speed_max = {speed}
[terrain]
file = "{file}"
material = "basalt"
wall = "{wall}"
"""
STONE = """
[material.stone]
based_on = "basalt"
rho0 = 2000
friction = 0.8
"""
LAKE = """
[body.lake]
shape = "box"
material = "water"
min = [{west}, {floor}]
max = [{east}, {level}]
pressure = "= 9810*({level} - y)"
"""
# On a slope, held by its friction.
BLOCK_IN_LAKE = (
    LAKE
    + """
[body.block]
shape = "box"
material = "stone"
min = {corner}
max = {opposite}
rotate = {turn}
"""
)
GRAVITY = {2: [0, -9.81], 3: [0, 0, -9.81]}


def profile(path, height, low=0.0, high=6.0, cell=0.05, shift=(0.0, 0.0)):
    """A profile of a height (function of x) at x from `low` to `high`, moved by `shift`."""
    x = np.arange(low, high + cell / 2, cell)
    rows = zip((x + shift[0]).tolist(), (height(x) + shift[1]).tolist(), strict=True)
    path.write_text("x,z\n" + "".join(f"{a!r},{b!r}\n" for a, b in rows))


def grid(path, height, size=(6.0, 4.0), cell=0.1, shift=(0.0, 0.0, 0.0)):
    """An ESRI ASCII grid of a height (function of x, y)."""
    x, y = ((np.arange(round(length / cell)) + 0.5) * cell for length in size)
    z = height(*np.meshgrid(x, y)) + shift[2]
    write_raster(path, Raster(z[::-1], shift[0], shift[1], cell))


def text(dim, dp=0.1, time=1.0, speed=5.0, wall="free_slip", more=""):
    """A scenario on terrain.csv or terrain.asc beside it."""
    file = "terrain.csv" if dim == 2 else "terrain.asc"
    head = HEAD.format(
        dim=dim, dp=dp, time=time, speed=speed, wall=wall, file=file, gravity=GRAVITY[dim]
    )
    return head + more


def block_in_lake(folder, sign=1, shift=(0.0, 0.0), side=0.1, across=12):
    """A block of stone under water on a slope that falls with x, or against it."""
    slope = 15.0
    steep, turn = np.tan(np.radians(slope)), np.radians(slope)
    profile(
        folder / "terrain.csv",
        lambda x: np.maximum(-steep * sign * x, 4 * (sign * x - 0.45)),
        low=-0.8,
        high=0.8,
        cell=0.01,
        shift=shift,
    )
    left = 0.0 if sign > 0 else -side * np.cos(turn)
    corner = np.array([left, -steep * sign * left]) + shift
    words = BLOCK_IN_LAKE.format(
        west=shift[0] - 0.8,
        east=shift[0] + 0.8,
        floor=shift[1] - 0.3,
        level=shift[1] + 0.16,
        corner=corner.tolist(),
        opposite=(corner + side).tolist(),
        turn=-sign * slope,
    )
    path = folder / "case.toml"
    path.write_text(text(2, dp=side / across, time=0.6, speed=2.0, more=STONE + words))
    return path


def simulation_of(path, settings=()):
    """A started simulation of a scenario file, and its names of bodies."""
    simulation, names, _ = filled_simulation(load_scenario(path, settings))
    simulation.start()
    return simulation, names


def step(simulation, steps):
    """So many steps."""
    simulation.advance(limit=1e9, pause=1e9, max_steps=steps)


def fluid(state):
    """Mask of the particles that are free."""
    return state["motion"] == 0
