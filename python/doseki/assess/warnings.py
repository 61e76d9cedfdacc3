"""Warnings before a run: what is likely to go wrong, with the remedy."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..driver.gauges import outside_everything
from ..record.particles import BOUND, DRIVEN, FIXED, FREE
from ..scenario.model import Scenario
from ..scenario.schemes import RESOLVED, UETA2022
from ..scenario.tables.bodies import Grains
from ..scene.ground import ground_of
from ..util.finding import Finding, no_more_than
from .estimates import (
    State,
    flow_depths,
    gap,
    grain_spacings,
    mach_number,
)
from .ground.pits import narrow_pits
from .ground.sliding import Sliding
from .open_sides import open_sides
from .rheology import rheology_findings
from .sound_speed import raised, usual_speed
from .without_effect import keys_without_effect

MIN_ACROSS_GRAIN = 6  # particles; below, a grain is not resolved
MIN_ACROSS_FLOW = 10  # particles over the depth; below, a film is too viscous
LOOSE = 0.6  # solid fraction of discs; below, few touch two others
OPEN = 0.9  # of `wetted`; below, water finds a way between discs that touch
MAX_MACH = 0.1  # for which weak compressibility is a good approximation
TOUCHING = 1.5  # spacings; beyond, two bodies are apart
REACH = 4  # spacings within which a neighbour is looked for


@dataclass(frozen=True)
class UnresolvedGrains(Finding):
    """Grains, in the paper's scheme, of too few particles to be bodies."""

    across: float  # particles

    def __str__(self) -> str:
        return (
            f"{self.across:.2g} particles across a grain: grains are points that neither roll nor"
            f" collide as bodies; resolved ones need dp = diameter/{MIN_ACROSS_GRAIN} or less"
        )


@dataclass(frozen=True)
class ShallowFlow(Finding):
    """Too few particles over the depth of a flow."""

    across: float  # particles
    dp: float  # m
    on_slope: bool = False  # `across` is that of the highest particle above a map

    def __str__(self) -> str:
        enough = self.across * self.dp / MIN_ACROSS_FLOW
        depth = "largest depth, upright" if self.on_slope else "depth"
        return (
            f"{self.place}: {self.across:.2g} particles over its {depth}; below {MIN_ACROSS_FLOW}"
            f" it flows too slowly: dp = {no_more_than(enough)} would do"
        )


@dataclass(frozen=True)
class ThinWall(Finding):
    """A wall so thin that fluid on its two sides meets through it, or feels its end."""

    layers: int
    needed: int
    dp: float  # m
    has_faces: bool  # as those of the resolved scheme have

    def __str__(self) -> str:
        wall = f"{self.layers} layers is thinner than the kernel's reach"
        if self.layers == 1 and self.has_faces:
            wall = "1 layer has one face, and lets fluid through where there is fluid on both sides"
        thick = f"{self.needed} layers ({self.needed * self.dp:.3g} m) thick"
        return f"{self.place}: a wall of {wall}; make it {thick}"


@dataclass(frozen=True)
class LargeRoughness(Finding):
    """Roughness larger than the flow is deep: no wall law describes that."""

    ks: float  # m
    depth: float  # m

    def __str__(self) -> str:
        return (
            f"{self.place} = {self.ks:.3g} m is larger than the depth of the flow,"
            f" {self.depth:.3g} m: model such roughness as bodies"
        )


@dataclass(frozen=True)
class WeakMass(Finding):
    """A fluid that shears more easily than it slides on a bed of Voellmy's friction."""

    mu: float
    fluid: str
    least: float  # coefficient of friction inside that the bed asks for

    def __str__(self) -> str:
        turbulent = f" and with xi {self.least:.2g} in a fast flow" if self.least > self.mu else ""
        return (
            f"{self.place} = {self.mu:g}{turbulent}: {self.fluid} has less friction inside, shears"
            " over its lowest layer and leaves that behind, the more the smaller dp is; give it a"
            " yield stress, or mu_s above that"
        )


@dataclass(frozen=True)
class GaugeOutside(Finding):
    """A gauge where there will be nothing to read."""

    position: tuple[float, ...]  # m

    def __str__(self) -> str:
        return f"{self.place} = {list(self.position)} m lies outside everything in the scene"


@dataclass(frozen=True)
class HighMach(Finding):
    """Speeds too high for the reduced sound speed."""

    speed: float  # m/s
    mach: float
    key: str  # by which the scenario gives the sound speed
    value: float  # of the key

    def __str__(self) -> str:
        return (
            f"speeds up to {self.speed:.3g} m/s are Mach {self.mach:.2g}; for Mach {MAX_MACH} set"
            f" {raised(self.key, self.value, self.mach / MAX_MACH)}"
        )


