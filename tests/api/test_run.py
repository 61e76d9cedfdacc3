"""Runs from Python: what looks on changes nothing, what stops them loses nothing, all is local."""

from __future__ import annotations

import os
import signal
import threading
import warnings
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import doseki
from doseki.compiled import load_core
from doseki.driver.live import Watch
from doseki.driver.ranks import OneRank
from doseki.running.runner import RunOptions

from ..run.channel import assert_same_record
from ..small_scenarios import BLOCK, MINIMAL

QUIET = {"threads": 1, "progress": False}


class Looks:
    """A callback that keeps what it sees, and answers with False at a time, s."""

    def __init__(self, stop_at=float("inf")):
        self.stop_at = stop_at
        self.times, self.steps, self.views, self.totals = [], [], [], []

    def __call__(self, view):
        self.times.append(view.time)
        self.steps.append(view.step)
        self.views.append({key: view[key] for key in view})
        self.totals.append(view.totals)
        return view.time < self.stop_at


@pytest.mark.parametrize("often", [{"every": 0.0031}, {"every_steps": 7}, {}], ids=str)
def test_a_run_that_is_looked_at_has_the_same_bits(channel, plain, tmp_path, often):
    looks = Looks()
    run = doseki.run(channel, tmp_path / "run", callback=looks, **often, **QUIET)
    assert_same_record(run.directory, plain)
    assert run.summary["neighbour_rebuilds"] == doseki.load(plain).summary["neighbour_rebuilds"]
    assert looks.times[0] == 0
    if "every_steps" in often:
        assert looks.steps[1:] == list(range(7, run.summary["step"] + 1, 7))
    else:
        every = often.get("every", channel["time_out"])
        due = every * np.arange(1, int(channel["time_max"] / every + 1e-9) + 1)
        late = np.array(looks.times[1:]) - due
        assert len(late) == len(due)
        assert np.all((late > -1e-12) & (late <= run.history["dt"].max()))


def test_it_sees_what_the_record_has(channel, tmp_path):
    looks = Looks()
    run = doseki.run(channel, tmp_path / "run", callback=looks, **QUIET)
    compared = 0
    for time, view in zip(looks.times, looks.views, strict=True):
        if time not in run.times:
            continue
        snapshot = run.at(time)
        compared += 1
        for key in snapshot:
            assert np.array_equal(view[key], snapshot[key]), key
            assert not view[key].flags.writeable
    assert compared >= 2
    assert looks.totals[-1]["mass_left"] == run.history["mass_left"][-1] > 0


def test_a_view_ends_with_its_callback(channel, tmp_path):
    kept = []
    run = doseki.run(
        channel.changed(time_max=0.001), tmp_path / "run", callback=kept.append, **QUIET
    )
    assert run.summary["status"] == "done"
    with pytest.raises(RuntimeError, match="the run has gone on since 0 s"):
        kept[0]["velocity"]


def test_a_field_that_there_is_not(channel, tmp_path):
    def look(view):
        view["velocty"]

    with pytest.raises(KeyError, match="did you mean velocity"):
        doseki.run(channel, tmp_path / "run", callback=look, **QUIET)


def test_false_stops_it_and_resume_goes_on_to_the_same_bits(channel, plain, tmp_path):
    looks = Looks(stop_at=0.02)
    run = doseki.run(channel, tmp_path / "run", callback=looks, every_steps=5, **QUIET)
    assert (run.summary["status"], run.summary["stopped_by"]) == ("stopped", "the callback")
    assert looks.times[-2] < 0.02 <= looks.times[-1] == run.times[-1]
    again = Looks()
    run = doseki.resume(run.directory, callback=again, every_steps=5, **QUIET)
    assert run.summary["status"] == "done"
    assert "stopped_by" not in run.summary
    assert again.times[0] == looks.times[-1]
    assert_same_record(run.directory, plain)


def test_it_stops_before_its_first_step(channel, plain, tmp_path):
    run = doseki.run(channel, tmp_path / "run", callback=Looks(stop_at=0), **QUIET)
    assert (run.summary["status"], run.summary["step"]) == ("stopped", 0)
    assert_same_record(doseki.resume(run.directory, **QUIET).directory, plain)


def test_a_run_that_is_stopped_at_its_end_is_done(channel, tmp_path):
    short = channel.changed(time_max=0.01)
    run = doseki.run(short, tmp_path / "run", callback=Looks(stop_at=0.01), every=0.005, **QUIET)
    assert run.summary["status"] == "done"
    assert len(np.unique(run.times)) == len(run.times)


def test_an_error_in_the_callback_closes_the_record(channel, plain, tmp_path):
    def look(view):
        if view.time > 0.02:
            raise LookupError("nothing to see")

    with pytest.raises(LookupError, match="nothing to see"):
        doseki.run(channel, tmp_path / "run", callback=look, every_steps=3, **QUIET)
    run = doseki.load(tmp_path / "run")
    assert run.summary["status"] == "stopped"
    assert "LookupError" in run.summary["stopped_by"]
    assert_same_record(doseki.resume(run.directory, **QUIET).directory, plain)


def test_resume_takes_changes(channel, tmp_path):
    run = doseki.run(channel.changed(time_max=0.01), tmp_path / "run", **QUIET)
    run = doseki.resume(run.directory, {"time_max": "0.02 s"}, **QUIET)
    assert run.times[-1] == 0.02
    with pytest.raises(doseki.UserError, match="dp cannot change"):
        doseki.resume(run.directory, {"dp": 0.02}, **QUIET)


