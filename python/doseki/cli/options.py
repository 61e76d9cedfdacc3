"""Options that several commands have, and the folder they write to without one."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ..util.files import free_directory as free_directory
from .numbers import choices, number, one_of, whole


def folder(text: object) -> Path:
    """What reads the name of an output folder; an empty one, as of a variable that is not set,
    would be the folder that the command was started in.
    """
    if not str(text).strip():
        raise typer.BadParameter("the name is empty; name a folder, or . for this one")
    return Path(str(text))


folder.__name__ = "path"


def _last_counts(settings: list[str] | None) -> list[str] | None:
    """Say which value counts where a key is set twice."""
    seen: dict[str, str] = {}
    for setting in settings or []:
        key = setting.partition("=")[0].strip().removeprefix("parameters.")
        if key in seen:
            typer.echo(f"warning: --set {seen[key]}: the later --set {setting} counts", err=True)
        seen[key] = setting
    return settings


ScenarioName = Annotated[
    str, typer.Argument(metavar="NAME|FILE", help="A shipped scenario or a TOML file.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        callback=_last_counts,
        help="Change a value of the scenario; repeatable.",
    ),
]
Threads = Annotated[
    int | None,
    typer.Option(parser=whole(1, 4096), metavar="N", help="Threads.", show_default="all cores"),
]
DeviceName = StrEnum("DeviceName", ["auto", "cpu", "host", "cuda"])
Device = Annotated[
    DeviceName,
    typer.Option(
        "--device",
        parser=one_of(DeviceName),
        metavar=choices(DeviceName),
        help="Where the flow is worked out: the processor (cpu), a graphics card (cuda), the code "
        "of a card on the processor (host), or a card if there is one and the case is large "
        "enough (auto).",
    ),
]
CheckpointEvery = Annotated[
    float | None,
    typer.Option(
        parser=number(1e-12), metavar="SECONDS", help="Simulated time between checkpoints."
    ),
]
CheckpointMinutes = Annotated[
    float, typer.Option(parser=number(0.0), metavar="M", help="Wall time between checkpoints.")
]
Ranks = Annotated[
    int | None,
    typer.Option(
        parser=whole(1, 100_000),
        metavar="N",
        help="MPI ranks on this machine; or start with mpiexec.",
    ),
]
Figures = Annotated[bool, typer.Option(help="Draw the figures at the end.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the summary as JSON.")]
Directory = Annotated[Path, typer.Argument(metavar="DIR", help="Output folder of a run.")]