@dataclass(frozen=True)
class NoUplift(Finding):
    """Bodies that water does not press on where they lie on something."""

    def __str__(self) -> str:
        return (
            f"{self.place}: false: water does not press on bodies from below where they lie on a "
            "bed or on one another, so that these do not float and keep the friction of their full "
            "weight; set uplift = true"
        )


@dataclass(frozen=True)
class ClosedPores(Finding):
    """Grains of a plane that touch: no water goes in or out of the pores between them."""

    def __str__(self) -> str:
        return (
            f"{self.place}: discs that touch close the pores between them, which are open in space;"
            " water there keeps whatever pressure it had, so that discs of a pile have 0.4 to 1.4"
            " of their uplift: set it to 0.75, or dim = 3"
        )


@dataclass(frozen=True)
class FinePores(Finding):
    """Suction in pores between bodies that no particle resolves."""

    across: float  # particles

    def __str__(self) -> str:
        return (
            f"{self.place}: pores between touching bodies are {self.across:.2g} particles wide; "
            "what suction does in pores of less than 1 the kernel does not see: make dp "
            f"{1 / self.across:.2g} times smaller, or set it to 0"
        )


@dataclass(frozen=True)
class Detached(Finding):
    """A free body that touches nothing: under gravity it falls before the flow begins."""

    gap: float  # spacings to its nearest neighbour; inf: more than REACH

    def __str__(self) -> str:
        said = f"{self.gap:.2g} dp" if math.isfinite(self.gap) else f"more than {REACH} dp"
        return (
            f"{self.place}: touches nothing, its nearest neighbour is {said} away;"
            " move it if it should rest"
        )


def findings(
    scenario: Scenario, state: State, body_names: list[str], of_scene: Sequence[Finding] = ()
) -> list[Finding]:
    """Every doubt about the particles of `state` (the core's fields) that is found at once.

    `of_scene` are those that came up when the scene was built; they come first.
    """
    names = dict(enumerate(body_names))
    depths = flow_depths(scenario, state, names)
    deepest = max(depths.values(), default=0.0)
    found = [*of_scene, *_grains(scenario), *_flow_depth(scenario, depths)]
    found += [*_walls(scenario, state, names), *_roughness(scenario, depths)]
    found += [*_voellmy(scenario, depths), *_gauges(scenario, state), *_mach(scenario, state)]
    found += [*open_sides(scenario, state, names), *keys_without_effect(scenario, state, names)]
    found += [*_films(scenario, state), *rheology_findings(scenario, deepest)]
    return list(dict.fromkeys(found))


def thorough_findings(sliding: Sliding, of_scene: Sequence[Finding] = ()) -> list[Finding]:
    """Those of `findings`, and those that take a while to find, of a scene as it starts."""
    scenario, state, names = sliding.scenario, sliding.state, sliding.names
    at_once = findings(scenario, state, names, of_scene)
    slow = [*_detached(scenario, state, dict(enumerate(names))), *narrow_pits(sliding)]
    return [*at_once, *slow]


def _grains(scenario: Scenario) -> Iterator[Finding]:
    across = grain_spacings(scenario) if scenario.scheme == UETA2022 else None
    if across is not None and across < MIN_ACROSS_GRAIN:
        yield UnresolvedGrains("", across)


def _flow_depth(scenario: Scenario, depths: Mapping[str, float]) -> Iterator[Finding]:
    for name, across in depths.items():
        if across < MIN_ACROSS_FLOW - 1e-6:
            on_slope = scenario.bed is not None and name not in scenario.inflow
            yield ShallowFlow(name, across, scenario.dp, on_slope)


