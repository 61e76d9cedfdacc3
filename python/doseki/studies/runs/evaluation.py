"""Runs at points, wherever they are carried out: what is there is not run again."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Protocol

from ...assess.summary import duration_text
from ...errors import UserError
from ..plan.sampling import Point
from .folder import RunPlace, StudyRuns
from .local import Finished
from .row import FAILED, LOST, Row, write_row

Tell = Callable[[str], None]


class Engine(Protocol):
    """What carries out runs."""

    at_once: int

    def carry_out(self, places: Sequence[RunPlace], finished: Finished) -> None:
        """Run all; `finished` is called as each ends."""


class StoppedError(UserError):
    """A file STOP has ended the study; it goes on where it was."""


class Evaluation:
    """Gives the rows of points, and runs what is missing."""

    def __init__(self, runs: StudyRuns, engine: Engine, tell: Tell, retry: bool = False) -> None:
        """`retry`: runs that failed in an earlier session are made again, once."""
        self.runs, self._engine, self._tell = runs, engine, tell
        self._rows: dict[RunPlace, Row] = {}
        self._points: dict[RunPlace, Point] = {}
        self._retry = retry
        self.made = 0  # runs of this session

    def rows(self, points: Sequence[Point]) -> list[Row]:
        """A row for each point, in their order; raises StoppedError where a file STOP ends it."""
        places = [self.runs.place(point) for point in points]
        self._points |= dict(zip(places, points, strict=True))
        missing = [place for place in dict.fromkeys(places) if self._row(place) is None]
        if missing:
            self._carry_out(missing)
        return [self._rows[place] for place in places]

    def known(self) -> dict[RunPlace, Row]:
        """Every run that was asked for, with its row."""
        return dict(self._rows)

    def point_of(self, place: RunPlace) -> Point:
        """At which point a run that was asked for is."""
        return self._points[place]

    def _row(self, place: RunPlace) -> Row | None:
        """What is known of a run; None where it is to be made."""
        if place in self._rows:
            return self._rows[place]
        row = self.runs.row(place)
        if row is None:
            return None
        if row.status == LOST or (row.status == FAILED and self._retry):
            place.row.unlink()
            return None
        self._rows[place] = row
        return row

    def _carry_out(self, places: Sequence[RunPlace]) -> None:
        started, done = time.monotonic(), 0

        def finished(place: RunPlace, reason: str) -> None:
            nonlocal done
            done += 1
            self._finish(place, reason)
            elapsed = time.monotonic() - started
            self._tell(_progress(done, len(places), elapsed, self._rows[place], place))

        self._engine.carry_out(places, finished)
        if any(place not in self._rows for place in places):
            raise StoppedError(
                f"{self.runs.folder.stop} has stopped the study after {done} of {len(places)} runs;"
                " remove it and start again to go on"
            )

    def _finish(self, place: RunPlace, reason: str) -> None:
        """Take the row of a run that has ended, or say that it was lost."""
        row = self.runs.row(place)
        if row is None:
            row = Row(LOST, self.runs.reading, reason)
            write_row(place.row, row)
        self.made += 1
        self._rows[place] = row


def _progress(done: int, count: int, elapsed: float, row: Row, place: RunPlace) -> str:
    """A line about the run that has just ended."""
    left = elapsed / done * (count - done)
    score = f", score {row.score:.4g}" if row.score == row.score else ""
    why = f": {row.reason}" if row.reason else ""
    remaining = f"; about {duration_text(left)} left" if count > done else ""
    return f"{done} of {count}  run {place.number:04d} {row.status}{score}{why}{remaining}"
