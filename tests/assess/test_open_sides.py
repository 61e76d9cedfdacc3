"""Open scenes: what will fall for ever is named before the run, with the side where it gets out."""

from __future__ import annotations

import pytest
from tests.shipped import CASES

from doseki.assess.open_sides import open_sides
from doseki.scenario.load import load_scenario
from doseki.scenario.start import start_text
from doseki.scene.build import build_bodies

HEAD = """\
dim = 2
dp = 0.02
time_max = {time}
time_out = 0.1
scheme = "resolved"
speed_max = 3
gravity = [0, -9.8]
"""
TANK = """
[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.4, 0.3]
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.06, -0.06]
max = [1.06, 0]
[body.left]
shape = "box"
material = "aluminium"
fixed = true
min = [-0.06, 0]
max = [0, {left}]
[body.right]
shape = "box"
material = "aluminium"
fixed = true
min = [1, 0]
max = [1.06, {right}]
"""
BLOCK = """
[body.block]
shape = "box"
material = "basalt"
min = [{x}, 0.4]
max = [{y}, 0.5]
"""
INFLOW = """
[inflow.river]
material = "water"
rate = "20 L/s"
width = 1
position = [{x}, 0.1]
direction = [1, 0]
depth = 0.1
duration = 1
"""
BELOW = '\n[outflow.below]\nmin = ["-inf", "-inf"]\nmax = [{end}, -0.5]\n'
GRAINS = """
[body.grains]
shape = "disc"
material = "basalt"
d = 0.04
packing = 0.5
count = 12
min = [{x}, 0.4]
max = [{y}, 0.9]
"""


@pytest.fixture
def opened(tmp_path):
    """What is said of a scene."""

    def find(tables, time=2.0, settings=()):
        path = tmp_path / "case.toml"
        path.write_text(HEAD.format(time=time) + tables)
        return told(str(path), settings)

    return find


def told(path, settings=()):
    scenario = load_scenario(path, settings)
    particles, names = build_bodies(scenario)
    return [str(f) for f in open_sides(scenario, vars(particles), dict(enumerate(names)))]


def tank(left=0.5, right=0.5):
    return TANK.format(left=left, right=right)


def test_a_tank_that_holds_its_water_is_closed(opened):
    assert opened(tank()) == []
    assert opened(tank(left=0.3, right=0.3)) == []


@pytest.mark.parametrize(
    ("walls", "side"),
    [((0.5, 0.1), "+x"), ((0.1, 0.5), "-x"), ((0.2, 0.2), "-x and +x")],
)
def test_walls_lower_than_the_water_are_named(opened, walls, side):
    found = opened(tank(*walls))
    assert len(found) == 1
    assert f"water: the scene is open at its side {side}; " in found[0]
    assert "add a wall, or an [outflow.NAME]" in found[0]


def test_the_sides_turn_with_the_scene(opened):
    turned = [f"body.{name}.rotate=-90" for name in ("water", "floor", "left", "right")]
    pivots = [f"body.{name}.pivot=[0, 0]" for name in ("water", "floor", "left", "right")]
    settings = [*turned, *pivots, "gravity=[-9.8, 0]"]
    assert opened(tank(), settings=settings) == []
    assert "open at its side -y;" in opened(tank(right=0.1), settings=settings)[0]


def test_a_scene_without_a_floor_is_open_below(opened):
    assert "open below;" in opened(tank(), settings=["body.floor.enabled=false"])[0]


def test_what_an_outflow_catches_is_not_lost(opened):
    assert opened(tank(right=0.1) + BELOW.format(end='"inf"')) == []
    assert len(opened(tank(right=0.1) + BELOW.format(end=0.5))) == 1


def test_what_gets_nowhere_in_the_run_is_not_lost(opened):
    assert opened(tank(right=0.1), time=0.05) == []


def test_an_inflow_needs_a_floor(opened):
    assert opened(tank() + INFLOW.format(x=0.5)) == []
    found = opened(tank() + INFLOW.format(x=1.5))
    assert len(found) == 1
    assert found[0].startswith("river: the scene is open at its side +x and below;")


def test_a_wall_that_vanishes_holds_nothing(opened):
    gate = tank().replace("[1, 0]\n", "[1, 0]\nmotion = { removed_at = 1 }\n")
    assert "open at its side +x;" in opened(gate)[0]


def test_a_block_falls_beside_the_floor_alone(opened):
    block = BLOCK
    assert opened(tank() + block.format(x=0.9, y=1.0)) == []
    found = opened(tank() + block.format(x=1.5, y=1.6))
    assert found[0].startswith("block: no wall is below it and it falls for ever")
    assert opened(tank() + block.format(x=1.5, y=1.6) + BELOW.format(end='"inf"')) == []


def box(name, low, high, *lines):
    """A table of a box of stone; with `fixed = true` among the lines, a wall."""
    head = f'[body.{name}]\nshape = "box"\nmaterial = "basalt"\nmin = {low}\nmax = {high}\n'
    return head + "\n".join(lines) + "\n"


def post(name, left, right):
    return box(name, [left, -0.3], [right, 0], "fixed = true")


