"""Runs from Python: `doseki.run` and `doseki.resume`."""

from __future__ import annotations

import math
import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from numbers import Real
from pathlib import Path
from typing import Any

from ..assess.estimates import step_ends
from ..driver.live import Callback, Watch
from ..driver.schedule import StopRequests
from ..errors import DosekiWarning, UserError
from ..running.progress import progress_bar
from ..running.resume import resume_run
from ..running.runner import RunOptions, run_scenario
from ..scenario.model import Scenario as CheckedScenario
from ..util.files import free_directory
from .arguments import path_of, thread_count, whole_number
from .record import Run, load
from .scenario import Scenario, changes_of


def run(
    scenario: Scenario | str | os.PathLike[str] | Mapping[str, Any],
    directory: str | os.PathLike[str] | None = None,
    *,
    overwrite: bool = False,
    threads: int | None = None,
    callback: Callback | None = None,
    every: float | None = None,
    every_steps: int | None = None,
    progress: bool = True,
    checkpoint_every: float | None = None,
    checkpoint_minutes: float = 10.0,
) -> Run:
    """Simulate a scenario, and return its record.

    `scenario`: a Scenario, or what one is made of.  `directory`: the folder of the record; default:
    runs/NAME, or NAME-2 ... where that is taken.  `overwrite`: replace a run there.  `threads`:
    default all cores; results do not depend on it.  `progress`: show it on standard error.
    `checkpoint_every`, s of simulated time, and `checkpoint_minutes`, of wall time: how often a
    checkpoint is written.

    `callback(view)` is called with a LiveView at the start and then at the first step at or past
    each multiple of `every`, s of simulated time, or of `every_steps` steps; default: of time_out.
    Steps of bodies without water may be longer than `every`, which is warned of.
    The run is the same with and without it, bit for bit.  Where it returns False the run stops in
    good order and can be resumed; an exception in it does the same, and is raised when the record
    is closed.

    Ctrl-C stops the run in good order, too, and is raised as KeyboardInterrupt when the record is
    closed; `summary["status"]` is "done" or "stopped", and `doseki.resume` goes on.  What is
    doubtful about the scenario comes as DosekiWarning.  Raises UserError, PhysicsError (the record
    up to there is kept) and ResourceError.
    """
    made = scenario if isinstance(scenario, Scenario) else Scenario(scenario)
    checked = made.checked
    folder = free_directory(made.name) if directory is None else path_of(directory, "directory")
    wishes = _Wishes(threads, checkpoint_every, checkpoint_minutes, progress)
    wishes.watch = _watch(callback, every, every_steps, checked.time_out)
    _warn_of_long_steps(checked, every)
    with wishes.options(checked.title, checked.time_max, overwrite) as options:
        run_scenario(checked, folder, options)
    wishes.hand_on()
    return load(folder)


def resume(
    directory: str | os.PathLike[str],
    changes: Mapping[str, Any] | None = None,
    *,
    until: float | None = None,
    threads: int | None = None,
    callback: Callback | None = None,
    every: float | None = None,
    every_steps: int | None = None,
    progress: bool = True,
    checkpoint_every: float | None = None,
    checkpoint_minutes: float = 10.0,
) -> Run:
    """Go on with a run that was stopped, killed or failed, from its last checkpoint.

    `changes`: the few keys that may have other values now, such as {"time_max": 5}.  `until`: not
    from a checkpoint later than this, s.  All else is as of `run`.  The record becomes that of a
    run that was never interrupted, bit for bit.  Raises as `run` does, and UserError where there is
    nothing to go on from.
    """
    given = load(directory).scenario
    if until is not None and not until >= 0:
        raise UserError(f"until = {until!r}; allowed: a time in s from 0 on")
    wishes = _Wishes(threads, checkpoint_every, checkpoint_minutes, progress)
    wishes.watch = _watch(callback, every, every_steps, float(given["time_out"]))
    latest = math.inf if until is None else until
    with wishes.options(given.get("title", ""), float(given["time_max"])) as options:
        _, notes = resume_run(Path(directory), changes_of(changes), options, latest)
    for note in notes:
        _warn(note)
    wishes.hand_on()
    return load(directory)


@dataclass
class _Wishes:
    """How a run is to be carried out, and what came of it."""

    threads: int | None
    checkpoint_every: float | None
    checkpoint_minutes: float
    progress: bool
    watch: Watch | None = None
    stops: list[StopRequests] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.threads = thread_count(self.threads)
        self.checkpoint_every = _positive("checkpoint_every", self.checkpoint_every)
        minutes: Any = self.checkpoint_minutes
        if not (isinstance(minutes, Real) and 0 <= float(minutes) < math.inf):
            raise UserError(f"checkpoint_minutes = {minutes!r}; allowed: minutes from 0 on")

    @contextmanager
    def options(self, title: str, time_max: float, overwrite: bool = False) -> Iterator[RunOptions]:
        """The options of a run, while its progress is shown."""
        options = RunOptions(
            self.threads,
            overwrite,
            started=_warn_of,
            checkpoint_every=self.checkpoint_every,
            checkpoint_minutes=self.checkpoint_minutes,
            watch=self.watch,
            stops=self._stop_requests,
        )
        if not self.progress:
            yield options
            return
        with progress_bar(title, time_max) as display:
            options.progress, options.tell = display, display.tell
            yield options

    def _stop_requests(self, directory: Path) -> StopRequests:
        self.stops.append(StopRequests(directory))
        return self.stops[-1]

    def hand_on(self) -> None:
        """Raise what the callback raised; give a signal that stopped the run to whom it was for."""
        if self.watch is not None and self.watch.error is not None:
            raise self.watch.error
        signals = [number for stop in self.stops for number in stop.signals]
        if signals and threading.current_thread() is threading.main_thread():
            signal.raise_signal(signals[0])


def _watch(
    callback: Callback | None, every: float | None, steps: int | None, time_out: float
) -> Watch | None:
    """Who looks on, if anyone."""
    every, steps = _positive("every", every), whole_number("every_steps", steps)
    if callback is None:
        if every is not None or steps is not None:
            raise UserError("every and every_steps say when the callback looks: give a callback")
        return None
    if not callable(callback):
        raise UserError(f"callback = {callback!r}; allowed: a function of one argument, the view")
    return Watch(callback, time_out if every is None and steps is None else every, steps)


def _warn_of_long_steps(scenario: CheckedScenario, every: float | None) -> None:
    """Say that a callback may look less often than it is to, as no step is cut short for it."""
    if every is not None and scenario.has_bodies_alone and every < min(step_ends(scenario)):
        _warn(
            f"every = {every:g} s, but without water steps may be longer, and the callback looks "
            f"after whole ones: give time_history = {every:g}"
        )


def _positive(name: str, value: Any) -> float | None:
    """A time, s, which may be a number of numpy; None stays None."""
    if value is None:
        return None
    number = None if isinstance(value, bool) or not isinstance(value, Real) else float(value)
    if number is None or not 0 < number < math.inf:
        raise UserError(f"{name} = {value!r}; allowed: a number above 0, in s")
    return number


def _warn_of(*started: Any) -> None:
    """Say what is doubtful about a run that is about to begin."""
    *_, doubts = started
    for doubt in doubts:
        _warn(doubt)


def _warn(text: str) -> None:
    """Warn at the line of the program that called doseki."""
    frame, level = sys._getframe(1), 2
    while frame.f_back and str(frame.f_globals.get("__name__")).partition(".")[0] == "doseki":
        frame, level = frame.f_back, level + 1
    warnings.warn(text, DosekiWarning, stacklevel=level)
