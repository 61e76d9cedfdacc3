"""Records in Python: `doseki.load`, and what a record can become."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..errors import UserError
from ..record.quantities import check_quantity
from ..record.reader import Run as RecordedRun
from ..record.reader import load as recorded
from ..record.units import unit_in
from ..util.spelling import suggestion
from .arguments import path_of
from .frames import GaugeTable, HistoryTable, frame_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .datasets import Times


def load(directory: str | os.PathLike[str]) -> Run:
    """The run recorded in `directory`, also one that is still going on.

    Nothing but the names of its files is read until it is asked for.  Raises UserError where there
    is no run.
    """
    return Run(recorded(path_of(directory, "directory")).folder)


class Run(RecordedRun):
    """A recorded run: a sequence of snapshots in order of time, with history, gauges and scenario.

    `run[-1]` and `run.at(1.5)` (s) are snapshots: mappings from field name to array, such as
    `run[-1]["velocity"]`, (N, dim), m/s.  `run.times` (T,) are their times, s; `run.scenario` is
    the effective scenario, `run.summary` what the run came to, `run.trust` how far to trust it.
    """

    @cached_property
    def history(self) -> HistoryTable:
        """The diagnostics: totals over time, by the names of the columns in docs/output.md."""
        return self._history(HistoryTable)

    @cached_property
    def gauges(self) -> Mapping[str, GaugeTable]:
        """What the gauges read, by their names: each a mapping from column to array (N,)."""
        return self._gauges(GaugeTable)

    def __repr__(self) -> str:
        status = self.summary.get("status", "going on")
        return f"<doseki.Run {self.directory}: {len(self)} snapshots, {status}>"

    def to_xarray(self, fields: Sequence[str] | None = None, times: Times = None) -> xr.Dataset:
        """The particles as a Dataset over `time`, s, and `particle`, their ids in order.

        `fields`: names as in a snapshot; default: position, velocity, density, pressure and mass.
        `times`: a time, several, or slice(start, end) with both ends, s; default: all snapshots.
        A vector has a further dimension `axis` ("x", "y", "z"), a tensor `row` and `column`.
        Particles may enter and leave: where one is not there, `present` is false and numbers are
        nan (whole numbers -1).  `material` and `body` are names by particle.  `attrs` have
        `units` and `long_name`.

        Raises UserError for an unknown field, a time outside the record, or where xarray is not
        installed, and ResourceError before it fills the memory.
        """
        from .datasets import particles_dataset

        return particles_dataset(self, fields, times)

    def to_pandas(self, fields: Sequence[str] | None = None, times: Times = None) -> pd.DataFrame:
        """The particles as a DataFrame with a row for each particle and time.

        Columns: time, s, id, material, body, and the fields, vectors by component: velocity_x.
        `fields` and `times` are those of `to_xarray`; `attrs["units"]` has the units.  Raises as
        to_xarray does.
        """
        from .datasets import particles_frame

        return particles_frame(self, fields, times)

    @property
    def grains(self) -> pd.DataFrame:
        """The census of the grains as a DataFrame with a row for each grain and time.

        Columns: time, s, grain (a number that stays with it), class (waiting, preceding, carried,
        floating, rolling, deposited: docs/census.md), position_x ..., m, velocity_x ..., speed,
        m/s, spin_x ... (2-D: spin_z), rad/s, contacts, diameter, m, mass, kg (2-D: kg/m), origin
        (load; structure: has come off one).
        `attrs["units"]` has the units.  Raises UserError for a run without grains, or where pandas
        is not installed.
        """
        return _census_frame(self)

    def plot(
        self,
        colour: str = "material",
        time: float | None = None,
        *,
        ax: Axes | None = None,
        window: str | None = None,
        material: str | None = None,
    ) -> Axes:
        """Draw the particles at a time, s (default: the last snapshot), true to scale.

        `colour`: material, body, speed, or a field or component such as pressure, velocity_x,
        stress_xy; `window`: a [window.NAME] of the scenario; `material`: only this one.  In 3-D it
        is a thin slice through the middle; `figure("overview")` has views in space.

        Draws on `ax`, or on a new figure of matplotlib.pyplot; returns the axes.  Raises UserError
        for what is not there.
        """
        return _draw(self, (colour, window, material), time, ax)

    @property
    def figures(self) -> list[str]:
        """Names of the figures that `doseki plot` draws of this run."""
        from ..figures.plot import figure_names

        return figure_names(self)

    def figure(self, name: str = "overview") -> Figure:
        """One of `figures`, drawn now; `.savefig("file.png")` keeps it.

        Raises UserError for another name, and where there is nothing to draw.
        """
        from ..figures.plot import make_figure

        return make_figure(self, name)


def _draw(
    run: Run, what: tuple[str, str | None, str | None], time: float | None, ax: Axes | None
) -> Axes:
    from ..figures.panel import draw_panel, panel_extent, panel_size
    from ..measure.views import named_window

    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot to draw")
    colour, window, material = what
    snapshot = run[-1] if time is None else run.at(time)
    check_quantity(colour, snapshot.dim)
    if material is not None and material not in snapshot.material_names:
        near = suggestion(material, snapshot.material_names)
        raise UserError(f"{run.directory}: no material is called {material!r}{near}")
    view = named_window(run, window)
    if ax is None:
        from matplotlib import pyplot

        size = panel_size(panel_extent(snapshot, view))
        _, ax = pyplot.subplots(figsize=size, layout="constrained")
    draw_panel(ax, run, snapshot, colour, view, material)
    return ax


def _census_frame(run: Run) -> pd.DataFrame:
    from ..measure.census.census import CLASSES, take_census

    dim = int(run.scenario["dim"])
    units = {"time": "s", "grain": "", "class": ""}
    frame_of({}, {})  # without pandas there is no use in a census
    table = take_census(run).table
    columns = {
        "time": table["time"],
        "grain": table["id"],
        "class": np.array(CLASSES)[table["kind"]],
    }
    for name, unit in (("position", "m"), ("velocity", "m/s")):
        columns |= {f"{name}_{axis}": table[name][:, k] for k, axis in enumerate("xyz"[:dim])}
        units |= {f"{name}_{axis}": unit for axis in "xyz"[:dim]}
    columns["speed"], units["speed"] = np.linalg.norm(table["velocity"], axis=1), "m/s"
    for k, axis in enumerate("xyz"):
        if dim == 3 or axis == "z":
            columns[f"spin_{axis}"], units[f"spin_{axis}"] = table["spin"][:, k], "rad/s"
    columns |= {name: table[name] for name in ("contacts", "diameter", "mass")}
    columns["origin"] = np.where(table["is_load"], "load", "structure")
    frame = frame_of(
        columns, units | {"contacts": "", "origin": "", "diameter": "m", "mass": unit_in("kg", dim)}
    )
    frame["class"] = frame["class"].astype("category").cat.set_categories(list(CLASSES))
    return frame
