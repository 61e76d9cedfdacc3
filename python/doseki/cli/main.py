"""Where every command begins and ends: interrupts, errors, exit codes.

Quick to import, so that an interrupt finds an answer from the first moment on; the commands, and
what they need, come later.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..errors import Interrupted
from .exits import drop_output, flushed_output, prepare_output, said


def main(arguments: list[str] | None = None) -> Any:
    """Entry point: errors become one sentence and an exit code; a traceback only with --debug."""
    with _leaving_at_once():
        from .app import app, wants_tracebacks
        from .ranks import joined

    prepare_output()
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever backend is wished for
    error_stream = sys.stderr
    try:
        if _is_silent():
            sys.stdout = sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115
        with _interruptible(), flushed_output():
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
        sys.exit(exit_code)
    finally:
        if ranks := joined():
            ranks.done()


@contextmanager
def _leaving_at_once() -> Iterator[None]:
    """Ctrl-C ends the process: imports, which this is for, would answer it with a traceback."""
    with _answering(lambda: _leave(Interrupted())):
        yield


@contextmanager
def _interruptible() -> Iterator[None]:
    """Ctrl-C raises Interrupted, so that files and the terminal are left in order.

    The second one ends the process, should the first have come where nothing can be raised.
    """
    interrupts: list[Interrupted] = []

    def answer() -> None:
        if interrupts:
            _leave(interrupts[0])
        interrupts.append(Interrupted())
        raise interrupts[0]

    with _answering(answer):
        yield


@contextmanager
def _answering(answer: Callable[[], None]) -> Iterator[None]:
    """Let `answer` answer SIGINT, unless it is ignored, as in the background of a script."""
    here = threading.current_thread() is threading.main_thread()  # others may not handle signals
    if not here or signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        yield
        return
    old = signal.signal(signal.SIGINT, lambda _number, _frame: answer())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, old)


def _leave(error: Interrupted) -> None:
    """End the process here and now."""
    os.write(2, f"doseki: {error}\n".encode())
    os._exit(error.exit_code)


def _is_silent() -> bool:
    """Whether another rank prints what is to be printed."""
    from ..parallel.launch import launched_rank

    return launched_rank() > 0


if __name__ == "__main__":
    main()
