"""What a page of the gallery says, and what it reads from the record of its run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from doseki.record.reader import Run


@dataclass(frozen=True)
class Number:
    """A key number of a run: what it is, its value and unit.

    `beside` is what a formula or a measurement has in its place, `source` which one; without them
    the number stands alone.
    """

    what: str
    value: float
    unit: str = ""
    beside: float | None = None
    source: str = ""


@dataclass(frozen=True)
class Line:
    """A line of a chart: x and y (n,); `points` draws dots, as of measurements."""

    label: str
    x: np.ndarray
    y: np.ndarray
    points: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart that no [figure.NAME] of the scenario can draw."""

    title: str
    axes: tuple[str, str]
    lines: Sequence[Line]


@dataclass(frozen=True)
class Film:
    """How the run is shown in motion: the colour, the window of the scenario, the playing speed."""

    colour: str = "speed"
    window: str | None = None
    frames_per_second: int = 15
    width: int = 480  # pixels of what is shown


@dataclass(frozen=True)
class Page:
    """A page: a shipped scenario, how it is run, and what is shown and said of it.

    `figures` are those of the run by name, `then` are command lines to try next, each with what
    it shows.
    """

    scenario: str
    teaches: str
    numbers: Callable[[Run], list[Number]]
    figures: tuple[str, ...]
    then: Sequence[tuple[str, str]]
    settings: tuple[str, ...] = ()
    chart: Callable[[Run], Chart] | None = None
    film: Film | None = field(default_factory=Film)
