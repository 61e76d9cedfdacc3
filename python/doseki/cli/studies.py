"""Commands that run a scenario several times: trust, compare, study."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..errors import PhysicsError, ResourceError, UserError
from .numbers import whole
from .options import AsJson, Figures, ScenarioName, Settings, Threads, folder, free_directory


def trust(
    scenario: ScenarioName,
    key: Annotated[
        str, typer.Option("--vary", metavar="xi", help="What to halve and double.")
    ] = "xi",
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Of the runs.",
            show_default="runs/NAME-trust",
        ),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Run a scenario at half, given and double xi, and say how much the results moved."""
    from ..record.writer import jsonable
    from ..studies.vary import vary, vary_text

    directory = output or free_directory(f"{Path(scenario).stem}-trust")
    report = vary(scenario, settings or [], key, directory, threads)
    typer.echo(json.dumps(jsonable(report)) if as_json else vary_text(report))


def compare(
    name: Annotated[str, typer.Argument(metavar="flume", help="What to compare.")],
    runs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[RUN RUN]", help="Runs of both schemes.", show_default="both are run now"
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Output folder.",
            show_default="runs/NAME-comparison",
        ),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Compare the paper's scheme, the resolved one and the experiment, on one page."""
    from ..running.runner import RunOptions
    from ..studies.compare import check_name, compare_runs, run_both

    check_name(name)
    if runs and len(runs) != 2:
        raise UserError(f"compare takes two runs, one of each scheme, or none; not {len(runs)}")
    if runs and settings:
        raise UserError("--set changes a scenario that is run; these runs are made already")
    directory = output or free_directory(f"{name}-comparison")
    folders = runs or run_both(
        name,
        settings or [],
        directory,
        RunOptions(threads),
        lambda text: typer.echo(text, err=True),
    )
    comparison = compare_runs(folders, directory)
    for remark in comparison.drawn.remarks:
        typer.echo(f"warning: {remark}", err=True)
    typer.echo((directory / "comparison.json").read_text() if as_json else comparison.text())
    typer.echo(f"In {directory}: comparison.md, pictures", err=as_json)


def study(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A study file.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Folder of the study; one that was begun is gone on with.",
            show_default="runs/NAME",
        ),
    ] = None,
    at_once: Annotated[
        int | None,
        typer.Option(
            parser=whole(1, 4096),
            metavar="N",
            help="Runs at the same time.",
            show_default="one a core",
        ),
    ] = None,
    only_check: Annotated[
        bool, typer.Option("--check", help="Say what it will take, without a run.")
    ] = False,
    retry: Annotated[bool, typer.Option("--retry", help="Make runs that failed again.")] = False,
    figures: Figures = True,
    as_json: AsJson = False,
) -> None:
    """Run a scenario at many values, and compare or calibrate: table, pictures, bands.

    Started again it makes the runs that are missing, and no other.
    """
    from ..studies.runs.row import LOST
    from ..studies.study import check_study, report_text, run_study

    if only_check and (output or retry or as_json or not figures):
        raise UserError("--check makes no run: of the other options it takes --at-once alone")
    if only_check:
        typer.echo(check_study(file, at_once))
        return
    directory = output or Path("runs") / file.stem
    report = run_study(
        file, directory, lambda text: typer.echo(text, err=True), at_once, retry, figures
    )
    for note in report.notes:
        typer.echo(f"warning: {note}", err=True)
    if as_json:
        typer.echo((directory / "results.json").read_text())
    else:
        typer.echo(report_text(report))
        typer.echo(f"\nIn {directory}:")
        for path in report.files:
            typer.echo(f"  {path}")
    if not report.table.done:
        lost = any(entry.row.status == LOST for entry in report.table.entries)
        raise typer.Exit((ResourceError if lost else PhysicsError).exit_code)
