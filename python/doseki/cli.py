"""The command line: doseki run | plot | census | compare | export | list | bench | validate."""

from __future__ import annotations

import json
import os
import sys
import traceback
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from . import __version__
from .errors import DosekiError, ResourceError, UserError

_debug = False  # set by --debug
_ranks: Any = None  # those of the command, once it has joined them

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Debris flows by smoothed particle hydrodynamics: water and rock solved as continua.",
    epilog="Exit codes: 0 done, 1 a validation case fails, 2 bad input, 3 physics went wrong,"
    " 4 out of memory or disk. The tests: ./doseki test.",
)

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value of the scenario; repeatable."),
]
Threads = Annotated[int | None, typer.Option(min=1, max=4096, help="Threads [all cores].")]
CheckpointEvery = Annotated[
    float | None,
    typer.Option(min=1e-12, metavar="SECONDS", help="Simulated time between checkpoints."),
]
CheckpointMinutes = Annotated[
    float, typer.Option(min=0.0, metavar="M", help="Wall time between checkpoints.")
]
Ranks = Annotated[
    int | None,
    typer.Option(min=1, max=100_000, help="MPI ranks on this machine; or start with mpiexec."),
]
Figures = Annotated[bool, typer.Option(help="Draw the figures at the end.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")]
Tier = StrEnum("Tier", ["coarse", "full"])
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
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
) -> None:
    """Options that stand before the command."""
    global _debug
    _debug = debug


def _free_directory(name: str) -> Path:
    """runs/NAME, or runs/NAME-2, -3 ... where that is taken."""
    base = Path("runs") / Path(name).stem
    candidates = [base, *(base.with_name(f"{base.name}-{k}") for k in range(2, 10000))]
    return next(path for path in candidates if not path.exists())


def _joined(ranks: int | None) -> Any:
    """The ranks of this command; with `--ranks` outside mpiexec, this process only starts them."""
    global _ranks
    from .parallel.launch import join_ranks, launched_size, spawn

    if ranks is not None and launched_size() == 1 and ranks > 1:
        raise typer.Exit(spawn(ranks, sys.argv[1:]))
    if ranks is not None and ranks != launched_size():
        raise UserError(f"--ranks {ranks}: mpiexec has started {launched_size()}; leave it out")
    _ranks = join_ranks()
    return _ranks


