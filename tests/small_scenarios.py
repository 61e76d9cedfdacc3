"""A small scenario file to change."""

MINIMAL = """\
dim = 2
dp = 0.1
time_max = 1
time_out = 0.1
"""
BLOCK = """
[body.block]
shape = "box"
material = "water"
min = [0, 0]
max = [1, 0.5]
"""
