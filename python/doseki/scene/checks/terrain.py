"""What is doubtful about a terrain and what lies on it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...record.units import unit_in
from ...scenario.checks.terrain import tilt_of
from ...scenario.model import Scenario
from ...scenario.tables.terrain.terrain import TERRAIN
from ...util.finding import Finding, place_text
from ..inflow_sections import (
    InflowSection,
    build_inflows,
    height_above_ground,
    rows_of,
    surge_volumes,
)
from ..kinds.body import Body
from ..kinds.release import ReleaseBody

VOLUME = 0.01  # by which the particles of a release may miss what is asked for
STRETCH = 0.01  # by which lengths on a map may differ from those on the ground
SURGE = 0.1  # by which the layers of a surge may
FEW_LAYERS = 2.0
HIGH_STEP = 0.1  # spacings; lower ones are no more than the noise of particles
EVEN = 0.75  # of the smoothing that evens steps out, and is enough
LEVEL = 1.0  # degrees by which gravity may be off


@dataclass(frozen=True)
class Unknown(Finding):
    """Parts of the map that say nothing."""

    share: float

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.share:.2g} of the cells have no data; the ground there has the "
            "height of the nearest known cell, and what flows there leaves the run"
        )


@dataclass(frozen=True)
class Coarse(Finding):
    """A map that is finer than the particles."""

    cell: float
    dp: float

    def __str__(self) -> str:
        return (
            f"{self.place}: cells of {self.cell:g} m are smaller than particles (dp = {self.dp:g} "
            f"m), which cannot follow them; terrain.resample = {self.dp:g} averages them"
        )


@dataclass(frozen=True)
class Terraced(Finding):
    """A map that is a flight of steps, for want of digits."""

    step: float  # m
    length: float  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: its heights come in steps of {self.step:g} m, so that a slope is treads"
            " and risers, which hold a flow up and widen a release; terrain.smoothing ="
            f" {self.length:.2g} evens them out, and with them what is narrower than twice that,"
            " as gullies and dams: better is a map with decimals"
        )


@dataclass(frozen=True)
class TiltedGravity(Finding):
    """Gravity that is not along the vertical axis of a map."""

    tilt: float  # degrees
    axis: str

    def __str__(self) -> str:
        return (
            f"{self.place}: gravity is {self.tilt:.3g} degrees off the downward {self.axis} of the"
            " terrain, as on a profile that is tilted; on a map of heights it has only"
            f" a part along {self.axis}"
        )


@dataclass(frozen=True)
class Weightless(Finding):
    """A terrain without gravity."""

    def __str__(self) -> str:
        return f"{self.place} is zero: nothing flows down the terrain; was it forgotten?"


@dataclass(frozen=True)
class HolesAsHeights(Finding):
    """Cells of the map that only cliffs join with the rest: most likely holes."""

    cells: int
    low: float  # m
    high: float  # m
    jump: float  # m
    at: tuple[float, float]  # m

    def __str__(self) -> str:
        cells = "1 cell stands" if self.cells == 1 else f"{self.cells:,} cells stand"
        height = f"{self.low:g}" if self.low == self.high else f"{self.low:.4g} to {self.high:.4g}"
        return (
            f"{self.place}: {cells} at {height} m, {self.jump:.3g} m or more from all neighbours,"
            f" as at [{place_text(self.at)}] m; if these are holes, let the file say so{self._how}"
        )

    @property
    def _how(self) -> str:
        if self.low != self.high:
            return ""  # files have one number for no data
        number = repr(self.low).removesuffix(".0")
        return f" (gdal_edit -a_nodata {number} IN; .asc: a line NODATA_value {number})"


@dataclass(frozen=True)
class Stretched(Finding):
    """A map on which lengths are not those on the ground, as in Web Mercator."""

    factor: float
    latitude: float  # degrees
    utm: int

    def __str__(self) -> str:
        side = "N" if self.latitude >= 0 else "S"
        return (
            f"{self.place}: lengths on this map are {self.factor:.3g} times those on the ground "
            f"(at {abs(self.latitude):.3g} degrees {side}), and are taken as metres: convert it to "
            f"UTM, gdalwarp -t_srs EPSG:{self.utm} IN OUT, or to a national grid"
        )


@dataclass(frozen=True)
class WrongVolume(Finding):
    """A release that particles do not fill well."""

    asked: float
    volume: float
    unit: str

    def __str__(self) -> str:
        remedy = (
            "decrease dp, or if that makes it less, layers fold in hollows that are narrower than "
            "the release is thick: smooth the terrain, or make the release thinner"
            if self.volume < self.asked
            else "decrease dp"
        )
        return (
            f"{self.place}: its particles have {self.volume:.5g} {self.unit}, and area times "
            f"thickness is {self.asked:.5g} {self.unit}: {remedy}"
        )


@dataclass(frozen=True)
class CutInflow(Finding):
    """An inflow of which a part lies in the ground, as in a channel."""

    rows: int
    all_rows: int
    speed: float

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.rows} of {self.all_rows} particles of a layer lie above the "
            f"ground; these carry all of the discharge, at up to {self.speed:.3g} m/s"
        )


@dataclass(frozen=True)
class HangingInflow(Finding):
    """An inflow that begins in the air."""

    height: float  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: its section begins {self.height:.3g} m above the ground, so what "
            "enters falls; let position be a corner below the bed"
        )


@dataclass(frozen=True)
class CoarseSurge(Finding):
    """A surge of which the particles of a layer are not what its thickness asks for."""

    asked: float
    volume: float
    unit: str

    def __str__(self) -> str:
        terms = "area above the ground and speed" if self.unit == "m3" else "thickness and speed"
        return (
            f"{self.place}: its layers have {self.volume:.3g} {self.unit}, and {terms} make "
            f"{self.asked:.3g} {self.unit}: decrease dp"
        )


@dataclass(frozen=True)
class ThinRelease(Finding):
    """A release of one or two layers of particles."""

    layers: float
    dp: float

    def __str__(self) -> str:
        return (
            f"{self.place}: {self.layers:.2g} particles over its mean thickness, normal to the "
            f"slope, which is few for a flow: dp = {self.dp:.2g} would make four"
        )


def terrain_findings(scenario: Scenario, bodies: Mapping[str, Body[Any]]) -> Iterator[Finding]:
    """Doubts about the map, and about each release."""
    bed = scenario.bed
    if bed is None:
        return
    if bed.unknown.any():
        yield Unknown(TERRAIN, bed.unknown_share)
    if (found := bed.islands) is not None:
        where = found.low, found.high, found.jump, found.place
        yield HolesAsHeights(f"{TERRAIN}.file", found.cells, *where)
    scale = bed.scale
    if scale is not None and abs(scale.factor - 1.0) > STRETCH:
        yield Stretched(f"{TERRAIN}.file", scale.factor, scale.latitude, scale.utm)
    yield from _terraced(scenario)
    yield from _gravity(scenario)
    if bed.cell < 0.5 * scenario.dp:
        yield Coarse(TERRAIN, bed.cell, scenario.dp)
    for section in build_inflows(scenario, list(scenario.inflow)):
        yield from _inflow_findings(scenario, section)
    for name, body in bodies.items():
        if not isinstance(body, ReleaseBody):
            continue
        if abs(body.volume - body.asked) > VOLUME * body.asked:
            yield WrongVolume(name, body.asked, body.volume, unit_in("m3", scenario.dim))
        if body.layers < FEW_LAYERS:
            yield ThinRelease(name, body.layers, scenario.dp * body.layers / 4)


def _terraced(scenario: Scenario) -> Iterator[Finding]:
    """Doubts about heights in steps, unless they are smoothed."""
    terraces, terrain = scenario.bed and scenario.bed.terraces, scenario.terrain
    if not terraces or terrain is None or terraces.step < HIGH_STEP * scenario.dp:
        return
    if (terrain.smoothing or 0.0) < EVEN * terraces.length:
        yield Terraced(f"{TERRAIN}.file", terraces.step, terraces.length)


def _gravity(scenario: Scenario) -> Iterator[Finding]:
    """Doubts about where it pulls."""
    if not scenario.gravity.any():
        yield Weightless("gravity")
    elif (tilt := tilt_of(scenario.gravity)) > LEVEL:
        yield TiltedGravity(TERRAIN, tilt, "xyz"[scenario.dim - 1])


def _inflow_findings(scenario: Scenario, section: InflowSection) -> Iterator[Finding]:
    """Doubts about one inflow."""
    place = f"inflow.{section.name}"
    height = height_above_ground(scenario, section.name)
    if height > scenario.dp:
        yield HangingInflow(place, height)
    if scenario.inflow[section.name].surge is None:
        rows, all_rows = len(section.rows), len(rows_of(scenario, section.name))
        if rows < all_rows:
            yield CutInflow(place, rows, all_rows, float(section.speeds.max()))
        return
    asked, volume = surge_volumes(scenario, section)
    if abs(volume - asked) > SURGE * asked:
        yield CoarseSurge(place, asked, volume, unit_in("m3", scenario.dim))
