"""The tables of a study file: keys, bounds, defaults."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from ...scenario.table import Table

MOST_RUNS = 100_000
MOST_VALUES = 10_000

Number = float | str  # a string names its unit, as in a scenario


class Vary(Table):
    """What one key of the scenario is given: a range, or a list."""

    min: Number | None = Field(None, description="least value, a number or such as '3 L/s'")
    max: Number | None = Field(None, description="greatest value")
    scale: Literal["linear", "log"] = Field("linear", description="how a range is divided")
    count: int | None = Field(
        None, ge=1, le=MOST_VALUES, description="points of a range on a grid, ends included"
    )
    values: list[float | int | str | bool] | None = Field(
        None, min_length=1, max_length=MOST_VALUES, description="in place of a range"
    )


class Sample(Table):
    """At which points runs are made."""

    kind: Literal["grid", "latin_hypercube", "sobol"] = Field(description="of the sample")
    count: int | None = Field(
        None, ge=1, le=MOST_RUNS, description="number of runs; a grid has those of its axes"
    )
    seed: int | None = Field(None, ge=0, le=2**32 - 1, description="of random numbers; default: 0")


class Calibrate(Table):
    """How the values are sought at which runs are nearest to the observations."""

    method: Literal["differential_evolution", "dual_annealing", "shgo"] = Field(
        description="of scipy.optimize"
    )
    max_runs: int = Field(
        100, ge=1, le=MOST_RUNS,
        description="after which it ends; those of [sample] come before and are not counted",
    )  # fmt: skip
    population: int | None = Field(
        None, ge=5, le=10_000, description="differential_evolution: runs of a generation; default 8"
    )
    tolerance: float | None = Field(
        None, gt=0, lt=1,
        description="differential_evolution: share of each range within which the population ends; "
        "default 0.05",
    )  # fmt: skip
    seed: int | None = Field(None, ge=0, le=2**32 - 1, description="of random numbers; default: 0")


class Cluster(Table):
    """Where runs are jobs of a cluster, by submitit."""

    kind: Literal["slurm", "local"] = Field(
        description="slurm; or local: the same jobs on this machine, to try it"
    )
    minutes: int = Field(60, ge=1, le=1_000_000, description="a job may take")
    memory_gb: float = Field(4.0, gt=0, le=1e5, description="of a job")
    at_once: int = Field(64, ge=1, le=MOST_RUNS, description="jobs that run at the same time")
    partition: str | None = Field(None, description="of the cluster")
    account: str | None = Field(None, description="that pays")
    setup: list[str] = Field([], description="shell lines before each job, as module load")


class StudyTable(Table):
    """The top level of a study file; its parts are checked by their own tables."""

    scenario: str = Field(description="a shipped scenario, or a TOML file beside this one")
    title: str = Field("", description="for figures")
    keep: Literal["all", "results"] = Field(
        "all", description="of each run: all, or all but snapshots and checkpoints"
    )
    threads: int = Field(1, ge=1, le=4096, description="of each run")
    parquet: bool = Field(False, description="also write results.parquet")
    set: dict[str, Any] = Field({}, description="values that all runs have")
    vary: dict[str, Any] = Field({}, description="what differs between runs")
    sample: Any = None
    result: dict[str, Any] = Field({}, description="what is read of each run")
    observation: dict[str, Any] = Field({}, description="what runs are compared with")
    bands: dict[str, Any] = Field({}, description="what percentiles are drawn of")
    calibrate: Any = None
    cluster: Any = None
