"""How signals end a command, but for the steps of a run, which end in good order."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial

from ..errors import Interrupted
from ..parallel.launch import is_rank

WORDS = {signal.SIGINT: "interrupted", signal.SIGTERM: "terminated", signal.SIGHUP: "hung up"}


@contextmanager
def leaving_at_once() -> Iterator[None]:
    """What would end the process ends it with a word: imports would answer with a traceback."""
    with _asked_to_end(lambda number: _leave(_ended_by(number))):
        yield


@contextmanager
def interruptible() -> Iterator[None]:
    """What would end the process raises Interrupted: files and the terminal are left in order.

    The second signal ends the process, should the first have come where nothing can be raised.
    """
    interrupts: list[Interrupted] = []

    def answer(number: int) -> None:
        if interrupts:
            _leave(interrupts[0])
        interrupts.append(_ended_by(number))
        raise interrupts[0]

    with _asked_to_end(answer):
        yield


def _ended_by(number: int) -> Interrupted:
    """What a signal is called, with the exit code that shells give it."""
    number = signal.SIGINT if is_rank() else number  # a rank is told of Ctrl-C by SIGTERM
    return Interrupted(WORDS[signal.Signals(number)], 128 + number)


@contextmanager
def _asked_to_end(answer: Callable[[int], None]) -> Iterator[None]:
    """Let `answer` answer what would end the process."""
    with ExitStack() as answers:
        for number in WORDS:
            answers.enter_context(_answering(partial(answer, number), number))
        yield


@contextmanager
def ending_early() -> Iterator[None]:
    """What would end the process raises Interrupted, so that a finished run gets its summary."""
    with ExitStack() as answers:
        for number in (signal.SIGTERM, signal.SIGHUP):
            answers.enter_context(_answering(partial(_interrupt, number), number))
        yield


def _interrupt(number: int) -> None:
    raise _ended_by(number)


@contextmanager
def _answering(answer: Callable[[], None], number: int) -> Iterator[None]:
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
    with suppress(OSError):  # the terminal may be gone
        os.write(2, f"doseki: {error}\n".encode())
    os._exit(error.exit_code)