def test_ctrl_c_leaves_a_record_that_can_be_resumed(channel, plain, tmp_path):
    def look(view):
        if view.time > 0.02:
            os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            doseki.run(channel, tmp_path / "run", callback=look, every_steps=3, **QUIET)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    run = doseki.load(tmp_path / "run")
    assert (run.summary["status"], run.summary["stopped_by"]) == ("stopped", "SIGINT")
    assert_same_record(doseki.resume(run.directory, **QUIET).directory, plain)


def state_of_the_process():
    """What a run might leave changed."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    return {
        "folder": Path.cwd(),
        "signals": [signal.getsignal(number) for number in numbers],
        "threads of the core": load_core().threads(),
        "backend": mpl.rcParams["backend"],
        "matplotlib": dict(mpl.rcParams),
        "warnings": list(warnings.filters),
        "random": np.random.get_state()[1].tolist(),  # noqa: NPY002 (the global one is meant)
        "errors": np.geterr(),
        "environment": dict(os.environ),
        "python threads": threading.active_count(),
    }


def test_nothing_of_the_process_is_changed(channel, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    load_core()
    from matplotlib import pyplot

    pyplot.close(pyplot.figure())  # the user's own, which chooses the backend
    before = state_of_the_process()
    run = doseki.run(channel.changed(time_max=0.02), callback=Looks(), progress=False, threads=3)
    run.plot("speed")
    run.figure("overview")
    channel.check(threads=2)
    with pytest.raises(doseki.UserError):
        doseki.run(channel, run.directory, progress=False)
    after = state_of_the_process()
    for name, value in before.items():
        assert after[name] == value, name
    assert run.directory == Path("runs/scenario")
    assert doseki.run(channel, callback=Looks(0), progress=False).directory.name == "scenario-2"
    pyplot.close("all")


def test_two_runs_at_once_have_the_bits_of_each_alone(channel, plain, tmp_path):
    other = doseki.Scenario("collision")
    alone = doseki.run(other, tmp_path / "alone", **QUIET).directory
    done = {}

    def work(name, scenario, threads):
        folder = tmp_path / name
        run = doseki.run(scenario, folder, threads=threads, progress=False, callback=Looks())
        done[name] = run.directory

    jobs = {"a": (channel, 1), "b": (other, 2), "c": (channel, 2), "d": (other, 1)}
    threads = [threading.Thread(target=work, args=(name, *job)) for name, job in jobs.items()]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name, expected in {"a": plain, "b": alone, "c": plain, "d": alone}.items():
        assert_same_record(done[name], expected)


def test_what_is_doubtful_comes_as_a_warning_at_the_users_line(tmp_path):
    (tmp_path / "case.toml").write_text(MINIMAL + BLOCK)
    scenario = doseki.Scenario(tmp_path / "case.toml", time_max=0.0001, time_out=0.0001)
    assert scenario.check(threads=1).warnings
    with pytest.warns(doseki.DosekiWarning) as said:
        doseki.run(scenario, tmp_path / "run", **QUIET)
    assert {warning.filename for warning in said} == {__file__}


def test_a_run_takes_what_a_scenario_is_made_of(tmp_path):
    run = doseki.run("collision", tmp_path / "a", callback=Looks(0), **QUIET)
    assert run.scenario["title"].startswith("Two basalt grains")
    again = doseki.run(run.directory / "scenario.toml", tmp_path / "b", callback=Looks(0), **QUIET)
    assert again.scenario["body"] == run.scenario["body"]


OPTIONS = {
    "threads": [0, 1.5, True, "two", 10**6],
    "every": [0, -1, float("nan"), float("inf"), "1 s", True],
    "every_steps": [0, 1.5],
    "callback": [3],
    "checkpoint_every": [0, "x"],
    "checkpoint_minutes": [-1, float("nan")],
}


@pytest.mark.parametrize(
    ("name", "value"), [(name, value) for name, values in OPTIONS.items() for value in values]
)
def test_options_that_mean_nothing_are_refused(channel, tmp_path, name, value):
    options = {"callback": Looks()} | {"progress": False} | {name: value}
    with pytest.raises(doseki.UserError, match=rf"{name} = .*; allowed: "):
        doseki.run(channel, tmp_path / "run", **options)
    assert not (tmp_path / "run").exists()


def test_a_callback_is_for_one_rank():
    class TwoRanks(OneRank):
        count = 2

    with pytest.raises(doseki.UserError, match="on several ranks"):
        RunOptions(ranks=TwoRanks(), watch=Watch(Looks(), 1.0))


def test_numbers_of_numpy_are_options(channel, tmp_path):
    looks, options = Looks(), {"threads": np.int64(1), "every": np.float32(0.01), "progress": False}
    doseki.run(channel.changed(time_max=0.02), tmp_path / "run", callback=looks, **options)
    assert len(looks.times) == 3


def test_every_needs_a_callback(channel, tmp_path):
    with pytest.raises(doseki.UserError, match="give a callback"):
        doseki.run(channel, tmp_path / "run", every=0.1)


def test_a_callback_that_may_look_less_often_is_warned_of(tmp_path):
    """Steps of bodies alone may go from one row of the history to the next."""
    scenario = doseki.Scenario(
        {
            "dim": 2, "dp": 0.01, "scheme": "resolved", "xi": 0.01, "gravity": [0, 0],
            "time_max": 0.2, "time_out": 0.2, "time_history": 0.02,
            "body": {
                "a": {
                    "shape": "disc", "material": "basalt", "centre": [0, 0], "radius": 0.05,
                    "velocity": [1, 0],
                }
            },
        }
    )  # fmt: skip
    looks = Looks()
    with pytest.warns(doseki.DosekiWarning, match="give time_history = 0.01"):
        doseki.run(scenario, tmp_path / "often", callback=looks, every=0.01, **QUIET)
    assert len(looks.times) == 11
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "every =")
        doseki.run(scenario, tmp_path / "run", callback=Looks(), every=0.02, **QUIET)
