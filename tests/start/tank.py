"""A tank with everything that a run can carry over, and runs of it."""

from __future__ import annotations

from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

TOP = """\
dim = 2
scheme = "resolved"
dp = 0.02
speed_max = 2
time_max = 0.03
time_out = 0.01
gravity = [0, -9.8]
[material.rubber]
law = "solid"
rho0 = 1100
speedsound = 60
young_modulus = 1e5
poisson_ratio = 0.4
"""


def box(name, low, high, *keys, material="basalt", side=1):
    """A table; with `side` = -1 as in a mirror at x = 0."""
    (x0, y0), (x1, y1) = low, high
    x0, x1 = sorted((side * x0, side * x1))
    return f"""\
[body.{name}]
shape = "box"
material = "{material}"
min = [{x0}, {y0}]
max = [{x1}, {y1}]
{chr(10).join(keys)}
"""


def tank_text(side=1):
    """Water, a paddle that turns, a gate that vanishes, discs, and an elastic block."""
    turning = f"angular_velocity = {8 * side}, pivot = [{-0.06 * side}, 0.06]"
    return TOP + "".join(
        [
            box(
                "water", (0, 0), (0.2, 0.1), f"velocity = [{0.3 * side}, 0]",
                material="water", side=side,
            ),
            box("floor", (-0.1, -0.06), (0.7, 0), "fixed = true", side=side),
            box(
                "paddle", (-0.1, 0.02), (-0.02, 0.1), "fixed = true",
                f"motion = {{ velocity = [{0.5 * side}, 0], {turning} }}", side=side,
            ),
            box(
                "gate", (0.6, 0), (0.66, 0.1), "fixed = true",
                "motion = { removed_at = 0.015 }", side=side,
            ),
            disc("one", 0.36, side),
            disc("two", 0.46, side),
            box(
                "block", (0.22, 0.01), (0.3, 0.13), 'kinematics = "elastic"',
                f'velocity = ["= {0.1 * side}*sin(20*y)", 0]', material="rubber", side=side,
            ),
        ]
    )  # fmt: skip


def disc(name, x, side=1, y=0.0401):
    """A disc that rolls."""
    return f"""\
[body.{name}]
shape = "disc"
material = "basalt"
centre = [{x * side}, {y}]
radius = 0.04
spin = {3 * side}
velocity = [{-0.2 * side}, 0]
"""


def run(text, file, *settings):
    """Run a scenario that is written to a file, into a folder beside it of the same name."""
    file.write_text(text)
    folder = file.with_suffix("")
    run_scenario(load_scenario(file, settings), folder, RunOptions(threads=1))
    return load(folder)


def continued(text, folder, *keys):
    """The scenario of a run that starts from another one."""
    return text + "\n".join(["[start]", f'from = "{folder}"', *keys, ""])
