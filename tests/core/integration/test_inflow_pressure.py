"""What enters has the pressure of the flow in front of it."""

from __future__ import annotations

import numpy as np
import pytest

from .test_sources import DRIVEN

# A layer of ten rows on a bed that nothing rubs on, with more of the same coming in at one end and
# falling over an edge at the other.  It is faster than its waves, 1 m/s.
PLUG = """\
dim = {dim}
scheme = "resolved"
speed_max = 2.5
dp = 0.01
time_max = 10
time_out = 1
gravity = {{ d2 = [0, -9.81], d3 = [0, 0, -9.81] }}
periodic = {{ d2 = [], d3 = ["y"] }}
domain_min = {{ d2 = [-1, -1], d3 = [-1, 0, -1] }}
domain_max = {{ d2 = [1, 1], d3 = [1, 0.07, 1] }}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = {{ d2 = [0, 1], d3 = [0, 0, 1] }}
min = {{ d2 = [-0.44, -0.04], d3 = [-0.44, 0, -0.04] }}
max = {{ d2 = [0.44, 0], d3 = [0.44, 0.07, 0] }}

[body.water]
shape = "box"
material = "water"
min = {{ d2 = [-0.4, 0], d3 = [-0.4, 0, 0] }}
max = {{ d2 = [0.4, 0.1], d3 = [0.4, 0.07, 0.1] }}
velocity = {{ d2 = [{speed}, 0], d3 = [{speed}, 0, 0] }}
pressure = {{ d2 = "= 9810*(0.1 - y)", d3 = "= 9810*(0.1 - z)" }}

[inflow.water]
material = "water"
rate = {{ d2 = 0.16, d3 = 0.0112 }}
width = {{ d2 = 1, d3 = 0.07 }}
position = {{ d2 = [{start}, 0], d3 = [{start}, 0, 0] }}
direction = {{ d2 = [{sign}, 0], d3 = [{sign}, 0, 0] }}
depth = 0.1
duration = 10

[outflow.end]
min = {{ d2 = [{low}, -1], d3 = [{low}, 0, -1] }}
max = {{ d2 = [{high}, 1], d3 = [{high}, 0.07, 1] }}
"""


def plug(flows, dim, sign):
    """Plug flow towards +x or -x."""
    low, high = (0.4, 1) if sign > 0 else (-1, -0.4)
    return flows(
        PLUG.format(dim=dim, speed=1.6 * sign, sign=sign, start=-0.4 * sign, low=low, high=high)
    )


def depth(state, dim, sign):
    """Of the water between 0.1 and 0.4 m behind the section, from its mass, m."""
    along = sign * state["position"][:, 0] + 0.4
    near = (state["motion"] == 0) & (along > 0.1) & (along < 0.4)
    return state["mass"][near].sum() / (1000 * 0.3 * (0.07 if dim == 3 else 1))


def excess(state, sign):
    """Mean pressure of the layer that enters next over that of water at rest, Pa."""
    along = sign * state["position"][:, 0] + 0.4
    next_one = (state["motion"] == DRIVEN) & (along > -0.01)
    at_rest = 9810 * (0.1 - state["position"][:, -1])
    return (state["pressure"] - at_rest)[next_one].mean()


@pytest.mark.parametrize(("dim", "sign"), [(2, 1), (2, -1), (3, 1)])
def test_plug_flow_goes_on_as_it_enters(core, flows, dim, sign):
    """With no pressure behind it, water would slow down and rise by 2 % to regain it."""
    simulation = plug(flows, dim, sign)
    depths, pressures = [], []
    for time in np.linspace(0.3, 0.4, 11):
        simulation.advance(limit=time, pause=time, max_steps=10**9)
        depths.append(depth(simulation.state(), dim, sign))
        pressures.append(excess(simulation.state(), sign))
    assert np.mean(depths) == pytest.approx(0.1, rel=0.004)
    assert abs(np.mean(pressures)) < 0.06 * 0.5 * 981  # layers of no pressure: -490
