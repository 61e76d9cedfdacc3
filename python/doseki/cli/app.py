"""The command line: its options and its commands, in the order of --help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from .exporting import export
from .project import bench, list_scenarios, new, validate
from .results import census, loads, maps, plot, report
from .simulate import check, explain, resume, run
from .studies import compare, study, trust

_debug = False  # set by --debug

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Debris flows by smoothed particle hydrodynamics: water and rock solved as continua.",
    epilog="Exit codes: 0 done, 1 a validation case fails, 2 bad input, 3 physics went wrong,"
    " 4 out of memory or disk. The tests: ./doseki test.",
)


def _version(value: bool) -> None:
    if value:
        from ..version import version

        typer.echo(f"doseki {version()}")
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


COMMANDS: dict[str, Callable[..., None]] = {
    "run": run,
    "check": check,
    "resume": resume,
    "explain": explain,
    "trust": trust,
    "study": study,
    "plot": plot,
    "report": report,
    "compare": compare,
    "census": census,
    "maps": maps,
    "loads": loads,
    "export": export,
    "list": list_scenarios,
    "new": new,
    "bench": bench,
    "validate": validate,
}
for name, command in COMMANDS.items():
    app.command(name)(command)


def wants_tracebacks() -> bool:
    """Whether --debug was given."""
    return _debug