@app.command()
def run(
    scenario: Annotated[
        str, typer.Argument(metavar="NAME|FILE", help="A shipped scenario or a TOML file.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Output folder [runs/NAME]."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
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
    from .check import brief_check
    from .progress import progress_bar
    from .run import RunOptions, run_scenario
    from .scenario import load_scenario

    team = _joined(ranks)
    loaded = load_scenario(scenario, settings or [])
    directory = output or team.agree(_free_directory(scenario))

    def tell(*started: Any) -> None:
        for line in brief_check(*started):
            typer.echo(line, err=True)

    with progress_bar(loaded.title, loaded.time_max) as progress:
        options = RunOptions(
            threads, overwrite, progress, tell, checkpoint_every, checkpoint_minutes, team
        )
        summary = run_scenario(loaded, directory, options)
    if team.is_root:
        _report(directory, summary, figures, as_json)


def _report(directory: Path, summary: dict[str, Any], figures: bool, as_json: bool) -> None:
    """Figures and the summary on one screen, or as JSON."""
    from .loading import load
    from .plot import plot_run
    from .summary import summary_text

    pictures = plot_run(directory) if figures else []
    text = summary_text(load(directory))
    (directory / "summary.txt").write_text(text + "\n")
    if as_json:
        typer.echo(
            json.dumps(
                summary | {"directory": str(directory), "figures": [str(p) for p in pictures]}
            )
        )
        return
    typer.echo(text)
    typer.echo(f"\nIn {directory}: summary.txt, history.csv, snapshots, figures:")
    for picture in pictures:
        typer.echo(f"  {picture}")


@app.command()
def check(
    scenario: Annotated[
        str, typer.Argument(metavar="NAME|FILE", help="A shipped scenario or a TOML file.")
    ],
    settings: Settings = None,
    threads: Threads = None,
) -> None:
    """Say what a scenario will take, and what is doubtful about it, without running it."""
    from .check import check_scenario
    from .scenario import load_scenario

    typer.echo(check_scenario(load_scenario(scenario, settings or []), threads))


@app.command()
def resume(
    directory: Directory,
    settings: Settings = None,
    until: Annotated[
        float,
        typer.Option("--from", metavar="SECONDS", help="Not from a checkpoint later than this."),
    ] = float("inf"),
    threads: Threads = None,
    ranks: Ranks = None,
    checkpoint_every: CheckpointEvery = None,
    checkpoint_minutes: CheckpointMinutes = 10.0,
    figures: Figures = True,
    as_json: AsJson = False,
) -> None:
    """Go on with a run that was stopped, killed or failed, from its last checkpoint."""
    from .loading import load
    from .progress import progress_bar
    from .resume import resume_run
    from .run import RunOptions

    team = _joined(ranks)
    scenario = load(directory).scenario
    with progress_bar(scenario.get("title", ""), scenario["time_max"]) as progress:
        options = RunOptions(
            threads,
            progress=progress,
            checkpoint_every=checkpoint_every,
            checkpoint_minutes=checkpoint_minutes,
            ranks=team,
        )
        summary, notes = resume_run(directory, settings or [], options, until)
    for note in notes:
        typer.echo(f"warning: {note}", err=True)
    if team.is_root:
        _report(directory, summary, figures, as_json)


@app.command()
def explain(directory: Directory) -> None:
    """Say why a run failed, and what to change."""
    from .failure import explanation
    from .loading import load

    typer.echo(explanation(load(directory).folder))


@app.command()
def trust(
    scenario: Annotated[
        str, typer.Argument(metavar="NAME|FILE", help="A shipped scenario or a TOML file.")
    ],
    key: Annotated[
        str, typer.Option("--vary", metavar="xi", help="What to halve and double.")
    ] = "xi",
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Of the runs [runs/NAME-trust]."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Run a scenario at half, given and double xi, and say how much the results moved."""
    from .record import jsonable
    from .vary import vary, vary_text

    directory = output or _free_directory(f"{Path(scenario).stem}-trust")
    report = vary(scenario, settings or [], key, directory, threads)
    typer.echo(json.dumps(jsonable(report)) if as_json else vary_text(report))


@app.command()
def plot(
    directory: Directory,
    movie: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also make a movie: FILE.gif or FILE.mp4.")
    ] = None,
    colour: Annotated[
        str, typer.Option(help="Colour of the movie: material, velocity_x ...")
    ] = "material",
) -> None:
    """Draw the figures of a run (and a movie on request)."""
    from .loading import load
    from .movie import make_movie
    from .plot import plot_run

    for picture in plot_run(directory):
        typer.echo(str(picture))
    if movie:
        typer.echo(str(make_movie(load(directory), movie, colour=colour)))


@app.command()
def compare(
    name: Annotated[str, typer.Argument(metavar="flume", help="What to compare.")],
    runs: Annotated[
        list[Path] | None,
        typer.Argument(metavar="[RUN RUN]", help="Runs of both schemes [both are run now]."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--out", "--output", metavar="DIR", help="[runs/NAME-comparison]"),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
) -> None:
    """Compare the paper's scheme, the resolved one and the experiment, on one page."""
    from .compare import check_name, compare_runs, run_both
    from .run import RunOptions

    check_name(name)
    if runs and len(runs) != 2:
        raise UserError(f"compare takes two runs, one of each scheme, or none; not {len(runs)}")
    if runs and settings:
        raise UserError("--set changes a scenario that is run; these runs are made already")
    directory = output or _free_directory(f"{name}-comparison")
    folders = runs or run_both(
        name,
        settings or [],
        directory,
        RunOptions(threads),
        lambda text: typer.echo(text, err=True),
    )
    comparison = compare_runs(folders, directory)
    typer.echo((directory / "comparison.json").read_text() if as_json else comparison.text())
    typer.echo(f"In {directory}: comparison.md, pictures", err=as_json)


@app.command()
def census(
    directory: Directory,
    window: Annotated[
        str | None,
        typer.Option(metavar="NAME", help='Of the speeds [the window "outlet", else all].'),
    ] = None,
    start: Annotated[
        float, typer.Option("--from", metavar="SECONDS", help="Of the speeds.")
    ] = float("-inf"),
    end: Annotated[float, typer.Option("--to", metavar="SECONDS", help="Of the speeds.")] = float(
        "inf"
    ),
    sections: Annotated[
        list[float] | None,
        typer.Option("--section", metavar="X", help="Where passing is counted, m; repeatable [0]."),
    ] = None,
    sample: Annotated[int, typer.Option(min=1, help="Grains in a random sample.")] = 30,
    draws: Annotated[int, typer.Option(min=1, max=100_000, help="Number of samples.")] = 2000,
    bin_width: Annotated[float, typer.Option(min=1e-6, help="Of the histogram, m/s.")] = 0.1,
) -> None:
    """Take a census of the grains of a run into DIR/census: tables and figures."""
    from .census_output import CensusOptions, write_census

    chosen = tuple(sections or [0.0])
    options = CensusOptions(window, start, end, chosen, sample, draws, bin_width)
    for line in write_census(directory, options):
        typer.echo(line)


@app.command()
def export(
    directory: Directory,
    vtu: Annotated[
        bool, typer.Option("--vtu", help="VTU files and a .pvd, for older viewers.")
    ] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="[DIR/vtu]")
    ] = None,
) -> None:
    """Write the snapshots of a run in another format."""
    from .export import export_vtu
    from .loading import load

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


@app.command()
def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="Smaller and fewer: under a minute.")
    ] = False,
    sizes: Annotated[
        str | None, typer.Option(metavar="N,...", help="Particles, e.g. 1e4,1e6.")
    ] = None,
    dims: Annotated[str | None, typer.Option(metavar="2,3", help="Dimensions.")] = None,
    precision: Annotated[
        str | None, typer.Option(metavar="double,float", help="Of the pairs.")
    ] = None,
    threads: Annotated[
        str | None, typer.Option(metavar="T,...", help="Threads [1, 2, all].")
    ] = None,
    isa: Annotated[
        str | None,
        typer.Option(metavar="v4,...", help="Instruction sets [best; others at one size]."),
    ] = None,
    scheme: Annotated[
        str | None, typer.Option(metavar="NAME", help="ueta2022 or resolved [ueta2022].")
    ] = None,
    ranks: Annotated[
        str | None,
        typer.Option(metavar="R,...", help="Scaling over MPI ranks of this machine instead."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
    append: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Also append the rows to FILE, one line a run."),
    ] = None,
) -> None:
    """Measure speed and memory here; exit code 4 when memory is over its limit."""
    from .bench import bench_command, make_plan

    options = {"--sizes": sizes, "--dims": dims, "--precision": precision}
    options |= {"--threads": threads, "--isa": isa, "--scheme": scheme}
    plan = make_plan(options, quick)
    if ranks is None:
        bench_command(plan, as_json, append)
        return
    from .bench import counts_of
    from .parallel.bench import bench_ranks

    counts = counts_of("--ranks", ranks, 100_000)
    bench_ranks(counts, plan.dims, plan.scheme, next(iter(plan.sizes), None), as_json)


@app.command()
def validate(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME ...]", help="Cases [all].")
    ] = None,
    tier: Annotated[
        Tier, typer.Option(help="coarse: the coarsest resolution only; full: all of them.")
    ] = Tier.coarse,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Of the report [runs/validation]."),
    ] = None,
    threads: Threads = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
    only_list: Annotated[bool, typer.Option("--list", help="List the cases and stop.")] = False,
) -> None:
    """Compare runs with formulas and measurements; exit code 1 when a case fails."""
    from .validate import report
    from .validate.catalogue import chosen_cases
    from .validate.command import validate as validate_cases
    from .validate.judging import failed

    cases = chosen_cases(names or [])
    if only_list:
        for case in cases:
            typer.echo(f"{case.name:28} {case.title}")
        return
    directory = output or _free_directory("validation")
    results = validate_cases(
        cases, tier.value, directory, threads, lambda text: typer.echo(text, err=True)
    )
    if as_json:
        typer.echo(json.dumps(report.report_table(results, tier.value)))
    else:
        typer.echo(report.table_text(results))
        for line in report.remarks(results):
            typer.echo(line)
        typer.echo(f"{report.summary_line(results)}; in {directory}: validation.md, pictures")
    if failed(results):
        raise typer.Exit(1)


