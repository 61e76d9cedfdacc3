"""What a picture of a run shows, in words."""

from __future__ import annotations

from collections.abc import Mapping

from ...measure.advance import goes_along_x
from ...measure.maps.quantities import QUANTITIES
from ...measure.views import tables
from ...record.reader import Run
from ...scenario.gauges.gauge import Gauge
from ...scenario.tables.figure import (
    DepthFigure,
    Figure,
    GaugeFigure,
    HistogramFigure,
    LoadFigure,
    SeriesFigure,
    SnapshotFigure,
)

GENERAL = {
    "overview": "Overview: the start, the arrival of the flow, its peak and the end",
    "energy": "Energy over time",
    "mass": "Mass over time",
    "flow": "The front of the flow and what windows show, over time",
}
WAY = "How far the front has come from where the flow began, and what windows show, over time"
Captions = Mapping[str, str]  # by the names of pictures


def of_figures(run: Run) -> Captions:
    """Of the figures of a run: the title that the scenario gives, or what they show."""
    gauges = tables(run, "gauge", Gauge)
    requested = tables(run, "figure", Figure)
    shown = {name: each.title or _shown(each, gauges) for name, each in requested.items()}
    general = GENERAL if goes_along_x(run) else GENERAL | {"flow": WAY}
    return {**general, **shown}


def of_maps() -> Captions:
    """Of maps: what is mapped, and its unit."""
    return {each.name: _sentence(f"{each.label} ({each.unit})") for each in QUANTITIES}


def words(name: str) -> str:
    """A name of a file or a kind as words."""
    return name.replace("_", " ").replace("-", " ")


def _shown(figure: Figure, gauges: Mapping[str, Gauge]) -> str:
    """What a figure without a title shows."""
    match figure:
        case SnapshotFigure():
            return f"Particles by {_listed(figure.colour)}"
        case HistogramFigure():
            return f"Speeds of {figure.material or 'particles'}"
        case SeriesFigure():
            return _sentence(f"{_listed(figure.columns)} over time")
        case GaugeFigure() | LoadFigure() if figure.gauge in gauges:
            return f"Gauge {figure.gauge}: {words(gauges[figure.gauge].kind)}"
        case DepthFigure():
            return "Depth of the flow along a line, over time"
    return words(figure.kind)


def _listed(names: list[str]) -> str:
    *first, last = map(words, names)
    return f"{', '.join(first)} and {last}" if first else last


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]
