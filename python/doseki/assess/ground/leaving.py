"""What left a run over the edge of its map, or into cells without data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ...measure.maps.leaving import EDGE, HOLE, OUTFLOW
from ...record.units import unit_in
from ...util.finding import Finding, percent, place_text

LOST = 0.01  # share of the mass from which on it is told of
UNSEEN = "unseen"  # the key of what no snapshot had before it left
LACK = "run-out, maps and deposit are without it"
MEANT = "or give an [outflow] where it may leave"


@dataclass(frozen=True)
class LeftTheMap(Finding):
    """A flow that went on beyond the edge of the map."""

    share: float
    side: str

    def __str__(self) -> str:
        most = f", most by the {self.side} side" if self.side else ""
        return (
            f"{self.place}: {percent(self.share)} of the mass left over the edge of the map"
            f"{most}; {LACK}: take a larger map, {MEANT}"
        )


@dataclass(frozen=True)
class LeftIntoHoles(Finding):
    """A flow that vanished where the map has no data."""

    share: float
    at: tuple[float, ...]  # m

    def __str__(self) -> str:
        return (
            f"{self.place}: {percent(self.share)} of the mass vanished into cells without data, "
            f"around ({place_text(self.at)}) m; {LACK}: fill these cells (gdal_fillnodata IN OUT), "
            f"{MEANT}"
        )


@dataclass(frozen=True)
class LeftUnseen(Finding):
    """Mass of which no snapshot shows the way out."""

    share: float

    def __str__(self) -> str:
        return (
            f"{self.place}: {percent(self.share)} of the mass left before a snapshot had it, so "
            "that it is not known whether over the edge of the map, into cells without data or "
            "through outflows: a shorter time_out would tell"
        )


def leaving_findings(said: Mapping[str, Any]) -> Iterator[Finding]:
    """Doubts about a run by its summary: what an outflow takes is meant."""
    left, mass = said.get("left"), said["mass_initial"] + said["mass_entered"]
    if not left or not mass:
        return
    if (share := left[EDGE] / mass) >= LOST:
        yield LeftTheMap("terrain", share, left["side"])
    if (share := left[HOLE] / mass) >= LOST:
        yield LeftIntoHoles("terrain", share, tuple(left["hole"]))
    if (share := unseen_share(said)) >= LOST:
        yield LeftUnseen("terrain", share)


def lost_share(said: Mapping[str, Any]) -> float:
    """Share of the mass that went over the edge of the map and into cells without data.

    With it what no snapshot had before it left, which may have gone there.
    """
    left, mass = said.get("left"), said["mass_initial"] + said["mass_entered"]
    seen = float(left[EDGE] + left[HOLE]) / mass if left and mass else 0.0
    return seen + unseen_share(said)


def unseen_share(said: Mapping[str, Any]) -> float:
    """Share of the mass that left before a snapshot had it."""
    left, mass = said.get("left"), said["mass_initial"] + said["mass_entered"]
    return float(left.get(UNSEEN, 0.0)) / mass if left and mass else 0.0


def left_text(left: Mapping[str, Any], dim: int) -> str:
    """How what has left shares out, on one line."""
    ways = {
        EDGE: "over the edge of the map",
        HOLE: "into cells without data",
        OUTFLOW: "through outflows",
        UNSEEN: "before a snapshot had it",
    }
    unit = unit_in("kg", dim)
    told = [f"{left[way]:.4g} {unit} {words}" for way, words in ways.items() if left.get(way)]
    return f"left {', '.join(told)}" if told else ""
