"""A small scenario file to change, and parts of others."""

MINIMAL = """\
dim = 2
dp = 0.1
time_max = 1
time_out = 0.1
"""
CHALK = """
[material.chalk]
law = "solid"
rho0 = 1000
young_modulus = 1e8
poisson_ratio = 0.2
friction = 0.3
fracture = "cohesive"
tensile_strength = 1e5
fracture_energy = 1
"""
BLOCK = """
[body.block]
shape = "box"
material = "water"
min = [0, 0]
max = [1, 0.5]
"""
# A dam of triangles that holds water back between two banks, and reads its load.
BANKS = """\
dim = 3
dp = 0.05
gravity = [0, 0, -9.81]
time_max = 1
time_out = 1
scheme = "resolved"
speed_max = 4
[body.water]
shape = "box"
material = "water"
min = [0, 0, 0]
max = [{length}, 0.4, 0.5]
[body.dam]
shape = "mesh"
file = "{file}"
material = "basalt"
[body.floor]
shape = "box"
material = "basalt"
fixed = true
normal = [0, 0, 1]
min = [-0.15, -0.15, -0.15]
max = [{ends}, 0.55, 0]
[body.left]
shape = "box"
material = "basalt"
fixed = true
normal = [0, 1, 0]
min = [0, -0.15, 0]
max = [{ends}, 0, 0.6]
[body.right]
shape = "box"
material = "basalt"
fixed = true
normal = [0, -1, 0]
min = [0, 0.4, 0]
max = [{ends}, 0.55, 0.6]
[gauge.dam]
kind = "load"
bodies = ["dam"]
about = [0.6, 0.2, 0]
"""