def _walls(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[Finding]:
    if scenario.has_bodies_alone:
        return  # which meet the shapes of walls, not their particles
    faced = scenario.scheme == RESOLVED
    # Walls with faces are to keep apart the rows on their sides, others to fill the kernel.
    needed = math.ceil(scenario.support / scenario.dp - (1 if faced else 0.5) - 1e-9)
    for body, name in names.items():
        table = scenario.body.get(name)
        of_it = (state["body"] == body) & (state["motion"] == FIXED)
        if table is None or not of_it.any():
            continue
        layers = table.layers(scenario.dp)
        if layers is not None and layers < needed:
            yield ThinWall(name, layers, needed, scenario.dp, faced)


def _roughness(scenario: Scenario, depths: Mapping[str, float]) -> Iterator[Finding]:
    depth = min((across * scenario.dp for across in depths.values()), default=math.inf)
    rough = [(f"{'.'.join(keys)}.ks", wall.given("ks")) for keys, wall in scenario.walls.items()]
    rough += [(f"inflow.{name}.ks", inflow.ks) for name, inflow in scenario.inflow.items()]
    for place, ks in rough:
        if ks is not None and ks > depth:
            yield LargeRoughness(place, ks, depth)


def _voellmy(scenario: Scenario, depths: Mapping[str, float]) -> Iterator[Finding]:
    """Voellmy's law is one of a mass that slides as a whole."""
    beds = {keys: wall for keys, wall in scenario.walls.items() if wall.given("mu")}
    if not beds:
        return
    depth = max(depths.values(), default=math.inf) * scenario.dp
    for keys, wall in beds.items():
        mu, xi = wall.given("mu"), wall.given("turbulent_xi")
        for name in scenario.liquids:
            fluid = scenario.materials[name]
            if fluid.rheology not in {"newtonian", "mu_i"}:
                continue
            inside = fluid.of_laws["mu_s"] if fluid.rheology == "mu_i" else 0.0
            fast = usual_speed(scenario, fluid)
            borne = 1 - fluid.of_laws["pore_pressure_ratio"]
            least = mu + (fast**2 / (xi * depth * borne) if xi else 0.0)
            if inside < least:
                yield WeakMass(f"{'.'.join(keys)}.mu", mu, name, least)


def _gauges(scenario: Scenario, state: State) -> Iterator[Finding]:
    for name, place in outside_everything(scenario, state).items():
        yield GaugeOutside(f"gauge.{name}.position", tuple(place.tolist()))


def _mach(scenario: Scenario, state: State) -> Iterator[Finding]:
    found = mach_number(scenario, state)
    if found is not None and found[1] > MAX_MACH * 1.05:
        yield HighMach("", *found, *scenario.sound_speed_key)


def _films(scenario: Scenario, state: State) -> Iterator[Finding]:
    """Doubts about water between bodies that move."""
    grains, liquids = _rigid_bodies(scenario, state), scenario.liquids
    if not len(grains) or not liquids:
        return
    if not scenario.uplift:
        yield NoUplift("uplift")
    for name, table in scenario.body.items():
        if scenario.dim == 2 and isinstance(table, Grains) and _closes_pores(table):
            yield ClosedPores(f"body.{name}.wetted")
    counts = np.unique(grains, return_counts=True)[1]
    if len(counts) < 2:
        return
    # The smaller gap between three equal discs that touch.
    count = counts.min()
    diameter = 2 * (count / np.pi) ** 0.5 if scenario.dim == 2 else (6 * count / np.pi) ** (1 / 3)
    pore = (2 / 3**0.5 - 1) * diameter
    for name in liquids:
        if scenario.materials[name].air_entry_suction > 0 and pore < 1:
            yield FinePores(f"material.{name}.air_entry_suction", float(pore))


def _closes_pores(grains: Grains) -> bool:
    """Whether most of its grains touch others and water sees them as wide as they are."""
    fills_its_box = grains.count is None and grains.mass_total is None
    dense = fills_its_box or grains.settle or (grains.packing or 0.0) > LOOSE
    return bool(dense) and grains.wetted > OPEN


def _rigid_bodies(scenario: Scenario, state: State) -> np.ndarray:
    """The rigid body of each particle of one that moves."""
    if scenario.scheme == UETA2022 or "grain" not in state:
        return np.zeros(0, np.int32)
    return state["grain"][state["grain"] >= 0]


def _detached(scenario: Scenario, state: State, names: dict[int, str]) -> Iterator[Finding]:
    if not np.any(scenario.gravity):
        return
    for body, name in names.items():
        of_it = state["body"] == body
        is_free = np.isin(state["motion"][of_it], (FREE, BOUND)).all()
        if not is_free or not of_it.any() or of_it.all():
            continue
        others = ~of_it & (state["motion"] != DRIVEN)
        position, reach = state["position"], REACH * scenario.dp
        apart = gap(position[of_it], position[others], reach) / scenario.dp
        if scenario.bed is not None:  # which has particles near fluid alone
            height = ground_of(scenario.bed).height_above(position[of_it]).min()
            apart = min(apart, float(height) / scenario.dp + 0.5)
        if apart > TOUCHING + _rim(scenario, name):
            yield Detached(name, apart)


def _rim(scenario: Scenario, name: str) -> float:
    """How far the particles of grains lie below where they touch, since water sees them smaller."""
    table = scenario.body.get(name)
    if not isinstance(table, Grains):
        return 0.0
    return (1 - table.wetted) * max(d for d, _ in table.rows) / 2 / scenario.dp
