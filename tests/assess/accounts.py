"""Runs of scenarios and what their accounts of energy say, with columns of the history left out."""

from __future__ import annotations

import dataclasses

import numpy as np

from doseki.assess.trust.ledger import ledger_of
from doseki.record.reader import load
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario


def recorded(folder, text, *settings, threads=1):
    """The record of a run of this scenario."""
    folder.mkdir(exist_ok=True)
    (folder / "case.toml").write_text(text)
    scenario = load_scenario(str(folder / "case.toml"), list(settings))
    run_scenario(scenario, folder / "run", RunOptions(threads=threads))
    return load(folder / "run")


def gap(ledger):
    """By how much the account is open at most, over its largest term."""
    return np.max(np.abs(ledger.energy_residual())) / ledger.largest


class WithColumns:
    """A run with some columns of the history replaced."""

    def __init__(self, run, **columns):
        self.scenario, self.history = run.scenario, dict(run.history) | columns


def without(run, name):
    """The account of a run without a column of its history."""
    zeros = {name: np.zeros(len(run.history["time"]))}
    return dataclasses.replace(ledger_of(run), run=WithColumns(run, **zeros))
