"""The trust report: each verdict turns when the record is bad, and says so where it cannot tell."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.assess.summary import summary_text
from doseki.assess.trust.checks import DEPTH
from doseki.assess.trust.report import trust_checks
from doseki.assess.trust.snapshots import closest_pair, flow_depth
from doseki.assess.trust.verdicts import BAD, DOUBTFUL, GOOD, verdict
from doseki.cli.app import app
from doseki.cli.main import main
from doseki.record.reader import load
from doseki.record.writer import Recorder
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario
from doseki.studies.vary import vary

SCENARIO = """\
schema = 1
dim = 2
dp = 0.1
time_max = 1.0
time_out = 1.0
xi = 0.01
gravity = [0.0, -1.0]
{more}

[parameters.diameter]
value = 0.1
"""
WATER, BASALT = 0, 1
XI_C0 = 14.0  # m/s, of water


def lattice(material: int, columns: int, rows: int, x0: float = 0.0) -> dict[str, np.ndarray]:
    """Particles at rest, 0.1 m apart, at their reference density."""
    x, z = np.meshgrid(np.arange(columns), np.arange(rows))
    n, rho0 = x.size, (1000.0, 2750.0)[material]
    one, none = np.ones(n), np.zeros(n, np.int32)
    state = {"position": 0.1 * np.column_stack([x.ravel(), z.ravel()]) + 0.05 + [x0, 0.0]}
    state |= {"velocity": np.zeros((n, 2)), "density": rho0 * one, "mass": rho0 * 0.01 * one}
    state |= {"pressure": 0 * one, "smoothing_length": 0.12 * one, "sound_speed": XI_C0 * one}
    state |= {"stress": np.zeros((n, 3, 3)), "deviatoric_stress": np.zeros((n, 3, 3))}
    state |= {"material": none + material, "body": none + material, "motion": none}
    return state | {"id": np.arange(n) + 1000 * material}


def joined(*parts: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}


@pytest.fixture
def record(tmp_path):
    """Records a second of free fall, with `change` (state, row) made at its end."""

    def make(change=lambda state, row: None, more="", grains=(4, 2)):
        text = SCENARIO.format(more=more) + "[body.sea]\n[body.grains]\n"
        folder = tmp_path / "run"
        recorder = Recorder(folder, text, ["water", "basalt"], ["sea", "grains"], 2, overwrite=True)
        for time in (0.0, 1.0):
            state = joined(lattice(WATER, 40, 12), lattice(BASALT, *grains, x0=6.0))
            speed = -time
            state["velocity"][:, 1] = speed
            mass = state["mass"].sum()
            state["position"][:, 1] -= 0.5 * time**2
            row = {"time": time, "mass": mass, "momentum_x": 0.0, "momentum_y": mass * speed}
            row |= {"kinetic_energy": 0.5 * mass * speed**2, "bulk_energy": 0.0}
            row |= {"shear_energy": 0.0, "av_dissipation": 0.0, "mass_left": 0.0}
            if time:
                change(state, row)
            recorder.snapshot(state, time=time, step=int(time), dt=0.1)
            recorder.history(row)
        return load(folder)

    return make


def verdicts(run):
    return {check.name: check.verdict for check in trust_checks(run)}


def test_a_free_fall_is_good(record):
    found = trust_checks(record())
    assert [check.verdict for check in found] == [GOOD] * 6
    assert all(check.remedy == "" for check in found)


def fast(factor, of=slice(0, 12)):
    def change(state, row):
        state["velocity"][of] = [factor * XI_C0, 0.0]

    return change


COMPRESSED = slice(0, 480)


def dense(factor, of=COMPRESSED):
    def change(state, row):
        state["density"][of] *= factor

    return change


def energy(share):
    def change(state, row):
        row["av_dissipation"] += share * row["kinetic_energy"]

    return change


def momentum(share):
    def change(state, row):
        row["momentum_x"] += share * row["mass"]

    return change


def close(spacings):
    def change(state, row):
        state["position"][-1] = state["position"][-2] + [0.1 * spacings, 0.0]

    return change


@pytest.mark.parametrize(
    ("name", "change", "doubtful", "bad"),
    [
        ("Mach number", fast, 0.2, 0.4),
        ("density fluctuation", dense, 1.02, 1.06),
        ("energy balance", energy, 0.02, 0.1),
        ("energy balance", energy, -0.02, -0.1),
        ("momentum", momentum, 1e-4, 1e-2),
        ("closest approach", close, 0.4, 0.2),
    ],
)
def test_a_bad_record_turns_its_own_verdict(record, name, change, doubtful, bad):
    for value, expected in ((doubtful, DOUBTFUL), (bad, BAD)):
        found = trust_checks(record(change(value)))
        turned = {check.name: check.verdict for check in found if check.verdict != GOOD}
        assert turned == {name: expected}
        assert all(check.remedy for check in found if check.name == name)


@pytest.mark.parametrize(("rows", "expected"), [(12, "good"), (7, "doubtful"), (3, "bad")])
def test_depth_of_columns(rows, expected):
    state = lattice(WATER, 40, rows)
    spray = [lattice(WATER, 1, 1, x0=20.0 + drop) for drop in range(15)]
    both = joined(state, *spray)
    depth = flow_depth(both["position"], both["mass"] / 1000.0, 0.1)
    assert depth == pytest.approx(rows)
    assert verdict(depth, DEPTH) == expected


def test_expansion_of_a_clamped_fluid_does_not_count_but_that_of_a_solid_does(record):
    assert verdicts(record(dense(0.5)))["density fluctuation"] == "good"
    solid = dense(0.5, slice(480, None))
    assert verdicts(record(solid))["density fluctuation"] == "bad"
    free = record(dense(0.5), more='tension = "free"')
    assert verdicts(free)["density fluctuation"] == "bad"


def test_what_is_not_a_number_is_bad(record):
    assert verdicts(record(fast(np.nan, 0)))["Mach number"] == "bad"


def test_one_drop_does_not_judge_the_flow_but_is_kept(record):
    drop = {check.name: check for check in trust_checks(record(fast(0.5, 0)))}["Mach number"]
    assert drop.verdict == GOOD
    assert drop.details["highest"] == pytest.approx(0.5)


def test_what_the_record_cannot_tell_is_not_available(record):
    def wall(state, row):
        state["motion"][:40] = 1

    def left(state, row):
        row["mass_left"] = 1.0

    assert verdicts(record(wall))["momentum"] == "not available"
    for given in ({"change": left}, {"more": "[inflow.source]\nrate = 1"}):
        found = verdicts(record(**given))
        assert found["energy balance"] == found["momentum"] == "not available"
    periodic = record(more='periodic = ["y"]\ndomain_min = [0, 0]\ndomain_max = [9, 9]')
    assert verdicts(periodic)["energy balance"] == "not available"


RESOLVED = 'scheme = "resolved"'


def test_the_resolved_scheme_has_tension_but_not_on_its_surface(record):
    """No pressure below rho0: the free surface; the record tells it by a pressure of zero."""

    def stretched(state, row):
        dense(0.9)(state, row)
        state["pressure"][:480] = -1e4

    assert verdicts(record(dense(0.9), more=RESOLVED))["density fluctuation"] == "good"
    assert verdicts(record(stretched, more=RESOLVED))["density fluctuation"] == "bad"
    assert verdicts(record(stretched))["density fluctuation"] == "good"
    assert verdicts(record(dense(1.02), more=RESOLVED))["density fluctuation"] == "doubtful"


def test_walls_that_take_or_give_energy_leave_the_balance_unknown(record):
    def belt(state, row):
        state["motion"][:40] = 1

    def wall(state, row):
        belt(state, row)
        state["velocity"][:40] = 0.0

    for bed, unknown in (("rough", True), ("no_slip", False)):
        body = f'{RESOLVED}\n[body.bed]\nwall = "{bed}"\nks = 0.01'
        found = verdicts(record(wall, more=body))["energy balance"]
        assert (found == "not available") == unknown
    for scheme in (RESOLVED, ""):
        assert verdicts(record(belt, more=scheme))["energy balance"] == "not available"


@pytest.mark.parametrize(("share", "expected"), [(1e-4, "good"), (5e-3, "doubtful"), (0.1, "bad")])
def test_shifting_is_allowed_some_momentum(record, share, expected):
    found = verdicts(record(momentum(share), more=RESOLVED))
    assert {found.pop("momentum"), *found.values()} == {expected, "good"}


def test_nearest_pair_is_that_of_all_pairs():
    points = np.random.default_rng(1).uniform(size=(60, 3))
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 9 * np.eye(60)
    assert closest_pair(points) == pytest.approx(gaps.min())


def test_the_closest_of_very_many_grains_are_found(record):
    checks = {check.name: check for check in trust_checks(record(grains=(30_000, 1)))}
    assert checks["closest approach"].value == pytest.approx(1.0)


def test_a_collision_is_judged_at_its_end(tmp_path):
    run_scenario(load_scenario("collision"), tmp_path / "run", RunOptions(threads=1))
    run = load(tmp_path / "run")
    checks = {check["name"]: check for check in run.trust["checks"]}
    assert checks["Mach number"]["value"] == pytest.approx(0.1)
    assert checks["energy balance"]["value"] < 1e-4
    assert checks["momentum"]["value"] < 1e-12
    assert checks["closest approach"]["value"] > 1.0
    assert checks["particles per flow depth"]["verdict"] == "not available"
    assert "Mach number 0.1" in summary_text(run)
    quick = load_scenario("collision", ["speed=24", "xi=0.0192"])
    run_scenario(quick, tmp_path / "quick", RunOptions(threads=1))
    assert load(tmp_path / "quick").trust["verdict"] == "bad"


def test_half_and_double_xi(tmp_path, capsys):
    folder = tmp_path / "out"
    arguments = ["trust", "collision", "--vary", "xi", "--threads", "1", "-o", str(folder)]
    app([*arguments, "--set", "particles_per_grain=1", "--json"], standalone_mode=False)
    report = json.loads(capsys.readouterr().out)
    assert np.array(report["values"]) / report["values"][1] == pytest.approx([0.5, 1, 2])
    moved = {entry["name"]: entry["moved_percent"] for entry in report["quantities"]}
    half, double = moved["kinetic_energy"]
    assert -5 < half < -0.5 < 0.5 < double < 5
    assert np.abs(moved["momentum_x"]).max() < 1e-6
    assert "momentum_y" not in moved
    for part in ("half", "base", "double"):
        assert (folder / part / "trust.json").is_file()


COLUMN = """\
dim = 2
dp = 0.02
time_max = 0.1
time_out = 0.02
scheme = "resolved"
{speed}
gravity = [0, -9.8]

