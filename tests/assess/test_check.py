"""`doseki check`: what it counts, what it warns of, and how good its estimates are."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import doseki
from doseki.assess.estimates import mach_number
from doseki.assess.ground.sliding import Sliding
from doseki.assess.preflight import brief_check, check_scenario
from doseki.assess.warnings import ShallowFlow, thorough_findings
from doseki.scenario.load import load_scenario
from doseki.scene.checks.terrain import ThinRelease
from doseki.solver.build import build_simulation, filled_simulation
from doseki.util.finding import rounded_up

SCENARIO = """\
schema = 1
dim = 2
dp = 0.01
time_max = 0.05
time_out = 0.01
xi = {xi}
slope = 0

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [0, "= -{layers}*dp"]
max = [0.5, 0]

[body.water]
shape = "box"
material = "water"
min = [0.1, {bottom}]
max = [0.3, {top}]
"""


@pytest.fixture
def doubts(tmp_path):
    """The findings about a body of water over a floor."""

    def find(xi=0.05, layers=3, bottom=0.0, top=0.12, more="", replace=("", ""), scheme="ueta2022"):
        file = tmp_path / "case.toml"
        file.write_text(
            SCENARIO.format(xi=xi, layers=layers, bottom=bottom, top=top).replace(*replace) + more
        )
        scenario = load_scenario(file, [f"scheme={scheme}"])
        simulation, names, of_scene = filled_simulation(scenario)
        simulation.start()
        sliding = Sliding(scenario, simulation.state(), names)
        return [str(doubt) for doubt in thorough_findings(sliding, of_scene)]

    return find


def test_a_good_set_up_raises_no_doubt(doubts):
    assert doubts() == []


def test_walls_of_a_dry_scene_need_no_thickness(doubts):
    dry = {"layers": 1, "replace": ('"water"', '"basalt"')}
    assert not any("a wall of" in doubt for doubt in doubts(**dry, scheme="resolved"))
    assert any("a wall of 1 layer" in doubt for doubt in doubts(**dry))


def test_two_layers_keep_apart_what_is_on_both_sides(doubts):
    """As far as the default kernel of the resolved scheme sees."""
    one, two = (doubts(layers=layers, scheme="resolved") for layers in (1, 2))
    assert any("a wall of 1 layer has one face" in doubt for doubt in one)
    assert any("make it 2 layers" in doubt for doubt in one)
    assert not any("a wall of" in doubt for doubt in two)


GAUGE = """
[gauge.far]
kind = "pressure"
position = [0.2, 3]
"""
PISTON = """
[body.piston]
shape = "box"
material = "aluminium"
fixed = true
min = [0.4, 0]
max = [0.43, 0.1]
motion = { velocity = [-12, 5] }
"""
ROUGH = """
[inflow.i]
material = "water"
rate = 0.01
width = 0.1
position = [0.01, 0]
direction = [1, 0]
depth = 0.2
ks = 0.15
duration = 1
"""


def test_a_mass_that_is_weaker_than_its_bed_is_named(doubts):
    wall = 'max = [0.5, 0]\nwall = "voellmy"\nmu = 0.3'
    told = doubts(replace=("max = [0.5, 0]", wall), scheme="resolved")
    assert any("body.floor.mu = 0.3: water has less friction inside" in doubt for doubt in told)
    assert not any("with xi" in doubt for doubt in told)
    smooth = doubts(replace=("max = [0.5, 0]", wall.replace("0.3", "0")), scheme="resolved")
    assert not any("friction inside" in doubt for doubt in smooth)


GRAINS = """
[material.water]
rheology = "mu_i"
mu_s = 0.5
mu_2 = 0.5
inertial_number = 0.3
grain_diameter = 1e-3
grain_density = 2600
viscosity_max = 10
pore_pressure_ratio = {pore}
"""


@pytest.mark.parametrize(
    ("xi", "pore", "weak"), [(1000, 0, False), (1000, 0.9, True), (100, 0, True)]
)
def test_the_turbulent_part_of_a_bed_counts(doubts, xi, pore, weak):
    """Half of a tenth of the sound speed, 3.7 m/s, in 0.12 m of water."""
    bed = f'max = [0.5, 0]\nwall = "voellmy"\nmu = 0.3\nturbulent_xi = {xi}'
    told = doubts(replace=("max = [0.5, 0]", bed), scheme="resolved", more=GRAINS.format(pore=pore))
    assert any("and with xi" in doubt for doubt in told) is weak


DISCS = """
[body.discs]
shape = "disc"
material = "basalt"
d = 0.08
wetted = 0.6
count = 3
min = [0.1, {foot}]
max = [0.4, 0.4]
settle = {settle}
"""


@pytest.mark.parametrize(
    ("foot", "settle", "hangs"), [(0, "'0.5 s'", False), (0.06, "false", True)]
)
def test_discs_that_water_sees_smaller_lie_on_what_they_touch(doubts, foot, settle, hangs):
    """Their particles are 1.6 spacings within their outline, more than bodies that touch have."""
    dry = ("[body.water]", DISCS.format(foot=foot, settle=settle) + "[body.water]\nenabled = false")
    told = doubts(replace=dry, scheme="resolved")
    assert any("discs: touches nothing" in doubt for doubt in told) is hangs


@pytest.mark.parametrize(
    ("wetted", "settle", "closed"),
    [(1.0, "true", True), (0.75, "true", False), (1.0, "false", False)],
)
def test_pores_between_discs_that_touch_are_told(doubts, wetted, settle, closed):
    """Three discs that are strewn leave water its ways."""
    discs = DISCS.format(foot=0, settle=settle).replace("wetted = 0.6", f"wetted = {wetted}")
    told = doubts(more=discs.replace("max = [0.4", "max = [0.35"), scheme="resolved")
    assert any("body.discs.wetted: discs that touch close the pores" in t for t in told) is closed


@pytest.mark.parametrize("uplift", [True, False])
@pytest.mark.parametrize("kinematics", ["rigid", "elastic"])
def test_bodies_without_uplift_are_told(doubts, kinematics, uplift):
    """All that lie on a bed, also those that deform."""
    block = f"""
