"""Small runs of the resolved scheme, from the texts of scenarios."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from doseki.scenario.load import load_scenario
from doseki.scenario.model import Scenario
from doseki.solver.build import build_simulation, empty_simulation

# A film on a slope, periodic along it (and across): 4 rows, so that all of it feels the bed.
FILM = """\
dim = {dim}
scheme = "resolved"
speed_max = 2
dp = 0.01
time_max = 1
time_out = 1
slope = 20
viscosity = "monaghan_cleary"
periodic = {{ d2 = ["x"], d3 = ["x", "y"] }}
domain_min = {{ d2 = [0, -0.03], d3 = [0, 0, -0.03] }}
domain_max = {{ d2 = [0.2, 0.2], d3 = [0.12, 0.12, 0.2] }}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "no_slip"
normal = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
min = {{ d2 = [0, -0.03], d3 = [0, 0, -0.03] }}
max = {{ d2 = [0.2, 0], d3 = [0.12, 0.12, 0] }}

[body.film]
shape = "box"
material = "water"
jitter = 0.2
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.2, 0.04], d3 = [0.12, 0.12, 0.04] }}

[body.film.velocity]
d2 = ["= 0.5*sin(60*x) - 1", "= 0.3*cos(90*x)"]
d3 = ["= 0.5*sin(60*x) - 1", 0.2, "= 0.3*cos(90*y)"]
"""

# Water that enters over a rough bed, meets water at rest before a block, and leaves.
CHANNEL = """\
dim = 2
scheme = "resolved"
speed_max = 3
dp = 0.01
time_max = 1
time_out = 1
slope = 10
turbulence = "mixing_length"

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.01
normal = [0, 1]
min = [-0.2, -0.03]
max = [0.6, 0]

[body.block]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.1, 0]
max = [0, 0.1]

[body.pool]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.08]
jitter = 0.1

[inflow.water]
material = "water"
rate = 0.006
width = 0.1
position = [0.5, 0]
direction = [-1, 0]
depth = 0.05
duration = 5

[outflow.end]
min = ["-inf", "-inf"]
max = [-0.12, "inf"]
"""

# A drop without anything around it.
DROP = """\
dim = {dim}
scheme = "resolved"
speed_max = 2
dp = 0.01
time_max = 1
time_out = 1

[body.drop]
shape = "disc"
material = "water"
centre = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
radius = {{ d2 = 0.105, d3 = 0.055 }}
"""

# A layer of four rows on a slope, periodic all around: `wall` says what the bed is, `rheology` how
# the layer flows.
LAYER = """\
dim = {dim}
scheme = "resolved"
speed_max = 2
dp = 0.05
time_max = 10
time_out = 1
gravity = {{ d2 = ["= -s", "= -n"], d3 = ["= -s*cos(b)", "= -s*sin(b)", "= -n"] }}
periodic = {{ d2 = ["x"], d3 = ["x", "y"] }}
domain_min = {{ d2 = [0, -0.15], d3 = [0, 0, -0.15] }}
domain_max = {{ d2 = [0.6, 1], d3 = [0.4, 0.4, 1] }}

[parameters]
angle = {angle}
a = "= radians(angle)"
b = {{ value = "= radians(40)", help = "3-D: which way is up the slope, in plan" }}
s = "= 9.81*sin(a)"
n = "= 9.81*cos(a)"
rho = {rho}

[material.fluid]
based_on = "water"
rho0 = "= rho"
{rheology}
[body.bed]
shape = "box"
material = "aluminium"
fixed = true
{wall}
normal = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
min = {{ d2 = [0, -0.15], d3 = [0, 0, -0.15] }}
max = {{ d2 = [0.6, 0], d3 = [0.4, 0.4, 0] }}

[body.layer]
shape = "box"
material = "fluid"
min = {{ d2 = [0, 0], d3 = [0, 0, 0] }}
max = {{ d2 = [0.6, 0.2], d3 = [0.4, 0.4, 0.2] }}
pressure = {{ d2 = "= rho*n*(0.2 - y)", d3 = "= rho*n*(0.2 - z)" }}
"""


def down_layer(dim: int) -> np.ndarray[Any, Any]:
    """Unit vector down the slope of LAYER."""
    b = math.radians(40)
    return -np.array([1, 0] if dim == 2 else [math.cos(b), math.sin(b), 0])


class Flows:
    """Makes simulations of scenario texts, written to a folder."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "flow.toml"

    def scenario(self, text: str, *settings: str) -> Scenario:
        """The scenario of a text with some keys set."""
        self.file.write_text(text)
        return load_scenario(str(self.file), settings)

    def __call__(self, text: str, *settings: str, isa: str | None = None) -> Any:
        """A started simulation."""
        return build_simulation(self.scenario(text, *settings), isa)[0]

    def empty(self, text: str, *settings: str) -> Any:
        """One without particles, to be restored."""
        scenario = self.scenario(text, *settings)
        return empty_simulation(scenario, [*scenario.body, *scenario.inflow])


def advance(simulation: Any, steps: int) -> Any:
    """The same simulation, some steps later."""
    simulation.advance(limit=1e9, pause=1e9, max_steps=steps)
    return simulation


def assert_same_bits(one: dict[str, Any], other: dict[str, Any]) -> None:
    """Equal values under equal names."""
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(other[name], values, err_msg=name)
