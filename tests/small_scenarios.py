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
