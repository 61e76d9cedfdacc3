"""How signals end a command, but for the steps of a run, which end in good order."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

from ..errors import Interrupted
from ..parallel.launch import is_rank


@contextmanager
def leaving_at_once() -> Iterator[None]:
    """Ctrl-C ends the process: imports, which this is for, would answer it with a traceback."""
    with _asked_to_end(lambda: _leave(Interrupted())):
        yield


@contextmanager
def interruptible() -> Iterator[None]:
    """Ctrl-C raises Interrupted, so that files and the terminal are left in order.

    The second one ends the process, should the first have come where nothing can be raised.
    """
    interrupts: list[Interrupted] = []

    def answer() -> None:
        if interrupts:
            _leave(interrupts[0])
        interrupts.append(Interrupted())
        raise interrupts[0]

    with _asked_to_end(answer):
        yield


@contextmanager
def _asked_to_end(answer: Callable[[], None]) -> Iterator[None]:
    """Let `answer` answer Ctrl-C; a rank is told of that by SIGTERM (parallel.starter)."""
    with ExitStack() as answers:
        for number in (signal.SIGINT, *([signal.SIGTERM] if is_rank() else [])):
            answers.enter_context(_answering(answer, number))
        yield


@contextmanager
def ending_early() -> Iterator[None]:
    """What would end the process raises Interrupted, so that a finished run gets its summary."""
    with _answering(_interrupt, signal.SIGTERM), _answering(_interrupt, signal.SIGHUP):
        yield


def _interrupt() -> None:
    raise Interrupted


@contextmanager
def _answering(answer: Callable[[], None], number: int = signal.SIGINT) -> Iterator[None]:
    """Let `answer` answer a signal, unless it is ignored, as in the background of a script."""
    here = threading.current_thread() is threading.main_thread()  # others may not handle signals
    if not here or signal.getsignal(number) == signal.SIG_IGN:
        yield
        return
    old = signal.signal(number, lambda _number, _frame: answer())
    try:
        yield
    finally:
        signal.signal(number, old)


def _leave(error: Interrupted) -> None:
    """End the process here and now."""
    os.write(2, f"doseki: {error}\n".encode())
    os._exit(error.exit_code)
