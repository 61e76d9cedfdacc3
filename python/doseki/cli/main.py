"""Where every command begins and ends: interrupts, errors, exit codes.

Quick to import, so that an interrupt finds an answer from the first moment on; the commands, and
what they need, come later.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from ..errors import DosekiError, Interrupted
from ..parallel.launch import is_rank
from .exits import drop_output, flushed_output, prepare_output, said
from .interrupts import interruptible, leaving_at_once


def main(arguments: list[str] | None = None) -> Any:
    """Entry point: errors become one sentence and an exit code; a traceback only with --debug."""
    _forget_absurd_terminal()
    with leaving_at_once():
        from .app import app, wants_tracebacks
        from .ranks import joined

    prepare_output()
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever backend is wished for
    error_stream = sys.stderr
    try:
        if _is_silent():
            sys.stdout = sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
        with interruptible(), flushed_output():
            return app(arguments)
    except (Exception, Interrupted) as error:
        if wants_tracebacks():
            import traceback

            traceback.print_exc(file=error_stream)
        text, exit_code = said(error)
        if ranks := joined():
            ranks.fail(text, exit_code, lambda line: print(f"doseki: {line}", file=error_stream))
        with suppress(OSError):
            print(f"doseki: {text}", file=sys.stderr)
        drop_output()
        if is_rank() and not joined() and not isinstance(error, DosekiError | Interrupted):
            _leave_the_others(text, error_stream)
        sys.exit(exit_code)
    finally:
        if ranks := joined():
            ranks.done()


def _leave_the_others(text: str, stream: TextIO) -> None:
    """End a rank that has failed by itself, before it joined the others, by a signal.

    MPICH's launcher waits for ever where a rank exits and others wait for it to join them.
    """
    with suppress(OSError):
        print(f"doseki: a rank failed before it joined the others: {text}", file=stream, flush=True)
    os.kill(os.getpid(), signal.SIGKILL)


def _forget_absurd_terminal() -> None:
    """Let the terminal be measured where the environment gives it no possible size.

    Text is set to that width, whatever memory it takes.
    """
    for name in ("COLUMNS", "LINES"):
        size = os.environ.get(name, "")
        if not (size.isascii() and size.isdigit() and len(size) <= 4):
            os.environ.pop(name, None)


def _is_silent() -> bool:
    """Whether another rank prints what is to be printed."""
    from ..parallel.launch import launched_rank

    return launched_rank() > 0


if __name__ == "__main__":
    main()
