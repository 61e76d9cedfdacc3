"""`doseki export`: a run in files of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from .changes import warn_of_changes
from .numbers import number
from .options import Directory, folder

KINDS = ("--vtu", "--surface", "--paraview")


def export(
    directory: Directory,
    vtu: Annotated[
        bool, typer.Option("--vtu", help="Particles as VTU files and a .pvd, for older viewers.")
    ] = False,
    surface: Annotated[
        bool, typer.Option("--surface", help="Surfaces of what flows, as triangles (2-D: lines).")
    ] = False,
    paraview: Annotated[
        bool, typer.Option("--paraview", help="Grains, structures, gauges and a state of ParaView.")
    ] = False,
    kind: Annotated[
        str | None,
        typer.Option("--format", metavar="vtp|ply|stl", help="Of surfaces.", show_default="vtp"),
    ] = None,
    cell: Annotated[
        float | None,
        typer.Option(
            parser=number(1e-9), metavar="M", help="Of surfaces.", show_default="half a spacing"
        ),
    ] = None,
    level: Annotated[
        float | None,
        typer.Option(
            parser=number(0.05, 0.95), metavar="SHARE", help="Of surfaces.", show_default="0.5"
        ),
    ] = None,
    materials: Annotated[
        list[str] | None,
        typer.Option(
            "--material", metavar="NAME", help="Of surfaces; repeatable.", show_default="fluids"
        ),
    ] = None,
    times: Annotated[
        list[float] | None,
        typer.Option(
            "--time",
            parser=number(),
            metavar="SECONDS",
            help="Of surfaces: the nearest snapshot; repeatable.",
            show_default="all",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            parser=folder,
            metavar="DIR",
            help="Output folder.",
            show_default="DIR/vtu, DIR/surface, DIR/paraview",
        ),
    ] = None,
) -> None:
    """Write a run in files of other programs: ParaView, Blender, MeshLab."""
    from ..export.paraview.write import export_paraview
    from ..export.surface.write import SurfaceOptions, export_surface
    from ..export.vtu import export_vtu
    from ..record.reader import load

    asked = [k for k, wanted in zip(KINDS, (vtu, surface, paraview), strict=True) if wanted]
    if not asked:
        raise UserError(f"say what to export, one of {', '.join(KINDS)}")
    if len(asked) > 1:
        raise UserError(f"{' and '.join(asked)} at once: export one of them after the other")
    given = {"--format": kind, "--cell": cell, "--level": level, "--material": materials,
             "--time": times}  # fmt: skip
    for option, value in given.items():
        if value and not surface:
            raise UserError(f"{option} is about surfaces: {asked[0]} has none; use --surface")
    run = load(directory)
    warn_of_changes(directory)
    if vtu:
        lines = [str(export_vtu(run, output))]
    elif surface:
        options = SurfaceOptions(
            kind or "vtp", cell, level or 0.5, tuple(materials or ()), tuple(times or ())
        )
        lines = export_surface(run, options, output)
    else:
        lines = export_paraview(run, output)
    for line in lines:
        typer.echo(line)
