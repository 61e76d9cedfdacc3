"""The flow over time: where its front is, how fast water and grains are, what has passed."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from .figure_series import draw_curves
from .flow import Flow
from .layout import chart_grid
from .load import Run


def draw_flow(run: Run, flow: Flow) -> Figure:
    """One panel for the front, and one for each thing that windows show."""
    per_metre = "/m" if run.scenario["dim"] == 2 else ""
    panels = {"front of the fluid, x (m)": {"front": flow.front}}
    for label, attribute in (
        ("mean $v_x$ of the fluid (m/s)", "fluid_velocity"),
        ("mean speed of grains (m/s)", "grain_speed"),
        (f"mass of grains (kg{per_metre})", "grain_mass"),
        (f"grains passed (kg{per_metre})", "passed_mass"),
    ):
        curves = {name: np.array(getattr(w, attribute)) for name, w in flow.windows.items()}
        panels[label] = {
            name: curve for name, curve in curves.items() if np.nansum(np.abs(curve)) > 0
        }
    panels = {label: curves for label, curves in panels.items() if curves}
    figure, grid = chart_grid(len(panels), 1, (7.0, 1.8), "The flow over time")
    for axes, (label, curves) in zip(grid[:, 0], panels.items(), strict=True):
        draw_curves(axes, flow.times, curves)
        axes.set_ylabel(label, fontsize="small")
    grid[-1, 0].set_xlabel("time (s)")
    return figure
