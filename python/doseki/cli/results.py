"""Commands that read a run: plot, report, census, export."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from .changes import warn_of_changes
from .numbers import number, whole
from .options import AsJson, Directory

NAME = 18  # columns of the names of loads


def plot(
    directory: Directory,
    movie: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Also make a movie: FILE.gif, FILE.webp or FILE.mp4."),
    ] = None,
    colour: Annotated[
        str | None,
        typer.Option(help="Colour of the movie: material, velocity_x ...", show_default="material"),
    ] = None,
) -> None:
    """Draw the figures of a run (and a movie on request)."""
    from ..figures.movie import check_movie, make_movie
    from ..figures.plot import draw_run
    from ..record.reader import load

    if colour is not None and movie is None:
        raise UserError(f"--colour {colour} is that of a movie: give --movie FILE, too")
    if movie:
        check_movie(movie)
    warn_of_changes(directory)
    drawn = draw_run(directory)
    for picture in drawn.pictures:
        typer.echo(str(picture))
    for note in drawn.notes:
        typer.echo(note)
    if movie:
        typer.echo(str(make_movie(load(directory), movie, colour=colour or "material")))
    for remark in drawn.remarks:
        typer.echo(f"warning: {remark}", err=True)
    drawn.check(f"{len(drawn.failures)} of the figures could not be drawn")


def report(
    directory: Directory,
    size_mb: Annotated[
        float,
        typer.Option(
            "--size-mb",
            parser=number(0.5, 2000.0),
            metavar="MB",
            help="Largest size of the file: pictures are made smaller, and particles and snapshots"
            " left out, to keep it.",
        ),
    ] = 20.0,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help="The file.", show_default="DIR/report.html"
        ),
    ] = None,
) -> None:
    """Write the report on a run: one HTML file with a view of it that turns, to be sent."""
    from ..report.report import write_report

    warn_of_changes(directory)
    written = write_report(directory, size_mb, output)
    typer.echo(f"{written.path} ({written.size / 1e6:.2g} MB)")
    for note in written.notes:
        typer.echo(f"  {note}")


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
            show_default="0, where that is in the scene",
        ),
    ] = None,
    sample: Annotated[
        int,
        typer.Option(parser=whole(1, 1_000_000), metavar="N", help="Grains in a random sample."),
    ] = 30,
    draws: Annotated[
        int, typer.Option(parser=whole(1, 100_000), metavar="N", help="Number of samples.")
    ] = 2000,
    bin_width: Annotated[
        float,
        typer.Option(parser=number(1e-6, 1e6), metavar="WIDTH", help="Of the histogram, m/s."),
    ] = 0.1,
) -> None:
    """Take a census of the grains of a run into DIR/census: tables and figures."""
    from ..figures.census_output import CensusOptions, write_census

    chosen = tuple(sections) if sections else None
    warn_of_changes(directory)
    options = CensusOptions(window, start, end, chosen, sample, draws, bin_width)
    for line in write_census(directory, options):
        typer.echo(line)


def maps(
    directory: Directory,
    cell: Annotated[
        float | None,
        typer.Option(
            parser=number(1e-12), metavar="M", help="Side of cells.", show_default="the terrain's"
        ),
    ] = None,
    extent: Annotated[
        tuple[float, float, float, float] | None,
        typer.Option(
            metavar="WEST SOUTH EAST NORTH", help="What is mapped, m.", show_default="all terrain"
        ),
    ] = None,
    path: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|POINTS", help='Also a profile along a line: a file, or "x,y x,y ...".'
        ),
    ] = None,
) -> None:
    """Draw maps of a 3-D run into DIR/maps: largest depth, speed, pressure, arrival, deposit."""
    from ..figures.maps.output import MapOptions, write_pictures
    from ..figures.saving import Drawn

    warn_of_changes(directory)
    for line in write_pictures(directory, MapOptions(cell, extent, path), drawn := Drawn()):
        typer.echo(line)
    drawn.check(f"{len(drawn.failures)} of the maps could not be drawn")


def loads(
    directory: Directory,
    as_json: AsJson = False,
) -> None:
    """Loads on the structures of a run: peaks, means, impulses, design formulas, overtopping."""
    from ..assess.loads import as_json as contents
    from ..assess.loads import load_lines, sections_turned_round, write_loads
    from ..record.reader import load

    run = load(directory)
    warn_of_changes(directory)
    found = write_loads(run)
    if not found:
        raise UserError(
            f"{directory}: no gauge of kind load or overtopping has read anything; "
            "docs/scenarios.md says how to name one"
        )
    for doubt in sections_turned_round(run):
        typer.echo(f"warning: {doubt}", err=True)
    if as_json:
        typer.echo(json.dumps(contents(found)))
        return
    for name, text in load_lines(found):
        typer.echo(f"{name:<{NAME}}{text}".rstrip())
