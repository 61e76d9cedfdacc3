"""Runs one after the other that are compared: what stops one of them stops all."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import FrameType

from ..driver.schedule import StopRequests, answered
from ..errors import Interrupted
from ..running.runner import RunOptions, run_scenario
from ..scenario.model import Scenario


def run_in_turn(
    scenarios: Mapping[Path, Scenario],
    options: RunOptions,
    tell: Callable[[Path], None] = lambda _folder: None,
) -> None:
    """Run each scenario in its folder; `tell` is called before each.

    Raises Interrupted, naming the run, when a signal comes or a file STOP ends one of them: what
    did not come to its end cannot be compared.
    """
    signals: list[int] = []

    def stops(directory: Path) -> StopRequests:
        asked = StopRequests(directory)
        asked.signals = signals  # a run is done, too, where one comes in its last steps
        return asked

    options = replace(options, stops=stops)
    with _noting(signals):
        for folder, scenario in scenarios.items():
            try:
                tell(folder)
                summary = run_scenario(scenario, folder, options)
            except Interrupted:
                raise _stopped(folder, signals, "") from None
            if signals or summary["status"] != "done":
                raise _stopped(folder, signals, summary.get("stopped_by", ""))


def _stopped(folder: Path, signals: list[int], reason: str) -> Interrupted:
    by = signal.Signals(signals[0]).name if signals else reason
    return Interrupted(f"{folder}: stopped{' by ' if by else ''}{by}; nothing is compared")


@contextmanager
def _noting(signals: list[int]) -> Iterator[None]:
    """Note the signals that come between steps, where reports on a run go without a trace."""
    before: dict[int, object] = {}

    def note(number: int, frame: FrameType | None) -> None:
        signals.append(number)
        handler = before[number]
        if callable(handler):
            handler(number, frame)
        raise Interrupted

    if threading.current_thread() is threading.main_thread():  # others may not handle signals
        heard = {number: signal.getsignal(number) for number in answered()}
        before.update({n: h for n, h in heard.items() if h != signal.SIG_IGN})
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]
