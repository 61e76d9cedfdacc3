"""`--device`: which device a run takes, and what it says of that."""

from __future__ import annotations

import subprocess
import sys

import pytest

from doseki.cli.main import main
from doseki.compiled import Card, available_instruction_sets, card_here
from doseki.driver.ranks import OneRank
from doseki.running import devices
from doseki.running.devices import FEWEST, card_doubts, choose_device, count_of_scene

from ..small_scenarios import BLOCK, MINIMAL


class SecondRank(OneRank):
    rank_on_machine = 1


class CoreOfCard:
    __name__ = "doseki._core_cuda"

    def __init__(self):
        self.cards = []

    def use_card(self, k):
        self.cards.append(k)


@pytest.fixture
def machine(monkeypatch):
    """A machine with a card: what has been used of it, and what was said."""
    core, used, said = CoreOfCard(), [], []
    monkeypatch.delenv("DOSEKI_ISA", raising=False)
    monkeypatch.setattr(devices, "card_here", lambda: Card("card of 80 GB", 80e9))
    monkeypatch.setattr(devices, "use_device", used.append)
    monkeypatch.setattr(devices, "load_core", lambda: core)
    return core, used, said


@pytest.mark.parametrize("count", [1, FEWEST - 1, FEWEST, 10 * FEWEST])
def test_a_card_is_taken_where_it_is_worth_it(machine, count):
    core, used, said = machine
    choose_device("auto", lambda: count, SecondRank(), said.append)
    large = count >= FEWEST
    assert used == ["cuda" if large else "cpu"]
    assert core.cards == ([1] if large else [])
    (sentence,) = said
    assert "card of 80 GB" in sentence
    assert ("--device cuda" in sentence) is not large


def test_whoever_names_a_device_gets_it(machine):
    core, used, said = machine
    for name in ("cpu", "host", "cuda"):
        choose_device(
            name, lambda: pytest.fail("nobody asks for the count"), OneRank(), said.append
        )
    assert (used, core.cards, said) == (["cpu", "host", "cuda"], [0], [])


def test_a_module_that_the_environment_names_stays(machine, monkeypatch):
    _, used, said = machine
    monkeypatch.setenv("DOSEKI_ISA", "scalar")
    choose_device("auto", lambda: 10**7, OneRank(), said.append)
    assert (used, said) == (["cpu"], [])


def test_a_run_that_does_not_fit_on_the_card_is_told(machine):
    assert card_doubts(79e9) == []
    (doubt,) = card_doubts(81e9)
    assert "takes 81 GB and the card of 80 GB has 80 GB" in doubt


def test_without_a_card_nothing_is_counted(monkeypatch):
    monkeypatch.delenv("DOSEKI_ISA", raising=False)
    monkeypatch.setattr(devices, "card_here", lambda: None)
    never = pytest.fail
    choose_device("auto", lambda: never("counted"), OneRank(), never)


def test_the_count_is_that_of_the_scene(write):
    from doseki.scenario.load import load_scenario
    from doseki.solver.build import build_simulation

    scenario = load_scenario(write())
    assert count_of_scene(scenario) == len(build_simulation(scenario)[0])


@pytest.mark.skipif(card_here() is not None, reason="there is a card")
@pytest.mark.skipif("device" not in available_instruction_sets(), reason="not built for devices")
def test_check_tries_the_code_of_a_card_without_one(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(f"{MINIMAL}\n{BLOCK}")
    command = [sys.executable, "-m", main.__module__, "check", str(path), "--device", "cuda"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "there is no graphics card here" in done.stderr
    for line in ("state", "updates", "steps"):
        assert line in done.stdout
