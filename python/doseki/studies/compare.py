"""`doseki compare flume`: the paper's scheme and the resolved one side by side, on one page."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ..errors import UserError
from ..figures.census import draw_classes, draw_speed_histogram
from ..figures.kinds.moments import spread
from ..figures.kinds.panels import Panels
from ..figures.kinds.series import draw_curves
from ..figures.kinds.snapshot import draw_panels
from ..figures.layout import chart_grid, figure_legend
from ..figures.nothing import NothingToDrawError
from ..figures.saving import Drawn
from ..measure.moments import Moment
from ..measure.views import before_flow, named_window, with_flow
from ..record.beginning import check_vacant
from ..record.reader import Run, load
from ..record.writer import jsonable
from ..running.runner import RunOptions
from ..scenario.load import load_scenario
from ..scenario.schemes import RESOLVED, UETA2022
from ..util.files import clear_errors, write_whole_text
from ..util.spelling import suggestion
from ..validate.judging import PASS, Row
from .flume_criteria import (
    CRITERIA,
    LOAD,
    NOT_MEASURED,
    OUTLET,
    SPEED,
    FlumeRun,
    measure_flume,
    verdicts,
)
from .in_turn import run_in_turn

COMPARISONS = ("flume",)
SCHEMES = (UETA2022, RESOLVED)
NO_WATER = "no water came to the slope end"
NOT_HERE = (
    "Not measured here: change with resolution, sound speed and xi (`doseki trust flume --vary xi`,"
    " `--set dp=...`), and contact, drag and numerical viscosity by themselves (`doseki validate`)."
)


@dataclass(frozen=True)
class Comparison:
    """Both runs measured and judged."""

    flumes: tuple[FlumeRun, ...]
    rows: tuple[list[Row], ...]
    drawn: Drawn = field(default_factory=Drawn)

    def text(self) -> str:
        """The table of verdicts, Markdown."""
        heads = ["the experiment", "taken to agree"]
        for flume in self.flumes:
            heads += [flume.scheme, ""]
        lines = [_line(heads), _line(["---"] * len(heads))]
        for criterion, *found in zip(CRITERIA, *self.rows, strict=True):
            unit = f" ({criterion.unit})" if criterion.unit else ""
            cells = [f"{criterion.quantity}{unit}: {criterion.reason}", str(criterion.bands[0])]
            for row in found:
                cells += _found(row)
            lines.append(_line(cells))
        return "\n".join(lines)


def _found(row: Row) -> list[str]:
    """The number and the verdict of a row."""
    if row.value is None or row.verdict == NOT_MEASURED:
        return ["", NOT_MEASURED]
    return [f"{row.value.number:.3g}", "met" if row.verdict == PASS else "**missed**"]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def check_name(name: str) -> None:
    """Raise UserError for a comparison that there is not."""
    if name not in COMPARISONS:
        raise UserError(f"{name!r} cannot be compared{suggestion(name, COMPARISONS)}")


def run_both(
    name: str,
    settings: Sequence[str],
    directory: Path,
    options: RunOptions,
    tell: Callable[[str], None],
) -> list[Path]:
    """Run the scenario in both schemes into DIR/SCHEME; nothing is run where one has a mistake.

    Raises Interrupted where one of them is stopped.
    """
    scenarios = [load_scenario(name, [*settings, f"scheme={scheme}"]) for scheme in SCHEMES]
    folders = [directory / scheme for scheme in SCHEMES]
    check_vacant(directory)
    with clear_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
    runs = dict(zip(folders, scenarios, strict=True))
    run_in_turn(runs, options, lambda folder: tell(f"{name}: {folder.name}"))
    return folders


def compare_runs(folders: Sequence[Path], directory: Path) -> Comparison:
    """Measure two runs, one of each scheme, and write the page into `directory`.

    Leaves comparison.md, comparison.json and pictures.  Raises UserError where the runs are not one
    of each scheme, or not of the flume.
    """
    runs = sorted((load(folder) for folder in folders), key=lambda run: SCHEMES.index(_scheme(run)))
    found = [_scheme(run) for run in runs]
    if found != list(SCHEMES):
        raise UserError(f"need one run of each scheme, {' and '.join(SCHEMES)}; not {found}")
    flumes = tuple(measure_flume(run) for run in runs)
    with clear_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
    drawn = _draw_pictures(flumes, directory)
    comparison = Comparison(flumes, tuple(verdicts(flume) for flume in flumes), drawn)
    write_whole_text(directory / "comparison.md", _page(comparison))
    write_whole_text(directory / "comparison.json", json.dumps(_table(comparison), indent=1) + "\n")
    return comparison


def _draw_pictures(flumes: Sequence[FlumeRun], directory: Path) -> Drawn:
    drawn = Drawn()
    drawn.add(directory / "water.png", lambda: _water_figure(flumes))
    drawn.add(directory / "passed.png", lambda: _passed_figure(flumes))
    for flume in flumes:
        for key, draw in _DRAW.items():
            drawn.add(directory / f"{flume.scheme}-{key}.png", partial(draw, flume))
    return drawn


def _scheme(run: Run) -> str:
    return run.scenario.get("scheme", UETA2022)


def _table(comparison: Comparison) -> object:
    flumes = zip(comparison.flumes, comparison.rows, strict=True)
    return jsonable(
        {
            flume.scheme: {
                "run": str(flume.run.directory),
                "arrival": flume.arrival,
                "rows": [row.table() for row in rows],
                "sample_mean": [flume.speeds.sample_means.mean(), flume.speeds.sample_means.std()]
                if len(flume.speeds.speeds)
                else None,
            }
            for flume, rows in flumes
        }
    )


FIGURES = {
    "fig5": "Fig. 5: speed of the grains near the slope end, while water runs there",
    "fig6": "Fig. 6: slope end before the flow",
    "fig7": "Fig. 7: slope end with the flow",
    "fig8": "Fig. 8: debris load at the start, in the middle and at the end",
    "classes": "Classes of grains",
}


def _draw_speeds(flume: FlumeRun) -> Figure:
    return draw_speed_histogram(flume.speeds, f"{flume.scheme}: slope end")


def _draw_before(flume: FlumeRun) -> Figure:
    outlet = named_window(flume.run, OUTLET)
    return _draw_outlet(flume, Moment(before_flow(flume.run, outlet), "before the flow"))


def _draw_during(flume: FlumeRun) -> Figure:
    if math.isnan(flume.arrival):
        raise NothingToDrawError(NO_WATER)
    outlet = named_window(flume.run, OUTLET)
    return _draw_outlet(flume, Moment(with_flow(flume.run, outlet), "with the flow"))


def _draw_outlet(flume: FlumeRun, moment: Moment) -> Figure:
    outlet = named_window(flume.run, OUTLET)
    what = Panels(outlet, ["material", "velocity_x"], flume.scheme)
    return draw_panels(flume.run, [moment], what)


def _draw_load(flume: FlumeRun) -> Figure:
    run = flume.run
    what = Panels(named_window(run, LOAD), ["material"], flume.scheme)
    return draw_panels(run, spread(run, 3), what)


_DRAW: dict[str, Callable[[FlumeRun], Figure]] = {
    "fig5": _draw_speeds,
    "fig6": _draw_before,
    "fig7": _draw_during,
    "fig8": _draw_load,
    "classes": lambda flume: draw_classes(flume.census),
}


def _water_figure(flumes: Sequence[FlumeRun]) -> Figure:
    if all(math.isnan(flume.arrival) for flume in flumes):
        raise NothingToDrawError(NO_WATER)
    figure, grid = chart_grid(1, 1, (7.0, 3.0), "Mean velocity of the water at the slope end")
    for flume in flumes:
        draw_curves(grid[0, 0], flume.flow.times, {flume.scheme: flume.water})
    figure_legend(figure, grid.flat)
    grid[0, 0].axhspan(*_band(SPEED), alpha=0.15, color="black")
    grid[0, 0].set(xlabel="time (s)", ylabel="m/s; grey: measured")
    return figure


def _passed_figure(flumes: Sequence[FlumeRun]) -> Figure:
    figure, grid = chart_grid(1, 1, (7.0, 3.0), "Share of the load past the outlet")
    for flume in flumes:
        share = flume.census.share(flume.census.passed(0.0))
        draw_curves(grid[0, 0], flume.census.times, {flume.scheme: share})
    figure_legend(figure, grid.flat)
    grid[0, 0].set(xlabel="time (s)", ylabel="share", ylim=(0, 1.02))
    return figure


def _band(quantity: str) -> tuple[float, float]:
    bands = (c.bands[0] for c in CRITERIA if c.quantity == quantity)
    band = next(band for band in bands if band is not None)
    return band.low, band.high


def _page(comparison: Comparison) -> str:
    parts = ["# The flume of the paper in both schemes", comparison.text(), NOT_HERE]
    drawn = {path.stem for path in comparison.drawn.pictures}
    parts += [f"![{name}]({name}.png)" for name in ("water", "passed") if name in drawn]
    for key, caption in FIGURES.items():
        names = [f"{flume.scheme}-{key}" for flume in comparison.flumes]
        parts += [f"## {caption}", *(f"![{name}]({name}.png)" for name in names if name in drawn)]
    parts += [f"{text}." for text in (*comparison.drawn.notes, *comparison.drawn.remarks)]
    for flume in comparison.flumes:
        parts.append(f"{flume.scheme}: {_about(flume)}")
    return "\n\n".join(parts) + "\n"


def _about(flume: FlumeRun) -> str:
    scenario, speeds = flume.run.scenario, flume.speeds
    text = (
        f"dp = {scenario['dp']:.4g} m, {len(np.unique(flume.census.table['id']))} grains, to "
        f"{flume.census.times[-1]:g} s; "
    )
    came = math.isfinite(flume.arrival)
    text += f"water in the window from {flume.arrival:.3g} s on" if came else NO_WATER
    if len(speeds.speeds):
        text += (
            f"; grains there: mean {speeds.speeds.mean():.3g} m/s, means of {speeds.size} random "
            f"grains {speeds.sample_means.mean():.3g} +- {speeds.sample_means.std():.2g} m/s"
        )
    return text + "."
