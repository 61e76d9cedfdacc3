"""The command line: doseki run | plot | export | list."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from . import __version__
from .errors import DosekiError, UserError

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Debris flows by smoothed particle hydrodynamics: water and rock solved as continua.",
    epilog="Exit codes: 0 done, 2 bad input, 3 physics went wrong, 4 out of memory or disk.",
)

Directory = Annotated[Path, typer.Argument(metavar="DIR", help="Output folder of a run.")]


def _version(value: bool) -> None:
    if value:
        typer.echo(f"doseki {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Options that stand before the command."""


def _free_directory(name: str) -> Path:
    """runs/NAME, or runs/NAME-2, -3 ... where that is taken."""
    base = Path("runs") / Path(name).stem
    candidates = [base, *(base.with_name(f"{base.name}-{k}") for k in range(2, 10000))]
    return next(path for path in candidates if not path.exists())


@app.command()
def run(
    scenario: Annotated[str, typer.Argument(metavar="NAME|FILE", help="A shipped scenario or a TOML file.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Output folder [runs/NAME].")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scenario; repeatable."),
    ] = None,
    threads: Annotated[int | None, typer.Option(min=1, max=4096, help="Threads [all cores].")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an existing run in DIR.")] = False,
    figures: Annotated[bool, typer.Option(help="Draw the figures at the end.")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")] = False,
) -> None:
    """Run a scenario; the record, figures and a one-screen summary go to DIR."""
    from .load import load
    from .plot import plot_run
    from .progress import progress_bar
    from .run import RunOptions, run_scenario
    from .scenario import load_scenario
    from .summary import summary_text

    loaded = load_scenario(scenario, settings or [])
    directory = output or _free_directory(scenario)
    for warning in loaded.warnings:
        typer.echo(f"warning: {warning}", err=True)
    with progress_bar(loaded.title, loaded.time_max) as progress:
        summary = run_scenario(loaded, directory, RunOptions(threads, overwrite, progress))
    pictures = plot_run(directory) if figures else []
    text = summary_text(load(directory))
    (directory / "summary.txt").write_text(text + "\n")
    if as_json:
        typer.echo(json.dumps(summary | {"directory": str(directory), "figures": [str(p) for p in pictures]}))
        return
    typer.echo(text)
    typer.echo(f"\nIn {directory}: summary.txt, history.csv, snapshots, figures:")
    for picture in pictures:
        typer.echo(f"  {picture}")


@app.command()
def plot(
    directory: Directory,
    movie: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also make a movie: FILE.gif or FILE.mp4.")
    ] = None,
    colour: Annotated[str, typer.Option(help="Colour of the movie: material, velocity_x ...")] = "material",
) -> None:
    """Draw the figures of a run (and a movie on request)."""
    from .load import load
    from .movie import make_movie
    from .plot import plot_run

    for picture in plot_run(directory):
        typer.echo(str(picture))
    if movie:
        typer.echo(str(make_movie(load(directory), movie, colour=colour)))


@app.command()
def export(
    directory: Directory,
    vtu: Annotated[bool, typer.Option("--vtu", help="VTU files and a .pvd, for older viewers.")] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="DIR", help="[DIR/vtu]")] = None,
) -> None:
    """Write the snapshots of a run in another format."""
    from .export import export_vtu
    from .load import load

    if not vtu:
        raise UserError("say which format to export to: --vtu")
    typer.echo(str(export_vtu(load(directory), output)))


@app.command("list")
def list_command() -> None:
    """List the scenarios that are shipped."""
    from .scenario import list_scenarios

    table = Table("scenario", "what it is", box=None)
    for name, title, _path in list_scenarios():
        table.add_row(name, title)
    Console().print(table)


def main(arguments: list[str] | None = None) -> Any:
    """Entry point: user mistakes become one sentence and an exit code, never a traceback."""
    try:
        return app(arguments)
    except DosekiError as error:
        typer.echo(f"doseki: {error}", err=True)
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()