BEAM = box("beam", [-0.5, 0], [0.5, 0.1])
STONE = '[body.stone]\nshape = "disc"\nmaterial = "basalt"\ncentre = [0, 0.2]\nradius = 0.1\n'
ENDS = post("left", -0.52, -0.44) + post("right", 0.44, 0.52)


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
def test_a_beam_lies_on_its_two_ends_and_bears_what_lies_on_it(opened, kind):
    settings = [f'body.beam.kinematics="{kind}"']
    assert opened(ENDS + STONE + BEAM, settings=settings) == []
    assert opened(ENDS + BEAM + STONE, settings=settings) == []


def test_a_beam_does_not_lie_on_one_end(opened):
    found = opened(post("left", -0.52, -0.44) + STONE + BEAM)
    assert [text.split(":")[0] for text in found] == ["stone", "beam"]
    assert "no wall is below it" in found[0]
    assert "what is below it lies on one side of its centre of mass" in found[1]
    assert opened(post("half", -0.52, -0.1) + BEAM) != []
    assert opened(post("more", -0.52, 0.06) + BEAM) == []
    assert opened(post("middle", -0.03, 0.03) + BEAM) == []


def test_walls_beside_a_block_do_not_hold_it(opened):
    shaft = box("left", [-0.4, -1], [-0.1, 1], "fixed = true")
    shaft += box("right", [0.1, -1], [0.4, 1], "fixed = true")
    block = box("block", [-0.1, 0], [0.1, 0.2])
    assert "block: no wall is below it" in opened(shaft + block)[0]
    assert opened(shaft + block + box("foot", [-0.1, -1], [0.1, -0.9], "fixed = true")) == []


CORNERS = [(-0.2, -0.2), (0.14, 0.14), (-0.2, 0.14), (0.14, -0.2)]


@pytest.mark.parametrize(("count", "lies"), [(4, True), (3, True), (2, True), (1, False)])
@pytest.mark.parametrize("first", [0, 2])
def test_a_slab_lies_on_posts_around_its_middle(opened, count, lies, first):
    """In 3-D, on two that are opposite, or more; not on one."""
    corners = (CORNERS[first:] + CORNERS[:first])[:count]
    posts = [
        box(f"post{k}", [x, y, -0.3], [x + 0.06, y + 0.06, 0], "fixed = true")
        for k, (x, y) in enumerate(corners)
    ]
    slab = box("slab", [-0.2, -0.2, 0], [0.2, 0.2, 0.06])
    found = opened("".join(posts) + slab, settings=["dim=3", "gravity=[0, 0, -9.8]"])
    assert (found == []) is lies
    beside = [posts[0], posts[-1]] if count == 3 else posts[:1]
    assert opened("".join(beside) + slab, settings=["dim=3", "gravity=[0, 0, -9.8]"]) != []


def test_grains_count_each(opened):
    grains = GRAINS
    assert opened(tank() + grains.format(x=0.5, y=0.9)) == []
    assert opened(tank() + grains.format(x=1.1, y=1.5))[0].startswith("grains: no wall is below")


def test_nothing_falls_without_gravity_or_along_a_periodic_axis(opened):
    no_floor = ["body.floor.enabled=false"]
    assert opened(tank(), settings=[*no_floor, "gravity=[0, 0]"]) == []
    ends = ["domain_min=[-1, -1]", "domain_max=[2, 1]"]
    assert opened(tank(), settings=[*no_floor, *ends, 'periodic=["y"]']) == []


BED = """
[body.bed]
shape = "box"
material = "aluminium"
fixed = true
min = [{left}, -0.06]
max = [1, 0]
[body.film]
shape = "box"
material = "water"
min = [0, 0]
max = [1, 0.1]
velocity = [3, 0]
"""
PERIOD = ["domain_min=[0, -2]", "domain_max=[1, 2]", 'periodic=["x"]']


def test_a_fast_film_on_a_bed_as_long_as_the_period_comes_down_on_it_again(opened):
    assert opened(BED.format(left=0), settings=PERIOD) == []
    assert "film: the scene is open below;" in opened(BED.format(left=0.2), settings=PERIOD)[0]


def test_a_jet_that_is_thrown_over_the_top_leaves_beside_the_scene(opened):
    jet = ["body.water.velocity=[0, 4]"]
    assert "water: the scene is open at its side -x and +x;" in opened(tank(), settings=jet)[0]
    assert opened(tank(left=1.2, right=1.2), settings=jet) == []
    below = BELOW.format(end='"inf"')
    assert opened(tank() + below, settings=jet) == []


@pytest.mark.parametrize(("name", "dim"), CASES)
def test_no_shipped_scenario_raises_an_alarm(name, dim):
    assert told(name, [f"dim={dim}", *(["dp=0.02"] if dim == 3 and "flume" in name else [])]) == []


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("dry", [False, True])
def test_nor_does_one_to_start_from(tmp_path, dim, dry):
    path = tmp_path / "start.toml"
    path.write_text(start_text(dim, dry))
    assert told(str(path)) == []


def test_a_surge_goes_as_high_as_its_fastest_row(opened):
    surge = "surge = [[0, 0.1, 0.5], [1, 0.03, {fast}]]"
    river = INFLOW.format(x=0.5).replace('rate = "20 L/s"', surge)
    river = river.replace("depth = 0.1\nduration = 1\n", "")
    assert opened(tank() + river.format(fast=1.0)) == []
    assert (
        "river: the scene is open at its side -x and +x;"
        in opened(tank() + river.format(fast=4.0))[0]
    )
