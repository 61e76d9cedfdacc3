"""The command line: its options, its commands in the order of --help, its errors."""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .. import __version__
from ..errors import DosekiError, ResourceError
from .project import bench, list_scenarios, validate
from .ranks import joined
from .results import census, export, plot
from .simulate import check, explain, resume, run
from .studies import compare, trust

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


COMMANDS: dict[str, Callable[..., None]] = {
    "run": run,
    "check": check,
    "resume": resume,
    "explain": explain,
    "trust": trust,
    "plot": plot,
    "compare": compare,
    "census": census,
    "export": export,
    "list": list_scenarios,
    "bench": bench,
    "validate": validate,
}
for name, command in COMMANDS.items():
    app.command(name)(command)


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
        if ranks := joined():
            ranks.fail(text, exit_code, lambda line: print(f"doseki: {line}", file=error_stream))
        typer.echo(f"doseki: {text}", err=True)
        sys.exit(exit_code)
    finally:
        if ranks := joined():
            ranks.done()


def _is_silent() -> bool:
    """Whether another rank prints what is to be printed."""
    from ..parallel.launch import launched_rank

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
