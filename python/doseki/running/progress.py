"""The progress of a run: a bar with percentage and finish time, or plain lines in a log."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, TaskProgressColumn, TextColumn
from rich.progress import Progress as RichProgress

from ..driver.active_run import Progress
from ..util.telling import Tell

LOG_SECONDS = 15.0  # between lines where there is no terminal


class FinishTime:
    """When a run that has come so far will be done, from its speed until now."""

    def __init__(self, time_max: float) -> None:
        self.time_max = time_max
        self.started = time.monotonic()
        self.first: float | None = None  # s simulated when it was first asked

    def text(self, simulated: float) -> str:
        """Clock time of the end, with the date when that is not today."""
        if self.first is None:
            self.first, self.started = simulated, time.monotonic()
        if simulated <= self.first:
            return "--:--"
        elapsed = time.monotonic() - self.started
        left = elapsed * (self.time_max - simulated) / (simulated - self.first)
        end = datetime.now() + timedelta(seconds=min(left, 1e9))
        return end.strftime("%H:%M:%S" if end.date() == datetime.now().date() else "%Y-%m-%d %H:%M")


@dataclass(frozen=True)
class Display:
    """Shows how far a run has come, and before it the work that goes before its first step."""

    update: Progress
    tell: Tell

    def __call__(self, simulated: float, timestep: float, step: int) -> None:
        """Show time, s, time step, s, and number of steps."""
        self.update(simulated, timestep, step)


def _bar(progress: RichProgress, title: str, time_max: float) -> Display:
    task = progress.add_task(title, total=time_max, finish="--:--", at="")
    finish = FinishTime(time_max)

    def update(simulated: float, timestep: float, step: int) -> None:
        at = f"t = {simulated:.4g}/{time_max:g} s, dt = {timestep:.2e} s, step {step}"
        progress.update(task, completed=simulated, finish=finish.text(simulated), at=at)

    def tell(text: str) -> None:
        progress.update(task, at=text)

    return Display(update, tell)


def log_lines(console: Console) -> Tell:
    """Prints a text where the last one was printed some time ago."""
    last = time.monotonic()

    def tell(text: str) -> None:
        nonlocal last
        if time.monotonic() - last >= LOG_SECONDS:
            last = time.monotonic()
            console.print(text, highlight=False, markup=False)

    return tell


def _lines(console: Console, time_max: float) -> Display:
    finish = FinishTime(time_max)
    tell = log_lines(console)

    def update(simulated: float, timestep: float, step: int) -> None:
        tell(
            f"{100 * simulated / time_max:5.1f} %  t = {simulated:.4g} s  dt = {timestep:.2e} s"
            f"  step {step}  finish time {finish.text(simulated)}"
        )

    return Display(update, tell)


@contextmanager
def work_shown() -> Iterator[Tell]:
    """What shows on standard error how far the work has come that goes before a first step."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield log_lines(console)
        return
    with console.status("") as status:
        yield lambda text: status.update(escape(text))


@contextmanager
def progress_bar(title: str, time_max: float) -> Iterator[Display]:
    """A function of (time, timestep, step) that shows the progress on standard error."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _lines(console, time_max)
        return
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("finish time {task.fields[finish]}"),
        TextColumn("{task.fields[at]}"),
    )
    with RichProgress(*columns, console=console) as progress:
        yield _bar(progress, title, time_max)
