"""Scenes with structures that water and grains load."""

from __future__ import annotations

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

# Water that rests before a dam, which reaches into the bed; all turned by `angle` about the foot of
# the left wall.
DAM = """\
dim = 2
dp = "= depth/particles"
time_max = 0.3
time_out = 0.3
scheme = "resolved"
speed_max = "= sqrt(g*depth)"
g = 9.81
gravity = ["= g*s", "= -g*c"]

[parameters]
depth = { value = 0.4 }
height = { value = 0.52 }
particles = { value = 40 }
angle = { value = 0 }
rho = { value = 1000 }
c = { value = "= cos(angle*pi/180)" }
s = { value = "= sin(angle*pi/180)" }

[material.water]
rho0 = "= rho"

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [0, 1]
min = ["= -4*dp", "= -4*dp"]
max = ["= depth", 0]
rotate = "= angle"
pivot = [0, 0]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [1, 0]
min = ["= -4*dp", 0]
max = [0, "= height"]
rotate = "= angle"
pivot = [0, 0]

[body.dam]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
min = ["= depth", "= -4*dp"]
max = ["= depth + 12*dp", "= height"]
rotate = "= angle"
pivot = [0, 0]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = ["= depth", "= depth"]
rotate = "= angle"
pivot = [0, 0]
pressure = "= rho*g*(depth - y*c + x*s)"

[gauge.dam]
kind = "load"
bodies = ["dam"]
about = ["= depth*c", "= depth*s"]
interval = 0.02

[gauge.face]
kind = "panels"
bodies = ["dam"]
origin = ["= depth*c", "= depth*s"]
edges = [["= -height*s", "= height*c"]]
panels = [13]
direction = ["= -c", "= -s"]
interval = 0.02
"""
# The same in 3-D, coarse: a channel along x with banks in y, into which the dam reaches.
DAM_3D = """\
dim = 3
dp = "= depth/particles"
time_max = 0.2
time_out = 0.2
scheme = "resolved"
speed_max = "= sqrt(g*depth)"
g = 9.81
gravity = [0, 0, "= -g"]

[parameters]
depth = { value = 0.4 }
width = { value = 0.4 }
particles = { value = 10 }

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [0, 0, 1]
min = ["= -3*dp", "= -3*dp", "= -3*dp"]
max = [0.6, "= width + 3*dp", 0]

[body.back]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [1, 0, 0]
min = ["= -3*dp", "= -3*dp", 0]
max = [0, "= width + 3*dp", 0.52]

[body.right]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [0, 1, 0]
min = [0, "= -3*dp", 0]
max = [0.6, 0, 0.52]

[body.left]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [0, -1, 0]
min = [0, "= width", 0]
max = [0.6, "= width + 3*dp", 0.52]

[body.dam]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [-1, 0, 0]
min = [0.6, "= -3*dp", "= -3*dp"]
max = ["= 0.6 + 3*dp", "= width + 3*dp", 0.52]

[body.water]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [0.6, "= width", "= depth"]
pressure = "= 1000*g*(depth - z)"

[gauge.dam]
kind = "load"
bodies = ["dam"]
about = [0.6, 0, 0]
interval = 0.02

[gauge.face]
kind = "panels"
bodies = ["dam"]
origin = [0.6, 0, 0]
edges = [[0, "= width", 0], [0, 0, 0.52]]
panels = [2, 4]
direction = [-1, 0, 0]
interval = 0.02

[figure.face]
kind = "load"
gauge = "face"

[figure.dam]
kind = "load"
gauge = "dam"
"""
# Water that falls on a wall.
RUSH = """
dim = 2
dp = 0.05
scheme = "resolved"
speed_max = 4
time_max = 0.3
time_out = 0.3
gravity = [9.81, 0]
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.5, 0.4]
[body.dam]
shape = "box"
material = "basalt"
fixed = true
min = [1, -0.2]
max = [1.2, 0.6]
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [0, -0.2]
max = [1, 0]
[gauge.dam]
kind = "load"
bodies = ["dam"]
about = [1, 0]
approach = "before"
interval = 0.01
[gauge.before]
kind = "approach"
position = [0.5, 0]
direction = [1, 0]
interval = 0.01
"""
# A tank into which grains fall on water beside a sill; everything that is fixed has one gauge.
RAIN = """\
dim = 2
dp = 0.02
time_max = 0.24
time_out = 0.12
scheme = "resolved"
speed_max = 2
gravity = [0, -9.8]

[body.tank]
shape = "tank"
material = "aluminium"
min = [0, 0]
max = [0.8, 0.5]

[body.sill]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.6, 0.2]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.16]

[body.rain]
shape = "disc"
material = "basalt"
d = 0.08
count = 12
min = [0, 0.22]
max = [0.8, 0.5]
velocity = [0, -1.5]

[gauge.all]
kind = "load"
bodies = ["tank.-x", "tank.+x", "tank.-y", "sill"]
about = [0.3, 0.1]
interval = 0.01

[gauge.rare]
kind = "load"
bodies = ["tank.-x", "tank.+x", "tank.-y", "sill"]
about = [0.3, 0.1]
interval = 0.12

[gauge.sill]
kind = "load"
bodies = ["sill"]
interval = 0.01

[gauge.top]
kind = "panels"
bodies = ["sill"]
origin = [0.4, 0.2]
edges = [[0.2, 0]]
panels = [4]
direction = [0, 1]
interval = 0.01

[gauge.crest]
kind = "overtopping"
position = [0.4, 0.2]
direction = [1, 0]
interval = 0.01
"""
# A stream with a dam, from an inflow to an outflow behind it.
STREAM = """\
dim = 2
dp = 0.02
time_max = 1.8
time_out = 0.6
scheme = "resolved"
speed_max = 4
gravity = [0, -9.81]

[body.bed]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
normal = [0, 1]
min = [-0.3, -0.08]
max = [2.4, 0]

[body.dam]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
min = [1.4, 0]
max = [1.6, 0.18]

[inflow.river]
material = "water"
rate = 0.24
duration = 10
width = 1
depth = 0.12
position = [-0.1, 0]
direction = [1, 0]

[outflow.end]
min = [2.2, -5]
max = [9, 9]

[gauge.crest]
kind = "overtopping"
position = [1.5, 0.18]
direction = [1, 0]
interval = 0.1

[gauge.before]
kind = "approach"
position = [0.5, 0]
direction = [1, 0]
interval = 0.01

[gauge.dam]
kind = "load"
bodies = ["dam"]
approach = "before"
interval = 0.005
"""

