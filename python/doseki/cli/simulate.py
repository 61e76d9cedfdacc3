"""Commands that run scenarios: run, check, resume, explain."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import Interrupted, one_line
from .interrupts import ending_early
from .numbers import number
from .options import (
    AsJson,
    CheckpointEvery,
    CheckpointMinutes,
    Device,
    DeviceName,
    Directory,
    Figures,
    Ranks,
    ScenarioName,
    Settings,
    Threads,
    folder,
    free_directory,
)
from .ranks import join


def run(
    scenario: ScenarioName,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Output folder.",
            show_default="runs/NAME",
        ),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    device: Device = DeviceName.auto,
    ranks: Ranks = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an existing run in DIR.")
    ] = False,
    checkpoint_every: CheckpointEvery = None,
    checkpoint_minutes: CheckpointMinutes = 10.0,
    figures: Figures = True,
    as_json: AsJson = False,
) -> None:
    """Run a scenario; the record, figures and a one-screen summary go to DIR."""
    from ..assess.preflight import brief_check
    from ..running.devices import choose_device, count_of_scene
    from ..running.progress import progress_bar
    from ..running.runner import RunOptions, run_folder, run_scenario
    from ..scenario.load import load_scenario

    team = join(ranks)
    loaded = load_scenario(scenario, settings or [])
    choose_device(device, lambda: count_of_scene(loaded), team, _say)
    directory = output or team.agree(free_directory(scenario))

    def tell(*started: Any) -> None:
        for line in [*brief_check(*started), *_about_cores(threads), *_about_card(*started)]:
            _say(line)

    with run_folder(directory, overwrite, team), ending_early():
        with progress_bar(loaded.title, loaded.time_max) as progress:
            options = RunOptions(
                threads,
                overwrite,
                progress,
                tell,
                checkpoint_every,
                checkpoint_minutes,
                team,
                progress.tell,
            )
            summary = run_scenario(loaded, directory, options)
        if team.is_root:
            _report(directory, summary, figures, as_json)


def _say(line: str) -> None:
    typer.echo(line, err=True)


def _about_cores(threads: int | None) -> list[str]:
    """A line where the cores are not those of the run alone."""
    from ..util.cores import shared_cores

    return [f"warning: {doubt}" for doubt in shared_cores(threads)]


def _about_card(_scenario: Any, simulation: Any, *_: Any) -> list[str]:
    """A line where the run does not fit on the card that it runs on."""
    from ..running.devices import card_doubts

    state = len(simulation) * simulation.bytes_per_particle
    return [f"warning: {doubt}" for doubt in card_doubts(state)]


def _report(directory: Path, summary: dict[str, Any], figures: bool, as_json: bool) -> None:
    """Figures and the summary on one screen, or as JSON; what fails here loses no finished run."""
    remarks: list[str] = []
    notes: list[str] = []
    pictures = _pictures(directory, remarks, notes) if figures else []
    text = _summary_text(directory, summary, remarks)
    for remark in remarks:
        typer.echo(f"warning: {one_line(remark)}", err=True)
    if as_json:
        said = {"directory": str(directory), "figures": [str(p) for p in pictures]}
        typer.echo(json.dumps(summary | said))
        return
    typer.echo(text)
    drawn = ", figures:" if figures else ""
    typer.echo(f"\nIn {directory}: summary.txt, history.csv, snapshots{drawn}")
    for line in [*map(str, pictures), *notes]:
        typer.echo(f"  {line}")


def _pictures(directory: Path, remarks: list[str], notes: list[str]) -> list[Path]:
    """The figures of a run; in `remarks` what is wrong with them, in `notes` which are empty."""
    from ..figures.plot import draw_run

    try:
        drawn = draw_run(directory)
    except (Exception, Interrupted) as error:
        remarks.append(f"no figures: {error or repr(error)}; later: doseki plot {directory}")
        return []
    remarks += drawn.remarks
    notes += drawn.notes
    return drawn.pictures


def _summary_text(directory: Path, summary: dict[str, Any], remarks: list[str]) -> str:
    """The summary for people as it was written; the bare numbers where that is not there."""
    from ..record.folder import RunFolder

    try:
        return RunFolder(directory).summary_text.read_text("utf-8").rstrip("\n")
    except (OSError, UnicodeDecodeError):
        remarks.append("the summary is not whole: see the warnings in it")
    return "\n".join(f"{name:<18}{value}" for name, value in summary.items())


def check(
    scenario: ScenarioName,
    settings: Settings = None,
    threads: Threads = None,
    device: Device = DeviceName.auto,
) -> None:
    """Say what a scenario will take, and what is doubtful about it, without running it.

    See also: doseki list names the shipped ones, doseki explain says why a run failed.
    """
    from ..assess.preflight import check_scenario
    from ..driver.ranks import OneRank
    from ..running.devices import choose_device, count_of_scene, rehearsed
    from ..running.progress import work_shown
    from ..scenario.load import load_scenario

    loaded = load_scenario(scenario, settings or [])
    name = rehearsed(device, _say)
    choose_device(name, lambda: count_of_scene(loaded), OneRank(), _say)
    with work_shown() as tell:
        report = check_scenario(loaded, threads, tell)
    typer.echo(report)


def resume(
    directory: Directory,
    settings: Settings = None,
    until: Annotated[
        float,
        typer.Option(
            "--from",
            parser=number(0.0),
            metavar="SECONDS",
            help="Not from a checkpoint later than this.",
        ),
    ] = float("inf"),
    threads: Threads = None,
    device: Device = DeviceName.auto,
    ranks: Ranks = None,
    checkpoint_every: CheckpointEvery = None,
    checkpoint_minutes: CheckpointMinutes = 10.0,
    figures: Figures = True,
    as_json: AsJson = False,
) -> None:
    """Go on with a run that was stopped, killed or failed, from its last checkpoint."""
    from ..record.reader import load
    from ..running.devices import choose_device, count_of_record
    from ..running.progress import progress_bar
    from ..running.resume import resume_run
    from ..running.runner import RunOptions
    from ..scenario.load import load_scenario

    team = join(ranks)
    run = load(directory)
    scenario = run.scenario
    time_max = scenario["time_max"]
    if settings:
        time_max = load_scenario(run.folder.scenario, settings).time_max
    choose_device(device, lambda: count_of_record(run), team, _say)

    def tell(*_started: Any) -> None:
        for line in _about_cores(threads) if team.is_root else ():
            _say(line)

    with team.holding(directory), ending_early():
        with progress_bar(scenario.get("title", ""), time_max) as progress:
            options = RunOptions(
                threads,
                progress=progress,
                started=tell,
                resumed=tell,
                checkpoint_every=checkpoint_every,
                checkpoint_minutes=checkpoint_minutes,
                ranks=team,
                tell=progress.tell,
            )
            summary, notes = resume_run(directory, settings or [], options, until)
        for note in notes:
            typer.echo(f"warning: {note}", err=True)
        if team.is_root:
            _report(directory, summary, figures, as_json)


def explain(directory: Directory) -> None:
    """Say why a run failed or ended early, and what to change.

    See also: doseki check says before a run what is doubtful about a scenario.
    """
    from ..assess.failure.failure import explanation
    from ..record.reader import load

    typer.echo(explanation(load(directory).folder))