[body.floor]
shape = "box"
material = "aluminium"
fixed = true
wall = "{wall}"
ks = 0.01
min = [-0.4, -0.06]
max = [0.6, 0]

[body.water]
shape = "box"
material = "water"
min = [0, 0]
max = [0.2, 0.2]
velocity = ["= 0.1*{key}", 0]
"""
DROP = """\
dim = 2
dp = 0.02
time_max = 0.2
time_out = 0.02
scheme = "resolved"
speed_max = 1

[body.water]
shape = "disc"
material = "water"
centre = [0, 0]
radius = 0.2
velocity = ["= x + 0.5", "= -y"]
"""


def column(folder, key="speed_max", wall="no_slip"):
    """A scenario file: a column of water falls on a floor; its start depends on `key`."""
    text = COLUMN.format(speed=f"{key} = 2", wall=wall, key=key)
    (folder / "column.toml").write_text(text)
    return str(folder / "column.toml")


def judged(name, folder):
    """The checks of a run of a scenario, by name."""
    run_scenario(load_scenario(name), folder / "run", RunOptions(threads=1))
    return {check["name"]: check for check in load(folder / "run").trust["checks"]}


def test_a_drop_of_the_resolved_scheme_is_judged(tmp_path):
    (tmp_path / "drop.toml").write_text(DROP)
    checks = judged(str(tmp_path / "drop.toml"), tmp_path)
    judgement = {name: check["verdict"] for name, check in checks.items()}
    assert judgement.pop("particles per flow depth") == "not available"
    assert judgement.pop("closest approach") == "not available"
    assert set(judgement.values()) == {"good"}
    assert "corrections of the scheme gave" in checks["energy balance"]["counted"]
    assert "both signs inside" in checks["density fluctuation"]["counted"]


def test_a_column_of_the_resolved_scheme_is_judged(tmp_path):
    checks = judged(column(tmp_path), tmp_path)
    assert checks["Mach number"]["verdict"] == "good"
    assert checks["energy balance"]["value"] < 0.1
    assert checks["particles per flow depth"]["value"] == pytest.approx(10, rel=0.2)
    rough = tmp_path / "rough"
    rough.mkdir()
    checks = judged(column(rough, wall="rough"), rough)
    assert checks["energy balance"]["value"] < 0.1


@pytest.mark.parametrize("key", ["speed_max", "xi_height"])
def test_xi_is_varied_where_it_follows_from_something_else(key, tmp_path):
    """What is given stays, since expressions may use it; only the sound speed changes."""
    report = vary(column(tmp_path, key), ["time_max=0.02"], "xi", tmp_path / "out", 1)
    assert np.array(report["values"]) / report["values"][1] == pytest.approx([0.5, 1, 2])
    runs = [load(folder) for folder in report["directories"]]
    sound = [run[0]["sound_speed"][run[0]["motion"] == 0].max() for run in runs]
    assert np.array(sound) / sound[1] == pytest.approx([0.5, 1, 2])
    assert [run[0]["velocity"].max() for run in runs] == pytest.approx([0.2] * 3)
    moved = {entry["name"]: entry["moved_percent"] for entry in report["quantities"]}
    assert np.abs(moved["water: mean speed"]).max() < 20


def test_only_xi_can_be_varied(tmp_path):
    with pytest.raises(SystemExit) as stopped:
        main(["trust", "collision", "--vary", "dp", "-o", str(tmp_path / "out")])
    assert stopped.value.code == 2
    assert not (tmp_path / "out").exists()


BODIES = """
dim = 2
dp = 0.1
time_max = 0.1
time_out = 0.05
scheme = "resolved"
speed_max = 5
gravity = [0, -9.81]
[contact]
speed = {speed}
[body.floor]
shape = "box"
material = "aluminium"
fixed = true
min = [-1, -0.5]
max = [2, 0]
[body.stone]
shape = "disc"
material = "basalt"
centre = [0.4, 0.3]
radius = 0.3
velocity = [0, -2]
[body.water]
shape = "box"
material = "water"
min = [-1, 0]
max = [2, 0.5]
"""


@pytest.mark.parametrize(("speed", "found"), [(5, GOOD), (0.05, BAD)])
def test_a_run_with_bodies(tmp_path, speed, found):
    """It ends, and contacts too soft for its speeds are told."""
    (tmp_path / "stone.toml").write_text(BODIES.format(speed=speed), encoding="utf-8")
    run_scenario(load_scenario(str(tmp_path / "stone.toml")), tmp_path / "run")
    run = load(tmp_path / "run")
    checks = {check.name: check for check in trust_checks(run)}
    assert checks["overlap of contacts"].verdict == found
    assert checks["momentum"].value < 0.02
    assert len(run[-1].grains["overlap"]) == 1