# A jet on a plate that is longer than the space between the outflows, all turned by `angle`.
JET = """\
dim = 2
dp = "= thickness/particles"
time_max = 0.6
time_out = 0.6
scheme = "resolved"
speed_max = "= 2*speed"
gravity = [0, 0]

[parameters]
particles = { value = 10 }
thickness = { value = 0.1 }
speed = { value = 2 }
edge = { value = 0.4 }
angle = { value = 0 }
c = { value = "= cos(angle*pi/180)" }
s = { value = "= sin(angle*pi/180)" }

[inflow.jet]
material = "water"
rate = "= speed*thickness"
duration = 100
width = 1
depth = "= thickness"
position = ["= -0.25*c + 0.5*thickness*s", "= -0.25*s - 0.5*thickness*c"]
direction = ["= c", "= s"]

[body.plate]
shape = "box"
material = "aluminium"
fixed = true
wall = "free_slip"
min = [0, "= -1.5*edge"]
max = ["= 9*dp", "= 1.5*edge"]
rotate = "= angle"
pivot = [0, 0]

[outflow.left]
min = [-3, -3]
max = ["= -edge", 3]

[outflow.right]
min = ["= edge", -3]
max = [3, 3]

[outflow.below]
min = [-3, -3]
max = [3, "= -edge"]

[outflow.above]
min = [-3, "= edge"]
max = [3, 3]

[gauge.plate]
kind = "load"
bodies = ["plate"]
interval = 0.01
"""


def scenario_of(folder, text, *overrides):
    """The scenario of a text, with values laid over it."""
    (folder / "case.toml").write_text(text)
    return load_scenario(str(folder / "case.toml"), list(overrides))


def run_of(folder, text, *overrides, threads=1):
    """The record of a run of a text."""
    scenario = scenario_of(folder, text, *overrides)
    run_scenario(scenario, folder / "run", RunOptions(threads=threads))
    return load(folder / "run")
