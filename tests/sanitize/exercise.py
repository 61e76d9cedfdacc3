"""Every kind of simulation, a few steps, to be run under a sanitiser."""

import sys

import numpy as np

from doseki.core import build_simulation, empty_simulation, load_core
from doseki.scenario import load_scenario

threads, size = int(sys.argv[1]), sys.argv[2]
core = load_core()
core.set_threads(threads)
MODES = (
    (2, "double", "eq10"),
    (2, "float", "constant"),
    (3, "double", "constant"),
    (3, "float", "eq10"),
)
for dim, precision, h_mode in MODES:
    settings = [
        f"dim={dim}",
        f"precision={precision}",
        f"h_mode={h_mode}",
        "flume_length=0.6",
        "strength=true",
        "load_start=0.2",
        "load_length=0.1",
        f"load_mass={size}",
        "board_length=0.1",
        f"diameter={0.01 if dim == 2 else 0.02}",
    ]
    scenario = load_scenario("flume", settings)
    simulation, names = build_simulation(scenario)
    simulation.advance(limit=1.0, pause=1.0, max_steps=40)
    simulation.state(), simulation.rates(), simulation.totals()
    copy = empty_simulation(scenario, names)
    copy.restore(simulation.checkpoint())
    for each in (simulation, copy):
        each.advance(limit=1.0, pause=1.0, max_steps=5)
    one, other = simulation.state(), copy.state()
    assert all(np.array_equal(one[name], other[name]) for name in one)
    print(dim, precision, h_mode, len(simulation), simulation.steps)
