"""The code of a graphics card, run on the processor: what the processor's own core does."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from doseki.bench.flows import FLOWS
from doseki.compiled import available_instruction_sets, card_here, load_core
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, empty_simulation

from ..flows import CHANNEL, FILM, advance, assert_same_bits

HAS_DEVICE = "device" in available_instruction_sets()
pytestmark = [
    pytest.mark.isa,
    pytest.mark.skipif(not HAS_DEVICE, reason="the core was not built for --device host"),
]
PERIODS = {"film": 0.12}  # of a text [m]
SCALES = {"position": 0.01, "velocity": 1.0, "density": 1000.0}
PRINTED = """\
dim = 2
dp = 0.01
time_max = 1
time_out = 1
speed_max = 2
gravity = [0, -9.81]
[body.floor]
shape = "box"
material = "basalt"
fixed = true
min = [-0.05, -0.03]
max = [0.45, 0]
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.2]
[body.rock]
shape = "disc"
material = "basalt"
centre = [0.3, 0.1]
radius = 0.05
"""
FASTEST = (available_instruction_sets() or [None])[0]
DEVICES = ["device", "cuda"] if card_here() else ["device"]
TEXTS = {"film": FILM.format(dim=3), "channel": CHANNEL, "printed": PRINTED}


def largest_difference(one, other, period=np.inf):
    """Of positions (of any image), velocities and densities, over their scales."""
    one, other = one.state(), other.state()
    assert np.array_equal(one["id"], other["id"])
    differences = {name: one[name] - other[name] for name in SCALES}
    differences["position"] -= np.round(differences["position"] / period) * min(period, 1e9)
    return max(np.abs(differences[name]).max() / scale for name, scale in SCALES.items())


@pytest.mark.parametrize("isa", DEVICES)
@pytest.mark.parametrize("text", TEXTS)
def test_fields_after_steps(flows, text, isa):
    """Sums in another order; layers of inflows enter in the same steps."""
    processor, device = flows(TEXTS[text], isa=FASTEST), flows(TEXTS[text], isa=isa)
    for steps in (1, 9, 90):
        advance(processor, steps), advance(device, steps)
        assert processor.steps == device.steps
        assert largest_difference(processor, device) < 1e-12


@pytest.mark.parametrize("isa", DEVICES)
@pytest.mark.parametrize("name", ["flume", "tumbler"])
def test_grains_and_inflow(name, isa):
    scenario = load_scenario(FLOWS[name].scenario)
    simulations = [build_simulation(scenario, module)[0] for module in (FASTEST, isa)]
    for simulation in simulations:
        advance(simulation, 40)
    assert largest_difference(*simulations) < 1e-9


@pytest.mark.parametrize("isa", DEVICES)
@pytest.mark.parametrize("name", ["elastic-gate", "brazil-test", "dam-step"])
def test_bodies_that_bend_and_walls_that_move(name, isa):
    scenario = load_scenario(name)
    simulations = [build_simulation(scenario, module)[0] for module in (FASTEST, isa)]
    for simulation in simulations:
        advance(simulation, 40)
    assert largest_difference(*simulations) < 1e-9


@pytest.mark.parametrize("isa", DEVICES)
@pytest.mark.parametrize("precision", ["double", "mixed"])
@pytest.mark.parametrize("text", TEXTS)
def test_threads_and_runs_change_no_bit(flows, text, precision, isa):
    core, checkpoints = load_core(isa), []
    before = core.threads()
    for threads in (1, 2, 4, 4):
        core.set_threads(threads)
        simulation = flows(TEXTS[text], f"precision={precision}", isa=isa)
        checkpoints.append(advance(simulation, 60).checkpoint())
    core.set_threads(before)
    for other in checkpoints[1:]:
        assert_same_bits(checkpoints[0], other)


@pytest.mark.parametrize("isa", [FASTEST, *DEVICES])
@pytest.mark.parametrize("name", ["tumbler", "dam-step"])
def test_threads_change_no_bit_of_bodies(name, isa):
    """Contacts and motion: of grains in a drum, and of what lies on the ground."""
    scenario = load_scenario(FLOWS[name].scenario if name in FLOWS else name)
    core = load_core(isa)
    before, checkpoints = core.threads(), []
    for threads in (1, 2, 4):
        core.set_threads(threads)
        simulation, _names = build_simulation(scenario, isa)
        checkpoints.append(advance(simulation, 40).checkpoint())
    core.set_threads(before)
    for other in checkpoints[1:]:
        assert_same_bits(checkpoints[0], other)


@pytest.mark.parametrize("isa", DEVICES)
@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("text", TEXTS)
def test_a_checkpoint_goes_on_elsewhere(flows, text, back, isa):
    """From the processor to the device, and back."""
    scenario = flows.scenario(TEXTS[text])
    first, second = (isa, FASTEST) if back else (FASTEST, isa)
    run = advance(build_simulation(scenario, first)[0], 20)
    moved = empty_simulation(scenario, [*scenario.body, *scenario.inflow], second)
    assert not moved.restore(run.checkpoint()), "lists are of another kind"
    advance(run, 20), advance(moved, 20)
    assert largest_difference(run, moved, PERIODS.get(text, np.inf)) < 1e-9


def doseki(*arguments, cwd):
    command = [sys.executable, "-m", "doseki.cli.main", *arguments]
    environment = {name: value for name, value in os.environ.items() if name != "DOSEKI_ISA"}
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)


def test_a_run_by_the_command_line(tmp_path):
    (tmp_path / "case.toml").write_text(PRINTED)
    done = doseki(
        "run", "case.toml", "-o", "out", "--set", "time_max=0.01", "--device", "host", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert '"core": "device"' in (tmp_path / "out/provenance.json").read_text()


def test_without_a_card(tmp_path):
    """Exit code 2 where the core is not built for cards, 4 where there is none."""
    (tmp_path / "case.toml").write_text(PRINTED)
    done = doseki("run", "case.toml", "-o", "out", "--device", "cuda", cwd=tmp_path)
    if done.returncode == 0:
        pytest.skip("there is a card")
    assert done.returncode in (2, 4)
    assert "graphics card" in done.stderr or "the core is not built for it" in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()
