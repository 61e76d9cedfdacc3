"""What lies on a terrain to a thickness normal to the slope."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...geodata.errors import GeodataError
from ...geodata.features import Polygon
from ...geodata.raster import read_raster
from ...record.particles import FREE, ParticleSet
from ...scenario.model import Scenario, file_of
from ...scenario.releases import is_raster
from ...scenario.tables.terrain.release import Release
from ..ground import Ground, ground_of
from .shaped import Shaped


class Columns(NamedTuple):
    """Columns that stand on the ground."""

    place: np.ndarray  # (N, dim - 1) m
    area: np.ndarray  # (N,) of surface, m2; 2-D: m
    thickness: np.ndarray  # (N,) m


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
        return float(np.sum(self.columns.area * self.columns.thickness))

    @cached_property
    def columns(self) -> Columns:
        """All that it stands on."""
        parts = [columns for columns, _ in self._parts]
        found = Columns(*(np.concatenate(each) for each in zip(*parts, strict=True)))
        if not len(found.area):
            raise self.error(
                f": is smaller than one particle (dp = {self.scenario.dp:g} m): increase it, or "
                "decrease dp"
            )
        unknown = self.ground.field.at(found.place)["unknown"]
        if unknown.any():
            at = np.round(found.place[np.argmax(unknown)], 3).tolist()
            raise self.error(f": reaches beyond the terrain, or where it has no data, as at {at} m")
        return found

    @cached_property
    def _parts(self) -> list[tuple[Columns, float]]:
        """The columns of each of its areas, and the volume asked for."""
        table = self.table
        if table.between is not None:
            return [self._strip(*table.between)]
        if is_raster(table.file):
            return [self._raster()]
        assert isinstance(table.thickness, list)
        polygons = table.polygons or []
        return [
            self._area(rings, thickness)
            for rings, thickness in zip(polygons, table.thickness, strict=True)
        ]

    def _strip(self, low: float, high: float) -> tuple[Columns, float]:
        """2-D: columns from one place to another."""
        assert isinstance(self.table.thickness, float)
        made = self.ground.field.columns([low], high - low, self.scenario.dp)
        thickness = np.full(len(made["area"]), self.table.thickness)
        columns = Columns(made["place"], made["area"], thickness)
        return columns, float(made["area"].sum()) * self.table.thickness

    def _area(self, rings: list[list[list[float]]], thickness: float) -> tuple[Columns, float]:
        """Columns inside a polygon, whose edge gives way a little for the right volume."""
        outer, *holes = (np.array(ring) for ring in rings)
        polygon = Polygon(outer, tuple(holes))
        low, high = outer.min(axis=0), outer.max(axis=0)
        margin = self.scenario.dp
        place, area = self.ground.columns(low - margin, high + margin, self.scenario.dp)
        inside = polygon.contains(place[:, 0], place[:, 1])
        if not inside.any():
            empty = Columns(place[:0], area[:0], area[:0])
            return empty, polygon.area * thickness
        steepness = self.ground.field.at(place[inside])["area"].mean()
        wanted = float(polygon.area * steepness)
        depth = _distance(place, [outer, *holes]) * np.where(inside, 1.0, -1.0)
        order = np.argsort(-depth, kind="stable")
        covered = np.cumsum(area[order])
        count = int(np.searchsorted(covered, wanted - 0.5 * area.mean())) + 1
        chosen = np.sort(order[:count])
        chosen = chosen[depth[chosen] > -margin]
        columns = Columns(place[chosen], area[chosen], np.full(len(chosen), thickness))
        return columns, wanted * thickness

    def _raster(self) -> tuple[Columns, float]:
        """Columns where a raster of thickness has half a particle or more."""
        path = file_of(self.scenario.where, self.name, self.table.file or "")
        try:
            raster = read_raster(path)
        except GeodataError as error:
            raise self.error(f".file: {error}", "file") from None
        west, _, _, north = raster.extent
        filled = np.argwhere(np.nan_to_num(raster.values) > 0)
        if not len(filled):
            raise self.error(f".file: {path} is nowhere above 0", "file")
        if np.nanmin(raster.values) < 0:
            raise self.error(f".file: {path} has a thickness below 0", "file")
        (top, left), (bottom, right) = filled.min(axis=0), filled.max(axis=0) + 1
        low = np.array([west + left * raster.cell, north - bottom * raster.cell])
        high = np.array([west + right * raster.cell, north - top * raster.cell])
        place, area = self.ground.columns(low, high, self.scenario.dp)
        thickness = np.nan_to_num(raster.sampled(place[:, 0], place[:, 1]))
        keep = thickness >= 0.5 * self.scenario.dp
        centres = np.column_stack([raster.x[filled[:, 1]], raster.y[filled[:, 0]]])
        steepness = self.ground.field.at(np.ascontiguousarray(centres))["area"]
        depth = raster.values[filled[:, 0], filled[:, 1]]
        asked = float(np.sum(depth * steepness)) * raster.cell**2
        return Columns(place[keep], area[keep], thickness[keep]), asked

    def count(self) -> float:
        """See Body."""
        return self.volume / self.scenario.dp**self.dim

    def particles(self, names: list[str]) -> ParticleSet:
        """See Body: whole layers that share the thickness of each column."""
        columns, dp = self.columns, self.scenario.dp
        layers = np.maximum(1, np.rint(columns.thickness / dp)).astype(int)
        which = np.repeat(np.arange(len(layers)), layers)
        first = np.cumsum(layers) - layers
        level = np.arange(len(which)) - first[which] + 0.5
        height = columns.thickness[which] * level / layers[which]
        position = self.ground.above(columns.place[which], height)
        volume = (columns.area * columns.thickness / layers)[which]
        n = len(position)
        compressed = 1 + self._compression(position)
        return ParticleSet(
            position=position,
            velocity=self.velocity_at(position),
            mass=self.rho0 * volume * compressed,
            density=self.rho0 * compressed,
            smoothing_length=np.full(n, self.scenario.eta * dp),
            motion=np.full(n, FREE, np.int32),
            **self._indices(names, n),
        )


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
    """Of each release that a run begins with: volume asked for, and in particles, m3."""
    found = {}
    for name, table in scenario.body.items():
        if isinstance(table, Release) and name not in scenario.carried:
            body = ReleaseBody(scenario, name, table)
            found[name] = body.asked, body.volume
    return found


def volume_text(asked: float, volume: float, dim: int) -> str:
    """One line about a release."""
    unit = "m3" if dim == 3 else "m2"
    return f"{volume:.5g} {unit} released; area times thickness is {asked:.5g} {unit}"