[body.block]
shape = "box"
material = "rubber"
kinematics = "{kinematics}"
min = [0.35, 0]
max = [0.45, 0.1]
[material.rubber]
based_on = "basalt"
law = "solid"
young_modulus = 1e6
poisson_ratio = 0.3
"""
    schema = ("schema = 1", f"schema = 1\nuplift = {str(uplift).lower()}")
    told = doubts(more=block, scheme="resolved", replace=schema)
    assert any("uplift: false: water does not press" in doubt for doubt in told) is not uplift


# Water makes room for whole boxes, not for one that is cut.
CUT_FLOOR = {"replace": ("max = [0.5, 0]", 'max = [0.5, 0]\nwhere = "= 0.49 - x"')}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"top": 0.05}, ["water: 5 particles over its depth", "dp = 0.005 would do"]),
        ({"layers": 2}, ["floor: a wall of 2 layers", "make it 3 layers (0.03 m) thick"]),
        ({"xi": 0.001}, ["Mach 1", "for Mach 0.1 set xi = 0.012 (now 0.001)"]),
        ({"bottom": 0.03, "top": 0.15}, ["water: touches nothing", "4 dp away"]),
        ({"bottom": 0.2, "top": 0.32}, ["water: touches nothing", "more than 4 dp away"]),
        (CUT_FLOOR | {"bottom": -0.012, "top": 0.12}, ["overlaps"]),
        ({"more": GAUGE}, ["gauge.far.position = [0.2, 3.0] m lies outside everything"]),
        ({"more": PISTON}, ["speeds up to 13.1 m/s are Mach"]),
        ({"more": ROUGH}, ["inflow.i.ks = 0.15 m is larger than the depth of the flow, 0.12 m"]),
    ],
)
def test_a_doubtful_set_up_is_named_with_its_remedy(doubts, changes, words):
    told = " ".join(doubts(**changes))
    for word in words:
        assert word in told


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("xi = 0.001", "for Mach 0.1 set xi = 0.012 (now 0.001)"),
        ("xi_height = 0.001", "set xi_height = 0.14 (now 0.001)"),
        ("speed_max = 0.14", "set speed_max = 1.7 (now 0.14)"),
    ],
)
def test_advice_names_the_key_that_the_scenario_gives(doubts, given, words):
    """A fall from the top through the floor makes 1.66 m/s; the sound speed is 1.4 m/s."""
    told = " ".join(doubts(replace=("xi = 0.05", given)))
    assert words in told


@pytest.mark.parametrize(
    ("value", "rounded"), [(1.04, 1.1), (1.0, 1.0), (0.0101, 0.011), (123.0, 130.0), (99.1, 100.0)]
)
def test_advice_is_rounded_so_that_it_is_enough(value, rounded):
    assert rounded_up(value) == rounded


def test_report_has_all_that_is_promised():
    told = check_scenario(load_scenario("flume"), threads=1)
    for word in (
        "particles",
        "most particles",
        "memory",
        "disk",
        "steps",
        "wall time",
        "per grain",
        "depth of water",
        "Mach number",
        "1.1 particles across a grain",
    ):
        assert word in told
    assert "926 basalt" in told


def test_brief_form_takes_no_step():
    scenario = load_scenario("flume")
    simulation, names = build_simulation(scenario)
    lines = brief_check(scenario, simulation, names)
    assert lines[0].startswith("3,082 particles")
    assert simulation.steps == 0


def test_what_nothing_hinders_takes_steps_from_output_to_output(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(
        'dim = 2\ndp = 0.01\nxi = 0.01\ntime_max = 0.6\ntime_out = 0.2\nscheme = "resolved"\n'
        'gravity = [0, 0]\n[body.a]\nshape = "disc"\nmaterial = "basalt"\ncentre = [0, 0]\n'
        "radius = 0.05\nvelocity = [1, 0]\n",
        encoding="utf-8",
    )
    scenario = load_scenario(path)
    assert (
        "first timestep 0.2 s: about 3 steps"
        in brief_check(scenario, *build_simulation(scenario))[0]
    )


MEASURE = """
import json, sys
from doseki.solver.build import build_simulation, load_core
from doseki.assess.cost import estimate
from doseki.scenario.load import load_scenario
load_core().set_threads(1)
scenario = load_scenario(sys.argv[1], sys.argv[2:])
print(json.dumps(vars(estimate(scenario, *build_simulation(scenario)))))
"""
RUN = """
import json, sys
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
summary = run_scenario(load_scenario(sys.argv[1], sys.argv[3:]), sys.argv[2], RunOptions(threads=1))
from pathlib import Path
# Not getrusage: its peak is also that of the process that this one was forked from.
status = Path("/proc/self/status").read_text().splitlines()
peak = next(line for line in status if line.startswith("VmHWM"))
print(json.dumps({
    "steps": summary["step"], "most_particles": summary["n_particles"],
    "seconds": summary["wall_seconds"], "memory": 1024 * int(peak.split()[1]),
}))
"""


def in_own_process(program: str, *arguments: object) -> dict[str, float]:
    paths = os.pathsep.join(
        [str(Path(doseki.__file__).parents[1]), os.environ.get("PYTHONPATH", "")]
    )
    done = subprocess.run(
        [sys.executable, "-c", program, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PYTHONPATH": paths},
    )
    return json.loads(done.stdout)


@pytest.mark.minutes
@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("collision", []),
        ("dambreak", ["time_max=0.3"]),
        ("film", ["time_max=1"]),
        ("flume", ["time_max=0.15"]),
        ("flume-strength", ["time_max=0.15"]),
        ("hang", []),
        ("shear-wave", []),
    ],
)
def test_estimates_are_within_30_percent(name, settings, tmp_path):
    """Wall time is printed only: it also depends on what else the machine does."""
    expected = in_own_process(MEASURE, name, *settings)
    taken = in_own_process(RUN, name, tmp_path / "run", *settings)
    taken["disk"] = sum(f.stat().st_size for f in (tmp_path / "run").rglob("*") if f.is_file())
    for quantity, value in taken.items():
        print(f"{name:15s} {quantity:15s} {expected[quantity]:.4g} expected, {value:.4g} taken")
    for quantity in ("steps", "most_particles", "memory", "disk"):
        assert expected[quantity] == pytest.approx(taken[quantity], rel=0.3), quantity


BASIN = """
[body.{name}]
shape = "box"
material = "aluminium"
fixed = true
min = [{low}, 0]
max = [{high}, {top}]
"""


def speed_in_basin(folder, gravity="[0, -10]", top=0.15, left=0.1, water=""):
    """The largest speed that is expected of water that lies between two walls."""
    sides = BASIN.format(name="left", low=left - 0.03, high=left, top=top)
    sides += BASIN.format(name="right", low=0.3, high=0.33, top=top)
    text = SCENARIO.format(xi=0.05, layers=3, bottom=0, top=0.12) + water + sides
    path = folder / "basin.toml"
    path.write_text(text.replace("slope = 0", f"gravity = {gravity}"))
    scenario = load_scenario(path, ["scheme=resolved"])
    return mach_number(scenario, build_simulation(scenario)[0].state())[0]


def test_water_in_a_basin_falls_no_further_than_where_none_is(tmp_path):
    """Of 0.12 m, and dry land beside it."""
    waves, fall = (10 * 0.12) ** 0.5, (2 * 10 * 0.12) ** 0.5
    assert speed_in_basin(tmp_path) == pytest.approx(waves, rel=0.03)
    assert speed_in_basin(tmp_path, left=0.05) == pytest.approx(fall, rel=0.05)
    assert speed_in_basin(tmp_path, top=0.1) > 1.05 * fall, "it runs over its sides"
    step = 'velocity = [0.5, 0]\nwhere = "= 0.12*(x < 0.2) + 0.07*(x >= 0.2) - y"'
    assert speed_in_basin(tmp_path, water=step) == pytest.approx((0.25 + 1.2) ** 0.5, rel=0.03)
    low = 'where = "= 0.12*(x < 0.2) + 0.02*(x >= 0.2) - y"'
    assert speed_in_basin(tmp_path, water=low) == pytest.approx((2 * 10 * 0.1) ** 0.5, rel=0.08)


def test_a_basin_may_lie_on_its_side(tmp_path):
    """Turned by a quarter, its floor is a wall, and what was a side its floor."""
    upright = speed_in_basin(tmp_path, gravity="[-10, 0]", top=0.12)
    assert upright > (2 * 10 * 0.2) ** 0.5, "nothing is above it"
    lid = BASIN.format(name="lid", low=0.1, high=0.3, top=0.15).replace(", 0]", ", 0.12]")
    shut = speed_in_basin(tmp_path, gravity="[-10, 0]", water=lid)
    assert shut == pytest.approx((10 * 0.2) ** 0.5, rel=0.03)


def test_bodies_alone_have_no_mach_number(doubts):
    for scheme, told in (("resolved", False), ("ueta2022", True)):
        said = doubts(xi=1e-4, replace=('"water"', '"basalt"'), scheme=scheme)
        assert any("are Mach" in doubt for doubt in said) is told
    assert any("are Mach" in doubt for doubt in doubts(xi=1e-4, scheme="resolved"))


def test_thickness_and_depth_of_a_release_are_told_apart():
    """One is normal to the slope and a mean, the other upright and the largest."""
    thin, shallow = ThinRelease("slide", 2.0, 0.62), ShallowFlow("slide", 4.0, 1.25, on_slope=True)
    assert "slide: 2 particles over its mean thickness, normal to the slope" in str(thin)
    assert "slide: 4 particles over its largest depth, upright; below 10 its speed" in str(shallow)
