"""What lies on a terrain to a thickness normal to the slope."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...errors import UserError
from ...geodata.crs import check_same_crs, why_not_compared
from ...geodata.features import Polygon
from ...geodata.raster import Raster, read_raster
from ...record.particles import FREE, ParticleSet, check_size
from ...scenario.model import Scenario, file_of
from ...scenario.releases import NotCompared
from ...scenario.tables.terrain.release import THICKEST, Release
from ...util.finding import Finding
from ..ground import Ground, beyond_text, ground_of
from .shaped import Shaped

THINNEST = 0.6  # particles; thinner ones would be far from round
Layer = Callable[[float], tuple[np.ndarray, np.ndarray]]  # height -> places, areas
Thickness = Callable[[np.ndarray], np.ndarray]  # places -> m


class Parcels(NamedTuple):
    """What particles of a release stand for."""

    place: np.ndarray  # (N, dim - 1) of the ground below, m
    height: np.ndarray  # (N,) along the normal, m
    volume: np.ndarray  # (N,) m3; 2-D: m2

    def chosen(self, keep: np.ndarray) -> Parcels:
        """Those of a mask, or of indices."""
        return Parcels(*(column[keep] for column in self))


class ReleaseBody(Shaped[Release]):
    """Areas of a terrain covered to a thickness, in particles of nearly equal mass."""

    @cached_property
    def ground(self) -> Ground:
        """What it lies on."""
        assert self.scenario.bed is not None
        return ground_of(self.scenario.bed)

    @cached_property
    def asked(self) -> float:
        """Its volume as given, m3 (2-D: m2): area of the ground times thickness."""
        return sum(volume for _, volume in self._parts)

    @cached_property
    def volume(self) -> float:
        """Its volume in particles, m3 (2-D: m2)."""
        return float(np.sum(self.parcels.volume))

    @property
    def layers(self) -> float:
        """Particles over its thickness, a mean over its area."""
        lowest = self.parcels.height < self.parcels.height.min() * 1.5
        return len(self.parcels.height) / max(1, int(lowest.sum()))

    @cached_property
    def parcels(self) -> Parcels:
        """All that it consists of."""
        parts = [parcels for parcels, _ in self._parts]
        found = Parcels(*(np.concatenate(each) for each in zip(*parts, strict=True)))
        if not len(found.volume):
            raise self.error(
                f": is smaller than one particle (dp = {self.scenario.dp:g} m): increase it, or "
                "decrease dp"
            )
        unknown = self.ground.field.at(np.ascontiguousarray(found.place))["unknown"]
        if unknown.any():
            raise self._beyond(found.place[np.argmax(unknown)])
        return found

    def _beyond(self, place: np.ndarray) -> UserError:
        return self.error(f": {beyond_text(place)}")

    def _check_box(self, low: np.ndarray, high: np.ndarray) -> None:
        """Refuse what lies in a box (dim - 1,) that goes beyond the terrain by more than dp.

        Before layers are made: of a place that is far away there would be no end of them.
        """
        assert self.scenario.bed is not None
        least, most = self.scenario.bed.extent
        dp = self.scenario.dp
        for corner in (low, high):
            if (corner < least - dp).any() or (corner > most + dp).any():
                raise self._beyond(corner)

    def _check_size(self, asked: float) -> None:
        """Refuse more particles than can be held, before layers are made."""
        check_size({f"body.{self.name}": asked / self.scenario.dp**self.dim})

    @cached_property
    def _parts(self) -> list[tuple[Parcels, float]]:
        """The parcels of each of its areas, and the volume asked for."""
        table = self.table
        if table.between is not None:
            return [self._strip(*table.between)]
        if self._is_raster:
            return [self._raster()]
        assert isinstance(table.thickness, list)
        polygons = table.polygons or []
        return [
            self._area(rings, thickness)
            for rings, thickness in zip(polygons, table.thickness, strict=True)
        ]

    def _stacked(
        self, layer: Layer, thickness: Thickness, spacing: float, asked: float | None = None
    ) -> Parcels:
        """Layers `spacing` m apart, one above the other, as high as the thickness asks for.

        In a hollow they become narrower upwards, so it is filled higher: to t' with
        t' - k t'^2/2 = t, where k is the curvature.  With the volume `asked` the top gives way by
        part of a layer so that it is right.
        """
        found, excess, level = [], [], 0
        while True:
            height = (level + 0.5) * spacing
            place, area = layer(height)
            t = thickness(place)
            k = self.ground.hollowness(place, self.scenario.dp) if len(place) else t
            root = np.sqrt(np.maximum(1 - 2 * k * t, 0.0))
            above = height - 2 * t / (1 + root)
            keep = (above < (0.0 if asked is None else 0.5 * spacing)) & (t > 0)
            if not keep.any():
                break
            heights = np.full(int(keep.sum()), height)
            found.append(Parcels(place[keep], heights, area[keep] * spacing))
            excess.append(above[keep])
            level += 1
        none = Parcels(place[:0], t[:0], t[:0])
        parcels = Parcels(*(np.concatenate(each) for each in zip(none, *found, strict=True)))
        return (
            parcels if asked is None else _lowest(parcels, np.concatenate([t[:0], *excess]), asked)
        )

    def _spacing(self, thickness: float) -> float:
        """Between layers, m, of which a whole number makes the thickness."""
        dp = self.scenario.dp
        if thickness < THINNEST * dp:
            raise self.error(
                f".thickness = {thickness:g} m is less than {THINNEST:g} particle (dp = {dp:g} m): "
                f"dp = {thickness / 4:.2g} would make four",
                "thickness",
            )
        return thickness / max(1, round(thickness / dp))

    def _strip(self, low: float, high: float) -> tuple[Parcels, float]:
        """2-D: from one place to another."""
        t, dp = self.table.thickness, self.scenario.dp
        assert isinstance(t, float)

        self._check_box(np.array([low]), np.array([high]))

        def layer(height: float) -> tuple[np.ndarray, np.ndarray]:
            return self.ground.tile([low], high - low, dp, height)

        _, area = layer(0.0)
        asked = float(area.sum()) * t
        self._check_size(asked)
        return self._stacked(layer, _everywhere(t), self._spacing(t), asked), asked

    def _area(self, rings: list[list[list[float]]], thickness: float) -> tuple[Parcels, float]:
        """Inside a polygon, whose edge gives way a little for the right volume."""
        outer, *holes = (np.array(ring) for ring in rings)
        polygon = Polygon(outer, tuple(holes))
        dp = self.scenario.dp
        self._check_box(outer.min(axis=0), outer.max(axis=0))
        low, high = outer.min(axis=0) - dp, outer.max(axis=0) + dp

        def layer(height: float) -> tuple[np.ndarray, np.ndarray]:
            return self.ground.layer(low, high, dp, height)

        place, _ = layer(0.0)
        asked = self.ground.area_in(polygon) * thickness
        if not polygon.contains(place[:, 0], place[:, 1]).any():
            none = np.zeros(0)
            return Parcels(place[:0], none, none), asked
        self._check_size(asked)
        parcels = self._stacked(layer, _everywhere(thickness), self._spacing(thickness))
        within = polygon.contains(parcels.place[:, 0], parcels.place[:, 1])
        outside = _distance(parcels.place, [outer, *holes]) * np.where(within, -1.0, 1.0)
        near = outside < dp
        return _lowest(parcels.chosen(near), outside[near], asked), asked

    @property
    def _is_raster(self) -> bool:
        """Whether its file is a raster: the polygons of another one are in the table already."""
        return self.table.file is not None

    @cached_property
    def _file(self) -> Path:
        return file_of(self.scenario.where, self.name, self.table.file or "")

    @cached_property
    def _map(self) -> Raster:
        """Its raster of thickness, in the coordinate reference system of the terrain."""
        try:
            raster = read_raster(self._file)
            check_same_crs(self._file, raster.crs, self._terrain_crs)
        except UserError as error:
            raise self.error(f".file: {error}", "file") from None
        return raster

    @property
    def _terrain_crs(self) -> str | None:
        assert self.scenario.bed is not None
        assert self.scenario.bed.raster is not None
        return self.scenario.bed.raster.crs

    def findings(self) -> list[Finding]:
        """See Body."""
        why = why_not_compared(self._map.crs, self._terrain_crs) if self._is_raster else None
        return [NotCompared(f"body.{self.name}.file", self._file, why)] if why else []

    def _raster(self) -> tuple[Parcels, float]:
        """Where a raster of thickness has half a particle or more."""
        raster, path = self._map, self._file
        west, _, _, north = raster.extent
        filled = np.argwhere(np.nan_to_num(raster.values) > 0)
        if not len(filled):
            raise self.error(f".file: {path} is nowhere above 0", "file")
        if np.nanmin(raster.values) < 0:
            raise self.error(f".file: {path} has a thickness below 0", "file")
        if cell := raster.beyond(THICKEST):
            raise self.error(
                f".file: {path}: {cell}, and a thickness is up to {THICKEST:g} m", "file"
            )
        (top, left), (bottom, right) = filled.min(axis=0), filled.max(axis=0) + 1
        low = np.array([west + left * raster.cell, north - bottom * raster.cell])
        high = np.array([west + right * raster.cell, north - top * raster.cell])
        self._check_box(low, high)
        dp = self.scenario.dp

        def thickness(place: np.ndarray) -> np.ndarray:
            return np.maximum(np.nan_to_num(raster.sampled(place[:, 0], place[:, 1])), 0.0)

        centres = np.column_stack([raster.x[filled[:, 1]], raster.y[filled[:, 0]]])
        steepness = self.ground.field.at(np.ascontiguousarray(centres))["area"]
        depth = raster.values[filled[:, 0], filled[:, 1]]
        asked = float(np.sum(depth * steepness)) * raster.cell**2
        self._check_size(asked)

        def layer(height: float) -> tuple[np.ndarray, np.ndarray]:
            return self.ground.layer(low, high, dp, height)

        return self._stacked(layer, thickness, dp, asked), asked

    def count(self) -> float:
        """See Body."""
        return float(len(self.parcels.volume))

    def particles(self, names: list[str]) -> ParticleSet:
        """See Body."""
        parcels = self.parcels
        position = self.ground.above(parcels.place, parcels.height)
        n = len(position)
        compressed = 1 + self._compression(position)
        return ParticleSet(
            position=position,
            velocity=self.velocity_at(position),
            mass=self.rho0 * parcels.volume * compressed,
            density=self.rho0 * compressed,
            smoothing_length=np.full(n, self.scenario.eta * self.scenario.dp),
            motion=np.full(n, FREE, np.int32),
            **self._indices(names, n),
        )


def _everywhere(thickness: float) -> Thickness:
    """The same thickness at all places."""
    return lambda place: np.full(len(place), thickness)


def _lowest(parcels: Parcels, order: np.ndarray, volume: float) -> Parcels:
    """Those of the lowest `order` (N,) that make a volume, to half of one, in their own order."""
    if not len(order):
        return parcels
    first = np.argsort(order, kind="stable")
    covered = np.cumsum(parcels.volume[first])
    count = int(np.searchsorted(covered, volume - 0.5 * parcels.volume.mean())) + 1
    return parcels.chosen(np.sort(first[:count]))


def _distance(place: np.ndarray, rings: list[np.ndarray]) -> np.ndarray:
    """Distance (N,) of places (N, 2) from the nearest of the edges of rings, m."""
    start = np.concatenate(rings)
    end = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    nearest = np.full(len(place), np.inf)
    for a, b in zip(start, end, strict=True):
        along = b - a
        length = max(float(along @ along), 1e-300)
        t = np.clip((place - a) @ along / length, 0, 1)
        foot = a + t[:, None] * along
        nearest = np.minimum(nearest, np.linalg.norm(place - foot, axis=1))
    return nearest


def released_volumes(scenario: Scenario) -> dict[str, tuple[float, float]]:
    """Of each release that a run begins with: volume asked for, and in particles, m3.

    What other bodies take of it is not left out.
    """
    found = {}
    for name, table in scenario.body.items():
        if isinstance(table, Release) and name not in scenario.carried:
            body = ReleaseBody(scenario, name, table)
            found[name] = body.asked, body.volume
    return found
