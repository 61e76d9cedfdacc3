"""Every kind of simulation, a few steps, to be run under a sanitiser."""

import sys
import tempfile
from pathlib import Path

import numpy as np

from doseki.geodata.raster import Raster, write_raster
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation, load_core

# Water among walls of each kind, with an inflow, an outflow and a gate that turns.
RESOLVED = """\
dim = {dim}
dp = 0.01
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 2
gravity = {{ d2 = [1, -9.8], d3 = [1, 0, -9.8] }}
turbulence = "{turbulence}"
periodic = {periodic}
domain_min = {{ d2 = [-1, -1], d3 = [-1, 0, -1] }}
domain_max = {{ d2 = [9, 1], d3 = [9, 0.08, 1] }}

[parameters]
length = {length}

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "rough"
ks = 0.005
min = {{ d2 = [0, -0.03], d3 = [0, 0, -0.03] }}
max = {{ d2 = ["= length + 0.2", 0], d3 = ["= length + 0.2", 0.08, 0] }}

[body.gate]
shape = "box"
material = "aluminium"
fixed = true
normal = {{ d2 = [-1, 0], d3 = [-1, 0, 0] }}
min = {{ d2 = ["= length", 0], d3 = ["= length", 0, 0] }}
max = {{ d2 = ["= length + 0.03", 0.1], d3 = ["= length + 0.03", 0.08, 0.1] }}
motion = {{ velocity = {{ d2 = [0.5, 1], d3 = [0.5, 0, 1] }} }}

[body.water]
shape = "box"
material = "water"
min = {{ d2 = [0.1, 0], d3 = [0.1, 0, 0] }}
max = {{ d2 = ["= length", 0.1], d3 = ["= length", 0.08, 0.1] }}

[inflow.source]
material = "water"
rate = {{ d2 = 0.05, d3 = 0.004 }}
width = {{ d2 = 1, d3 = 0.08 }}
position = {{ d2 = [0.05, 0], d3 = [0.05, 0, 0] }}
direction = {{ d2 = [1, 0], d3 = [1, 0, 0] }}
depth = 0.05
duration = 1

[outflow.end]
min = {{ d2 = ["= length - 0.01", "-inf"], d3 = ["= length - 0.01", "-inf", "-inf"] }}
max = {{ d2 = ["inf", "inf"], d3 = ["inf", "inf", "inf"] }}
"""

# A release on a map, with a boulder, whose walls come and go.
TERRAIN = """\
dim = {dim}
dp = 0.1
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 4
gravity = {{ d2 = [0, -9.8], d3 = [0, 0, -9.8] }}

[terrain]
file = "{file}"
material = "basalt"
wall = "rough"
ks = 0.05

[body.slide]
shape = "release"
material = "water"
{place}
thickness = 0.4

[body.boulder]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "basalt"
centre = {{ d2 = [3.0, 1.0], d3 = [3.0, 1.0, 1.0] }}
radius = 0.3
"""
# Bodies that strike a plate and break, one of them rigid until then.
BREAKING = """\
dim = {dim}
dp = {dp}
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 8
gravity = {{ d2 = [0, -9.8], d3 = [0, 0, -9.8] }}

[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.3
fracture = "cohesive"
tensile_strength = 1e5
fracture_energy = 1

[body.stone]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "chalk"
kinematics = "breakable"
centre = {{ d2 = [0, 0.0502], d3 = [0, 0, 0.0502] }}
radius = 0.05
velocity = {{ d2 = [1, -6], d3 = [1, 0, -6] }}

[body.clod]
shape = {{ d2 = "disc", d3 = "sphere" }}
material = "chalk"
kinematics = "elastic"
centre = {{ d2 = [0.11, 0.0502], d3 = [0.11, 0, 0.0502] }}
radius = 0.05
velocity = {{ d2 = [-1, -6], d3 = [-1, 0, -6] }}

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
min = {{ d2 = [-0.1, -0.03], d3 = [-0.1, -0.1, -0.03] }}
max = {{ d2 = [0.2, 0], d3 = [0.2, 0.1, 0] }}
"""
PLACES = {
    2: "between = [0.6, 2.0]",
    3: "polygon = [[0.6, 0.6], [2.0, 0.6], [2.0, 1.4], [0.6, 1.4]]",
}


def flume(dim, precision, h_mode, size):
    """The flume of the paper's scheme, with strength."""
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
    return load_scenario("flume", settings)


def channel(dim, size, folder):
    """A channel of the resolved scheme."""
    turbulence, periodic = ("smagorinsky", "[]") if dim == 2 else ("mixing_length", '["y"]')
    length = 0.1 + size * (1.0 if dim == 2 else 0.2)
    file = Path(folder) / "channel.toml"
    text = RESOLVED.format(dim=dim, length=length, turbulence=turbulence, periodic=periodic)
    file.write_text(text)
    return load_scenario(str(file))


def slide(dim, folder):
    """A release on a map that has a hole."""
    x, y = np.meshgrid(np.arange(25) * 0.2 + 0.1, np.arange(10) * 0.2 + 0.1)
    heights = 2.0 - 0.5 * x + 0.05 * np.sin(4 * x + y)
    name = "map.csv" if dim == 2 else "map.asc"
    if dim == 2:
        rows = zip(x[0].tolist(), heights[0].tolist(), strict=True)
        (Path(folder) / name).write_text("x,z\n" + "".join(f"{a},{b}\n" for a, b in rows))
    else:
        heights[0, -1] = np.nan
        write_raster(Path(folder) / name, Raster(heights[::-1], 0.0, 0.0, 0.2))
    file = Path(folder) / "slide.toml"
    file.write_text(TERRAIN.format(dim=dim, file=name, place=PLACES[dim]))
    return load_scenario(str(file))


def breaking(dim, folder):
    """Bodies that break on a plate."""
    file = Path(folder) / "breaking.toml"
    file.write_text(BREAKING.format(dim=dim, dp=0.01 if dim == 2 else 0.0125))
    return load_scenario(str(file))


def exercise(scenario, steps, more=5, until=1.0):
    """Step it, look at everything, and go on from a checkpoint to the same bits for some `more`.

    No farther than to the time `until`, s: bodies that touch nothing go there in one step.
    """
    simulation, names = build_simulation(scenario)
    simulation.advance(limit=until, pause=until, max_steps=steps)
    simulation.state(), simulation.rates(), simulation.totals()
    copy = empty_simulation(scenario, names)
    copy.restore(simulation.checkpoint())
    for each in (simulation, copy):
        each.advance(limit=until, pause=until, max_steps=more)
    one, other = simulation.state(), copy.state()
    assert all(np.array_equal(one[name], other[name]) for name in one)
    print(scenario.scheme, scenario.dim, len(simulation), simulation.steps)


MODES = (
    (2, "double", "eq10"),
    (2, "mixed", "constant"),
    (3, "double", "constant"),
    (3, "mixed", "eq10"),
)
STEPS = {2: 40, 3: 12}  # by dimension
threads, size, site = int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
core = load_core()
assert Path(core.__file__).is_relative_to(site), f"{core.__file__} is not the module to watch"
core.set_threads(threads)
for mode in MODES:
    exercise(flume(*mode, size), STEPS[mode[0]])
with tempfile.TemporaryDirectory() as folder:
    for dim, steps in STEPS.items():
        exercise(channel(dim, size, folder), steps)
        exercise(slide(dim, folder), steps)
        exercise(breaking(dim, folder), 3, 1, 0.006)  # of hundreds of short steps each