def main(arguments: list[str] | None = None) -> Any:
    """Entry point: errors become one sentence and an exit code; a traceback only with --debug."""
    error_stream = sys.stderr
    if _is_silent():
        sys.stdout = sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
    try:
        return app(arguments)
    except Exception as error:
        if _debug:
            traceback.print_exc(file=error_stream)
        text, exit_code = _said(error)
        if _ranks is not None and _ranks.count > 1:
            _ranks.fail(text, exit_code, lambda line: print(f"doseki: {line}", file=error_stream))
        typer.echo(f"doseki: {text}", err=True)
        sys.exit(exit_code)
    finally:
        if _ranks is not None and _ranks.count > 1:
            _ranks.done()


def _is_silent() -> bool:
    """Whether another rank prints what is to be printed."""
    from .parallel.launch import launched_rank

    return launched_rank() > 0


def _said(error: Exception) -> tuple[str, int]:
    """An error as a sentence and an exit code."""
    if isinstance(error, DosekiError):
        return str(error), error.exit_code
    if isinstance(error, MemoryError):
        return "out of memory", ResourceError.exit_code
    said = " ".join(f"{type(error).__name__}: {error}".split())
    return f"a mistake in doseki itself: {said} (--debug shows where)", 1


if __name__ == "__main__":
    main()
