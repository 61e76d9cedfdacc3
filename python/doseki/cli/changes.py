"""A word about what was changed by hand in the folder of a run, before a command reads it."""

from __future__ import annotations

from pathlib import Path

import typer


def warn_of_changes(directory: Path) -> None:
    """Say so on stderr where the scenario of a run is not the one that was run."""
    from ..record.folder import RunFolder
    from ..util.sealed import changed_by_hand

    scenario = RunFolder(directory).scenario
    if scenario.is_file() and (said := changed_by_hand(scenario)):
        typer.echo(f"warning: {said}", err=True)
