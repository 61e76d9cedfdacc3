"""--set reaches top-level keys, parameters and dotted paths, and says what it cannot reach."""

import pytest

from doseki.scenario.load import load_scenario

from ..small_scenarios import BLOCK

PARAMETERS = """
[parameters]
length = { value = 2, min = 1, unit = "m" }
lid = false
rate = "3 L/s"
"""


def test_each_kind_of_key(write):
    path = write('xi = "= length/10"', PARAMETERS + BLOCK)
    scenario = load_scenario(
        path,
        [
            "alpha=0.5",
            "length=4",
            "body.block.velocity=[1, 0]",
            "material.water.rho0=998",
            "hdp=1.3",
            "rate=2 L/s",
            "lid=true",
            'title="hello"',
            "time_max==2*time_out",
        ],
    )
    assert (scenario.alpha, scenario.xi, scenario.eta) == (0.5, 0.4, 1.3)
    assert scenario.body["block"].velocity == [1, 0]
    assert scenario.materials["water"].rho0 == 998
    assert scenario.constants["rate"] == 0.002
    assert scenario.constants["lid"] is True
    assert (scenario.title, scenario.time_max) == ("hello", 0.2)


def test_tables_in_the_tables_of_parts(write):
    array = BLOCK + "array = { count = [2, 1], step = [10, 0] }\n"
    path = write("", array)
    assert len(load_scenario(path, ["body.block.array.count=[2, 2]"]).body) == 4
    assert len(load_scenario(path, ["body.block.array.step=[11, 0]"]).body) == 2
    given = ["body.block.array.mirror=x", "body.block.array.at=-4"]
    mirrored = load_scenario(write(), given)
    assert len(mirrored.body) == 2
    turned = load_scenario(path, ["body.block.array={ turns = 3, about = [9, 9], angle = 20 }"])
    assert len(turned.body) == 3


def test_a_key_replaces_its_rival(write):
    scenario = load_scenario(write("xi = 0.1\nslope = 20"), ["xi_height=2", "gravity=[0, -1]"])
    assert scenario.xi == pytest.approx(10 * (2 * 1 * 2) ** 0.5 / 1400)
    assert scenario.slope is None


WINDOWS = """
[window.v]
min = [0, 0]
max = [1, 1]

[window.w]
min = [0, 0]
max = [2, 2]
"""
SHOWN = (
    WINDOWS
    + """
[figure.f]
kind = "profile"
"""
)


@pytest.mark.parametrize(
    ("override", "part"),
    [
        ("alpha", "--set alpha: expected key=value"),
        ("=1", "expected key=value"),
        ("lenght=3", "--set lenght: not a key of this scenario; did you mean length?"),
        ("DP=0.2", "--set DP: not a key of this scenario; did you mean dp?"),
        ("length=long", "--set length: length = 'long' must be a number"),
        ("length=0", "--set length: parameters.length: 0 is out of range; must be 1 m or more"),
        ("lid=1", "lid = 1 must be true or false"),
        ("alpha=-1", "--set alpha: alpha = -1 is out of range"),
        ("xi=60:3116", 'must be a number, or an expression such as "= 2*dp"'),
        ("body.blok.velocity=[0, 0]", "no table body.blok; did you mean body.block?"),
        ("bodi.block.velocity=[0, 0]", "no table bodi; did you mean body?"),
        ("body.block.velocty=[0, 0]", "body.block.velocty is not a known key; did you mean veloc"),
        ("body.block=3", "expected body.block.KEY=value"),
        ("body.block.arrai.count=3", "no table body.block.arrai; did you mean body.block.array?"),
        ("body.block.velocity.x=3", "no table body.block.velocity"),
        ("body.block.array.count=[2, 1]", "count goes with step, which is missing"),
        ("body.block.array.cuont=3", "did you mean count?"),
        ("body.block.array.count.x=3", "expected body.block.KEY=value"),
        (
            "body.block.shape=blob",
            '--set body.block.shape: body.block.shape = "blob" is not a shape',
        ),
        ("figure.f.kind=foo", '--set figure.f.kind: figure.f.kind = "foo" is not a kind'),
        ("body.block.velocity=[0, 0, 1]", "--set body.block.velocity: body.block.velocity"),
        ("window.w.max=[-1, 1]", "--set window.w.max: window.w: every entry of min must be below"),
        ("material.watr.rho0=1", "did you mean material.water?"),
        ("dp=1" + "0" * 400, "--set dp: dp = 1000"),
    ],
)
def test_refusal(write, error_of, override, part):
    assert part in error_of(write(tables=PARAMETERS + BLOCK + SHOWN), override)


@pytest.mark.parametrize("given", ["window.v.max=[3, 3]", "window.w.title=max", "dp=0.05"])
def test_what_a_change_has_nothing_to_do_with_is_of_the_file(write, error_of, given):
    path = write(tables=BLOCK + WINDOWS.replace("[2, 2]", "[-2, 2]"))
    said = error_of(path, given)
    assert said.startswith(f"{path}, line ")
    assert "window.w: every entry of min must be below that of max" in said


@pytest.mark.parametrize("given", ["nan", "inf", "[0.1, 0.2]", "0", "true"])
def test_a_key_is_blamed_itself_and_not_what_uses_it(write, error_of, given):
    tables = '[parameters]\nside = "= round(1/dp)*dp"\n' + BLOCK
    assert error_of(write(tables=tables), f"dp={given}").startswith("--set dp: dp = ")
