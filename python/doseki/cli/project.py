"""Commands about doseki itself and its scenarios: list, new, bench, validate."""

from __future__ import annotations

import json
import shlex
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from .numbers import choices, one_of
from .options import Threads, folder, free_directory

Tier = StrEnum("Tier", ["coarse", "full"])
Precision = StrEnum("Precision", ["double", "mixed"])


class Dimensions(StrEnum):
    """Of space."""

    TWO = "2"
    THREE = "3"


def list_scenarios() -> None:
    """List the scenarios that are shipped.

    See also: doseki check NAME looks one over, doseki run NAME runs it.
    """
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from ..scenario.load import list_scenarios as shipped

    table = Table("scenario", "what it is", box=None)
    for name, title, _path in shipped():
        table.add_row(name, Text(title))
    Console().print(table)


def new(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Of the scenario, FILE.toml.")],
    dim: Annotated[
        Dimensions,
        typer.Option(parser=one_of(Dimensions), metavar=choices(Dimensions), help="Dimensions."),
    ] = Dimensions.TWO,
    dry: Annotated[bool, typer.Option("--dry", help="Grains without water.")] = False,
) -> None:
    """Write a commented scenario to start from: water in a tank, or dry grains.

    See also: doseki check FILE looks it over, doseki run FILE runs it.
    """
    from ..scenario.start import write_start

    write_start(file, int(dim.value), dry)
    typer.echo(f"{file}: run it with doseki run {shlex.quote(str(file))}")


def bench(
    quick: Annotated[
        bool, typer.Option("--quick", help="Smaller and fewer: under a minute.")
    ] = False,
    sizes: Annotated[
        str | None, typer.Option(metavar="N,...", help="Particles, e.g. 1e4,1e6.")
    ] = None,
    dims: Annotated[str | None, typer.Option(metavar="2,3", help="Dimensions.")] = None,
    precision: Annotated[
        str | None, typer.Option(metavar="double,mixed", help="Of the pairs.")
    ] = None,
    threads: Annotated[
        str | None, typer.Option(metavar="T,...", help="Threads.", show_default="1, 2, all")
    ] = None,
    isa: Annotated[
        str | None,
        typer.Option(
            metavar="v4,...", help="Instruction sets.", show_default="best; others at one size"
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Time the code of a card instead, on it (cuda) or on the processor (host): with "
            "the operations and bytes of a pair.",
            show_default="none",
        ),
    ] = None,
    scheme: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="ueta2022 or resolved.", show_default="ueta2022"),
    ] = None,
    flows: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,...",
            help="Only these flows: dam-break-2d, dam-break-3d, flume, tumbler or all.",
            show_default="all, after the block",
        ),
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
    from ..bench.command import bench_command, make_plan

    options = {"--sizes": sizes, "--dims": dims, "--precision": precision}
    options |= {"--threads": threads, "--isa": isa, "--scheme": scheme, "--flows": flows}
    options |= {"--device": device}
    if flows is not None and ranks is not None:
        raise UserError("--flows: not with --ranks; run them one after the other")
    plan = make_plan(options, quick)
    if ranks is None:
        bench_command(plan, as_json, append)
        return
    from ..bench.command import counts_of
    from ..bench.ranks import bench_ranks

    counts = counts_of("--ranks", ranks, 100_000)
    bench_ranks(counts, plan.dims, plan.scheme, next(iter(plan.sizes), None), as_json)


def validate(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME ...]", help="Cases.", show_default="all")
    ] = None,
    tier: Annotated[
        Tier,
        typer.Option(
            parser=one_of(Tier),
            metavar=choices(Tier),
            help="coarse: the coarsest resolution only; full: all of them.",
        ),
    ] = Tier.coarse,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Of the report.",
            show_default="runs/validation",
        ),
    ] = None,
    threads: Threads = None,
    precision: Annotated[
        Precision | None,
        typer.Option(
            parser=one_of(Precision),
            metavar=choices(Precision),
            help="Of the pair arithmetic of all cases.",
            show_default="the scenarios'",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the report as JSON.")] = False,
    only_list: Annotated[bool, typer.Option("--list", help="List the cases and stop.")] = False,
) -> None:
    """Compare runs with formulas and measurements; exit code 1 when a case fails."""
    from ..validate import report
    from ..validate.catalogue import chosen_cases
    from ..validate.command import validate as validate_cases
    from ..validate.judging import failed

    cases = chosen_cases(names or [])
    if only_list:
        for case in cases:
            typer.echo(f"{case.name:28} {case.title}")
        return
    directory = output or free_directory("validation")
    how = {"tier": tier.value} | ({"precision": precision.value} if precision else {})
    results = validate_cases(
        cases, how, directory, threads, lambda text: typer.echo(text, err=True)
    )
    if as_json:
        typer.echo(json.dumps(report.report_table(results, how)))
    else:
        typer.echo(report.table_text(results))
        for line in report.remarks(results):
            typer.echo(line)
        typer.echo(f"{report.summary_line(results)}; in {directory}: validation.md, pictures")
    if failed(results):
        raise typer.Exit(1)
