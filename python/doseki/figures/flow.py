"""The flow over time: where its front is, how fast water and grains are, what has passed."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ..measure.flow import Flow
from ..record.reader import Run
from ..record.units import unit_in
from .kinds.series import draw_curves
from .layout import chart_grid, figure_legend, lengths_in_full, name_of_curves, say_where_empty

PANEL = (7.0, 2.0)  # inches

MEASURES = (  # attribute of WindowFlow, what it is, its unit in 3-D
    ("fluid_velocity", "mean velocity x of the fluid", "m/s"),
    ("grain_speed", "mean speed of grains", "m/s"),
    ("grain_mass", "mass of grains", "kg"),
    ("passed_mass", "grains passed", "kg"),
)


def draw_flow(run: Run, flow: Flow) -> Figure:
    """One panel for the front, and one for each thing that windows show."""
    label = "front of the fluid (m)" if flow.along_x else "way of the front (m)"
    panels = {label: {"": flow.front}} | _window_panels(run, flow)
    figure, grid = chart_grid(len(panels), 1, PANEL, "The flow over time")
    for axes, (label, curves) in zip(grid[:, 0], panels.items(), strict=True):
        draw_curves(axes, flow.times, curves)
        name_of_curves(axes, label, PANEL[1])
        say_where_empty(axes, flow.times)
    lengths_in_full(grid[0, 0], "y")
    grid[-1, 0].set_xlabel("time (s)")
    figure_legend(figure, grid.flat)
    return figure


def _window_panels(run: Run, flow: Flow) -> dict[str, dict[str, np.ndarray]]:
    """Curves of every window by the label of the axis, but of those that nothing has reached.

    Each window has one colour throughout.
    """
    windows = {name: w for name, w in flow.windows.items() if any(w.fluid_count + w.grain_count)}
    panels = {}
    for attribute, meaning, unit in MEASURES:
        curves = {name: np.array(getattr(w, attribute)) for name, w in windows.items()}
        if any(np.any(np.nan_to_num(curve)) for curve in curves.values()):
            label = f"{meaning} ({unit_in(unit, run.scenario['dim'])})"
            panels[label] = curves
    return panels
