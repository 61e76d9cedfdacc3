"""Commands that read a run: plot, census, export."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from .numbers import number
from .options import AsJson, Directory

NAME = 18  # columns of the names of loads


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
    from ..figures.movie import make_movie
    from ..figures.plot import draw_run
    from ..record.reader import load

    drawn = draw_run(directory)
    for picture in drawn.pictures:
        typer.echo(str(picture))
    for note in drawn.notes:
        typer.echo(note)
    if movie:
        typer.echo(str(make_movie(load(directory), movie, colour=colour)))
    for remark in drawn.remarks:
        typer.echo(f"warning: {remark}", err=True)
    if drawn.failures:
        raise UserError(f"{len(drawn.failures)} of the figures could not be drawn")


def census(
    directory: Directory,
    window: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Of the speeds.", show_default="outlet, else everywhere"),
    ] = None,
    start: Annotated[
        float, typer.Option("--from", parser=number(), metavar="SECONDS", help="Of the speeds.")
    ] = float("-inf"),
    end: Annotated[
        float, typer.Option("--to", parser=number(), metavar="SECONDS", help="Of the speeds.")
    ] = float("inf"),
    sections: Annotated[
        list[float] | None,
        typer.Option(
            "--section",
            parser=number(),
            metavar="X",
            help="Where passing is counted, m; repeatable.",
            show_default="0",
        ),
    ] = None,
    sample: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Grains in a random sample.")
    ] = 30,
    draws: Annotated[int, typer.Option(min=1, max=100_000, help="Number of samples.")] = 2000,
    bin_width: Annotated[
        float,
        typer.Option(parser=number(1e-6, 1e6), metavar="WIDTH", help="Of the histogram, m/s."),
    ] = 0.1,
) -> None:
    """Take a census of the grains of a run into DIR/census: tables and figures."""
    from ..figures.census_output import CensusOptions, write_census

    chosen = tuple(sections or [0.0])
    options = CensusOptions(window, start, end, chosen, sample, draws, bin_width)
    for line in write_census(directory, options):
        typer.echo(line)


def loads(
    directory: Directory,
    as_json: AsJson = False,
) -> None:
    """Loads on the structures of a run: peaks, means, impulses, design formulas, overtopping."""
    from ..assess.loads import as_json as contents
    from ..assess.loads import load_lines, write_loads
    from ..record.reader import load

    found = write_loads(load(directory))
    if not found:
        raise UserError(
            f"{directory}: no gauge of kind load or overtopping has read anything; "
            "docs/scenarios.md says how to name one"
        )
    if as_json:
        typer.echo(json.dumps(contents(found)))
        return
    for name, text in load_lines(found):
        typer.echo(f"{name:<{NAME}}{text}".rstrip())


def export(
    directory: Directory,
    vtu: Annotated[
        bool, typer.Option("--vtu", help="VTU files and a .pvd, for older viewers.")
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Output folder.", show_default="DIR/vtu"
        ),
    ] = None,
) -> None:
    """Write the snapshots of a run in another format."""
    from ..record.export import export_vtu
    from ..record.reader import load

    if not vtu:
        raise UserError("say which format to export to: --vtu")
    typer.echo(str(export_vtu(load(directory), output)))
