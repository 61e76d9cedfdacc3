"""What colour a particle has in a picture, and the key that explains it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from matplotlib import colormaps, colors
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Patch

from ..measure.quantities import quantity
from ..measure.views import View, fluid_names, select
from ..record.quantities import CATEGORIES, check_quantity, quantity_label
from ..record.reader import Run, Snapshot
from ..scenario.kinematics import DEFORM
from ..scenario.materials import NO_FRACTURE

FIXED_COLOUR = "#262626"  # the slope is black, as in the paper
FIXED_IN_SPACE = "#b3ada3"
FIXED_BESIDE_SCALE = "#a6a6a6"  # grey, because black is a colour of the scale
PALE = "#d0d7de"  # no colour of the scale either
FLUID_COLOURS = ("#3182bd", "#41b6c4", "#54278f")  # water blue, debris red
SOLID_COLOURS = ("#d7301f", "#fd8d3c", "#8c510a", "#dd3497")
OTHER_COLOURS = ("#3182bd", "#d7301f", "#31a354", "#fd8d3c", "#756bb1", "#8c510a", "#41b6c4")
SCALE = "viridis"
FIRST_HUE, GOLDEN_RATIO = 0.07, 0.618034
MAX_ENTRIES = 12
FEW = 1000  # with more particles than this the colour scale leaves out the outermost 1 %


class KeyRoom(Protocol):
    """A figure with room for keys to the right of panels."""

    @property
    def figure(self) -> Figure | SubFigure:
        """The figure that the panels are on."""
        ...

    def beside(self, axes: Axes) -> Axes:
        """Narrow axes for a colour bar to the right of a panel."""


class CategoryColours:
    """One colour for each material or body; fixed particles are black."""

    def __init__(self, run: Run, snapshots: Sequence[Snapshot], name: str) -> None:
        """`name` is "material" or "body"."""
        self._name = name
        # Black surfaces would show no shade.
        self.fixed_colour = FIXED_COLOUR if run.scenario["dim"] == 2 else FIXED_IN_SPACE
        self.heading = ""
        free, fixed = set(), set()
        for snapshot in snapshots:
            free |= set(snapshot[name][~snapshot["fixed"]].tolist())
            fixed |= set(snapshot[name][snapshot["fixed"]].tolist())
        self._free = palette(sorted(free), name, fluid_names(run))
        self._fixed = sorted(fixed)

    def rgba(self, snapshot: Snapshot) -> np.ndarray:
        """Colours (N, 4) from 0 to 1."""
        kinds, kind = np.unique(snapshot[self._name], return_inverse=True)
        table = [colors.to_rgba(self._free.get(name, self.fixed_colour)) for name in kinds]
        colours = np.array(table).reshape(-1, 4)[kind]
        colours[snapshot["fixed"]] = colors.to_rgba(self.fixed_colour)
        return colours

    def legend_entries(self) -> list[tuple[str, str]]:
        """(label, colour) of every kind; none when they are too many to name."""
        fixed = [(f"{kind} (fixed)", self.fixed_colour) for kind in self._fixed]
        entries = [*self._free.items(), *fixed]
        return entries if len(entries) <= MAX_ENTRIES else []

    def add_key(self, grid: KeyRoom, axes: Axes) -> None:
        """Explain the colours to the right of the panel `axes`."""
        handles = [Patch(color=colour, label=label) for label, colour in self.legend_entries()]
        axes.legend(
            handles=handles, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0,
            frameon=False, fontsize="small", handlelength=1.0,
        )  # fmt: skip


class GrainColours(CategoryColours):
    """A colour for each body that moves, which it keeps; others have that of their material.

    Numbers that follow one another, as those of the parts of a body do, have colours far apart.
    """

    def __init__(self, run: Run, snapshots: Sequence[Snapshot]) -> None:
        """Materials are named in the key, bodies are too many."""
        super().__init__(run, snapshots, "material")
        names = [snapshot["material"][snapshot["grain"] >= 0] for snapshot in snapshots]
        self._of_grains = set(np.concatenate(names).tolist())

    def rgba(self, snapshot: Snapshot) -> np.ndarray:
        """Colours (N, 4) from 0 to 1."""
        colours = super().rgba(snapshot)
        grain = snapshot["grain"]
        own = grain >= 0
        hue = (FIRST_HUE + GOLDEN_RATIO * grain[own]) % 1.0
        shade = 0.95 - 0.2 * (grain[own] % 3)
        hsv = np.stack([hue, np.full(len(hue), 0.65), shade], axis=1)
        colours[own, :3] = colors.hsv_to_rgb(hsv)
        return colours

    def legend_entries(self) -> list[tuple[str, str]]:
        """(label, colour) of the materials that are not of such bodies."""
        return [entry for entry in super().legend_entries() if entry[0] not in self._of_grains]


class ScaleColours:
    """A colour scale for a number; fixed particles are grey."""

    def __init__(self, snapshots: Sequence[Snapshot], name: str, view: View) -> None:
        """The scale spans what the particles that can move have in `view`."""
        self._name = name
        self.heading = quantity_label(name, snapshots[0].dim)
        values = [quantity(s, name)[select(s, view) & self.has(s)] for s in snapshots]
        self._limits = limits(np.concatenate(values))
        self._norm = colors.Normalize(*self._limits)

    def has(self, snapshot: Snapshot) -> np.ndarray:
        """Which particles (N,) have this number, be it zero."""
        return np.ones(len(snapshot["id"]), bool)

    def rgba(self, snapshot: Snapshot) -> np.ndarray:
        """Colours (N, 4) from 0 to 1."""
        colours = colormaps[SCALE](self._norm(quantity(snapshot, self._name)))
        colours[snapshot["fixed"]] = colors.to_rgba(FIXED_BESIDE_SCALE)
        return colours

    def legend_entries(self) -> list[tuple[str, str]]:
        """(label, colour) of a few values of the scale."""
        values = np.unique(np.linspace(*self._limits, 5))
        return [(f"{v:.3g}", colors.to_hex(colormaps[SCALE](self._norm(v)))) for v in values]

    def add_key(self, grid: KeyRoom, axes: Axes) -> None:
        """Explain the colours by a bar to the right of the panel `axes`, of one where all are."""
        beside = grid.beside(axes)
        if self._limits[0] < self._limits[1]:
            grid.figure.colorbar(ScalarMappable(self._norm, SCALE), cax=beside)
        else:
            [(label, colour)] = self.legend_entries()
            beside.set_facecolor(colour)
            beside.set_xticks([])
            beside.set_yticks([0.5], [label])
            beside.yaxis.tick_right()
            beside.yaxis.set_label_position("right")
        beside.set_ylabel(self.heading, fontsize="small")


class DamageColours(ScaleColours):
    """The scale for bodies that may break; what cannot is pale, so that it is not taken for whole.

    `heading` says so.
    """

    def __init__(self, run: Run, snapshots: Sequence[Snapshot], view: View) -> None:
        """As that of the field "damage"."""
        self._breaking = sorted(_breaking(run))
        super().__init__(snapshots, "damage", view)
        self.heading = "damage (pale: does not break)"

    def has(self, snapshot: Snapshot) -> np.ndarray:
        """Which particles (N,) are of bodies that may break, or came off such."""
        return np.isin(snapshot["body"], self._breaking)

    def rgba(self, snapshot: Snapshot) -> np.ndarray:
        """Colours (N, 4) from 0 to 1."""
        colours = super().rgba(snapshot)
        colours[~self.has(snapshot) & ~snapshot["fixed"]] = colors.to_rgba(PALE)
        return colours


def _breaking(run: Run) -> set[str]:
    """The bodies of a scenario that deform and whose material breaks."""
    materials, tables = run.scenario.get("material", {}), run.scenario.get("body", {})
    breaks = {n for n, m in materials.items() if m.get("fracture", NO_FRACTURE) != NO_FRACTURE}
    return {
        name
        for name, table in tables.items()
        if table.get("kinematics") in DEFORM and table.get("material") in breaks
    }


Colouring = CategoryColours | GrainColours | ScaleColours


def colouring(run: Run, snapshots: Sequence[Snapshot], name: str, view: View) -> Colouring:
    """The colours of `snapshots` by the quantity `name`; raises UserError for an unknown name."""
    check_quantity(name, run.scenario["dim"])
    if name in CATEGORIES:
        return CategoryColours(run, snapshots, name)
    if name == "grain":
        return GrainColours(run, snapshots)
    if name == "damage" and _breaking(run):
        return DamageColours(run, snapshots, view)
    return ScaleColours(snapshots, name, view)


def palette(kinds: Sequence[str], name: str, fluids: set[str]) -> dict[str, str]:
    if name != "material":
        return {k: OTHER_COLOURS[i % len(OTHER_COLOURS)] for i, k in enumerate(kinds)}
    flowing = [kind for kind in kinds if kind in fluids]
    solid = [kind for kind in kinds if kind not in fluids]
    colours = {k: FLUID_COLOURS[i % len(FLUID_COLOURS)] for i, k in enumerate(flowing)}
    return colours | {k: SOLID_COLOURS[i % len(SOLID_COLOURS)] for i, k in enumerate(solid)}


def limits(values: np.ndarray) -> tuple[float, float]:
    """Ends of the colour scale: the same number where all are."""
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return 0.0, 0.0
    if len(values) > FEW:
        low, high = np.percentile(values, (0.5, 99.5))
        if low < high:
            return float(low), float(high)
    return float(values.min()), float(values.max())
