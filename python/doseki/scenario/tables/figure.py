"""[figure.NAME] of each kind: a picture made from the record of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from ...errors import UserError
from ...record.quantities import check_quantity
from ...util.spelling import suggestion
from ..gauges.gauge import Gauge
from ..gauges.loads.load import Load
from ..gauges.loads.panels import Panels
from ..table import Kinds, Part
from ..values.types import (
    LARGEST,
    SMALLEST,
    Direction,
    GaugeName,
    NonNegative,
    OptionalMaterialName,
    OptionalWindowName,
    Position,
    Title,
    dimension,
)
from ..values.units import SPEED, TIME, Measured


def _known_quantities(names: list[str], info: ValidationInfo) -> list[str]:
    for name in names:
        try:
            check_quantity(name, dimension(info))
        except UserError as error:
            raise ValueError(str(error)) from None
    return names


Quantities = Annotated[
    list[str], Field(min_length=1, max_length=8), AfterValidator(_known_quantities)
]
Times = Annotated[list[NonNegative], Field(max_length=24), Measured(TIME)]  # panels on a page
BinWidth = Annotated[float, Field(ge=SMALLEST, le=LARGEST), Measured(SPEED)]
MAX_BINS = 2000


@dataclass(frozen=True)
class Drawable:
    """What figures of a run can show."""

    dim: int
    gauges: Mapping[str, Gauge]
    history: Sequence[str]  # columns
    speed: float  # m/s, the highest that the sound speed is meant for


class Figure(Part):
    """What figures of all kinds have."""

    kind: str
    title: Title = Field("", description="caption")

    def objections(self, around: Drawable) -> Iterator[tuple[str, str]]:
        """Why it cannot be drawn: the key to blame, and what to say after it."""
        yield from ()


class FigureOfSnapshots(Figure):
    """What figures of particles at some moments have."""

    window: OptionalWindowName = Field(
        None, description="name of a [window.NAME]; default: everything"
    )
    times: Times = Field(
        default_factory=list, description="s; nearest snapshots; [], the default: see `when`"
    )
    when: Literal["all", "events", "first", "last", "before_flow", "with_flow"] = Field(
        "last",
        description="which snapshots, where no times are given: events are the start, the arrival "
        "of the flow, its peak (of kinetic energy) and the end; before_flow is the last one with "
        "no fluid in the window, with_flow the first one with fluid across all of it",
    )
    material: OptionalMaterialName = Field(None, description="count or draw only this material")

    @model_validator(mode="after")
    def _one_choice(self) -> FigureOfSnapshots:
        if self.times and "when" in self.model_fields_set:
            raise ValueError("times and when exclude each other: give one")
        return self


class SnapshotFigure(FigureOfSnapshots):
    """The particles at some moments."""

    kind: Literal["snapshot"]
    colour: Quantities = Field(
        default_factory=lambda: ["material"],
        description="one panel each: material, body, speed, velocity_x, pressure, density ...",
    )


class HistogramFigure(FigureOfSnapshots):
    """How fast particles are at some moments."""

    kind: Literal["histogram"]
    bin_width: BinWidth = Field(0.1, description="of the bins, m/s")
    sample: int = Field(30, gt=0, le=1_000_000, description="size of a random sample of particles")

    def objections(self, around: Drawable) -> Iterator[tuple[str, str]]:
        """There must not be more bins than can be seen."""
        if around.speed > MAX_BINS * self.bin_width:
            yield (
                "bin_width",
                f" = {self.bin_width:g} m/s: speeds up to {around.speed:.3g} m/s would need more"
                f" than {MAX_BINS} bins; make it larger",
            )


class SeriesFigure(Figure):
    """Columns of the history over time."""

    kind: Literal["series"]
    columns: list[str] = Field(
        min_length=1, max_length=40, description="columns of the history (history.csv)"
    )

    def objections(self, around: Drawable) -> Iterator[tuple[str, str]]:
        """Its columns must be those of the history."""
        for column in self.columns:
            if column not in around.history:
                why = f': "{column}" is not a column of the history'
                yield "columns", why + suggestion(column, around.history)


class GaugeFigure(Figure):
    """What a gauge has read."""

    kind: Literal["gauge"]
    gauge: GaugeName = Field(description="name of a [gauge.NAME]")
    columns: list[str] = Field(
        default_factory=list, description="columns of the gauge; default: all"
    )
    times: Times = Field(
        default_factory=list,
        description="of profiles, s; [], the default: some spread over the run",
    )

    def objections(self, around: Drawable) -> Iterator[tuple[str, str]]:
        """Its columns must be those of the gauge; only profiles are drawn at certain times."""
        gauge = around.gauges[self.gauge]
        known = gauge.columns(around.dim)
        for column in self.columns:
            if column not in known:
                why = f': "{column}" is not a column of {self.gauge}'
                yield "columns", why + suggestion(column, known)
        if self.times and not gauge.is_profile:
            yield "times", f": {self.gauge} is no profile; its curves show all times"


class LoadFigure(Figure):
    """The load that a gauge has read, in parts, or the pressures on its panels."""

    kind: Literal["load"]
    gauge: GaugeName = Field(description="name of a [gauge.NAME] of kind load or panels")

    def objections(self, around: Drawable) -> Iterator[tuple[str, str]]:
        """Its gauge must be one of loads."""
        gauge = around.gauges[self.gauge]
        if not isinstance(gauge, Load | Panels):
            yield "gauge", f' = "{self.gauge}" is of kind "{gauge.kind}", not "load" or "panels"'


class DepthFigure(Figure):
    """The depth of the flow along a line, over time: an x-t diagram."""

    kind: Literal["xt"]
    start: Position = Field(description="where the line begins on the bed, m")
    end: Position = Field(description="where the line ends, m")
    direction: Direction | None = Field(None, description="upwards; default: against gravity")
    material: OptionalMaterialName = Field(
        None, description="depth of this material; default: of all that moves"
    )
    count: int = Field(100, gt=0, le=10_000, description="points, at (k + 1/2) length/count")

    @model_validator(mode="after")
    def _has_length(self) -> DepthFigure:
        if np.array_equal(self.start, self.end):
            raise ValueError("start and end are the same point")
        return self


FIGURES = Kinds.by_word(
    "kind",
    Figure,
    SnapshotFigure,
    HistogramFigure,
    SeriesFigure,
    GaugeFigure,
    LoadFigure,
    DepthFigure,
)

if TYPE_CHECKING:
    FigureTable = Figure
else:
    FigureTable = FIGURES.union
