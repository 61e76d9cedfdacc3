"""How many threads step a run while others want the cores."""

from __future__ import annotations

from doseki.driver.threads import FIRST_PATIENCE, WINDOW, ThreadChoice
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from ..run.channel import assert_same_record, channel_text


def stepped(choice, windows, speed, cores):
    """Threads taken in each of some windows; `speed` and `cores` say what a count of them gets."""
    counts = []
    for _ in range(windows):
        counts.append(choice.count)
        rate = speed(choice.count)
        choice.spent(int(rate * WINDOW) + 1, WINDOW, cores(choice.count) * WINDOW)
    return counts


def choice_of(most):
    """A choice, and what it has set."""
    taken = []
    return ThreadChoice(most, taken.append), taken


def test_all_are_taken_while_the_cores_are_there():
    choice, taken = choice_of(8)
    assert set(stepped(choice, 100, lambda n: 100 * n, lambda n: 0.9 * n)) == {8}
    assert taken == []


def test_fewer_are_taken_where_they_are_faster_and_all_are_tried_again():
    choice, taken = choice_of(2)
    counts = stepped(choice, 200, lambda n: 170 if n == 1 else 100, lambda n: 0.33)
    assert counts[:2] == [2, 1]
    assert counts.count(1) > 0.95 * 200
    assert counts.count(2) >= 3
    assert set(taken) == {1, 2}
    # The others leave: all are taken again, for good.
    counts = stepped(choice, 600, lambda n: 100 * n, lambda n: n)
    assert counts[-1] == 2
    assert set(counts[counts.index(2) :]) == {2}


def test_all_are_kept_where_fewer_are_slower():
    """A machine of which others take most, evenly: threads still help."""
    choice, _ = choice_of(16)
    counts = stepped(choice, FIRST_PATIENCE, lambda n: 100 * n, lambda n: 0.4 * n)
    assert counts[:3] == [16, 6, 16]
    assert counts.count(16) == FIRST_PATIENCE - 1


def test_results_do_not_depend_on_it(tmp_path, monkeypatch):
    """A run whose number of threads changes all the time has the record of any other one."""
    file = tmp_path / "channel.toml"
    file.write_text(channel_text())
    scenario = load_scenario(file, ["time_max=0.02"])
    run_scenario(scenario, tmp_path / "one", RunOptions(threads=1))
    counts = []

    def restless(choice, *_):
        counts.append(choice.count)
        choice._set(1 + len(counts) % 3)

    monkeypatch.setattr(ThreadChoice, "spent", restless)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    run_scenario(scenario, tmp_path / "many", RunOptions())
    assert len(counts) > 2
    assert_same_record(tmp_path / "many", tmp_path / "one")
