"""Liquids that yield: Bingham's and Casson's between plates, mud on a slope, and grains with the
friction mu(I), dry and with water in their pores.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ...case import Case, Control, Criterion, Curve, Outcome, Value, at_most, within
from ...estimators import rms
from ...running import Running, moving

G = 9.81
PROFILE, PLUG = "L2(u)", "speed of the plug"
SURFACE, CREEP = "speed at the surface", "creep at 20 degrees"
STRESS_AT_WALL, HALF = 400.0, 0.5  # Pa, m: those of bingham.toml and casson.toml
VISCOSITY, YIELD_STRESS = 100.0, 160.0  # Pa s, Pa: those of bingham.toml
CASSON_VISCOSITY, CASSON_YIELD_STRESS = 40.0, 100.0  # those of casson.toml
DEPTH, BEAD, PACKING, DENSITY = 0.02, 1e-3, 0.6, 2500.0  # those of chute.toml
MU_S, MU_2, I_0 = 0.382, 0.643, 0.279
VISCOSITY_MAX = 50.0  # Pa s
WET_ANGLE, PORE = 15.0, 0.4  # degrees, share of the pressure: of the saturated chute
MUD_DEPTH, MUD_DENSITY = 0.1, 1000 + 0.37 * 1650  # m, kg/m3: those of mud-film.toml
# Aspen pit 1 at 37 %, table 2 of O'Brien & Julien (1988): dyn/cm2 and poise make 0.1 Pa (s).
MUD_YIELD_STRESS = 0.1 * 0.181 * math.exp(25.7 * 0.37)
MUD_VISCOSITY = 0.1 * 0.036 * math.exp(22.1 * 0.37)


def bingham_speed(y: np.ndarray) -> np.ndarray:
    """u(y) between plates at 0 and 1 m (Bird, Stewart & Lightfoot, Transport Phenomena)."""
    plug = HALF * YIELD_STRESS / STRESS_AT_WALL
    s = np.maximum(np.abs(y - HALF), plug)
    slope = STRESS_AT_WALL / HALF
    return (slope / 2 * (HALF**2 - s**2) - YIELD_STRESS * (HALF - s)) / VISCOSITY


def casson_speed(y: np.ndarray) -> np.ndarray:
    """u(y) of Casson's fluid between plates at 0 and 1 m, eq. (67)."""
    plug = HALF * CASSON_YIELD_STRESS / STRESS_AT_WALL
    s = np.maximum(np.abs(y - HALF), plug)
    sheared = (HALF**2 - s**2) / 2 - 4 / 3 * np.sqrt(plug) * (HALF**1.5 - s**1.5)
    return STRESS_AT_WALL / HALF / CASSON_VISCOSITY * (sheared + plug * (HALF - s))


def between_plates(
    name: str, exact_speed: Callable[[np.ndarray], np.ndarray]
) -> Callable[..., Outcome]:
    """The run of plates by the name of its scenario and its exact profile."""

    def plates(particles: float, *overrides: str) -> Outcome:
        """The profile at the end and the mean speed of the inner part of the plug."""
        run = Running(name, f"particles={particles:g}", *overrides)
        state = moving(run.advance(run.scenario.time_max))
        y, u = state["position"][:, 1], state["velocity"][:, 0]
        exact = exact_speed(y)
        inner = np.abs(y - HALF) < 0.1
        line = np.linspace(0, 1, 201)
        return Outcome(
            {
                PROFILE: Value(rms(u - exact) / rms(exact)),
                PLUG: Value(float(u[inner].mean()), float(exact_speed(np.array(HALF)))),
            },
            [Curve("", u, y, points=True)],
            [Curve("exact", exact_speed(line), line)],
        )

    return plates


def film_speed(z: np.ndarray) -> np.ndarray:
    """u(z) of Bingham's mud on a slope of 20 degrees, eq. (95), m/s."""
    pull = MUD_DENSITY * G * math.sin(math.radians(20))
    sheared = MUD_DEPTH - MUD_YIELD_STRESS / pull
    below = np.clip(z, 0, sheared)
    return pull / MUD_VISCOSITY * (sheared * below - below**2 / 2)


def film(particles: float, *overrides: str) -> Outcome:
    """The steady film of mud, and the speed of the plug on its top."""
    run = Running("mud-film", f"particles={particles:g}", *overrides)
    state = moving(run.advance(run.scenario.time_max))
    z, u = state["position"][:, 1], -state["velocity"][:, 0]
    exact = film_speed(z)
    plug = z > 0.7 * MUD_DEPTH
    line = np.linspace(0, MUD_DEPTH, 101)
    return Outcome(
        {
            PROFILE: Value(rms(u - exact) / rms(exact)),
            PLUG: Value(float(u[plug].mean()), float(film_speed(np.array(MUD_DEPTH)))),
        },
        [Curve("", u, z, points=True)],
        [Curve("Bingham", film_speed(line), line)],
    )


def chute_speed(z: np.ndarray, angle: float = 24.0, pore: float = 0.0) -> np.ndarray:
    """Bagnold's profile of mu(I) on a slope (Jop, Forterre & Pouliquen 2006), m/s, eq. (91a)."""
    theta = math.radians(angle)
    friction = math.tan(theta) / (1 - pore)
    inertial = I_0 * (friction - MU_S) / (MU_2 - friction)
    carried = (1 - pore) * PACKING * G * math.cos(theta)
    scale = 2 / 3 * inertial * math.sqrt(carried) * DEPTH**1.5 / BEAD
    return scale * (1 - (1 - np.clip(z / DEPTH, 0, 1)) ** 1.5)


def chute_profile(particles: float, *overrides: str) -> tuple[np.ndarray, np.ndarray]:
    """(height, speed down the slope) at the end, means over 8 moments of its last fifth."""
    run = Running("chute", f"particles={particles:g}", *overrides)
    heights, speeds = [], []
    for state in run.sampled(np.linspace(0.8, 1, 8) * run.scenario.time_max):
        beads = moving(state)
        heights.append(beads["position"][:, 1])
        speeds.append(-beads["velocity"][:, 0])
    return np.concatenate(heights), np.concatenate(speeds)


def chute(particles: float, *overrides: str) -> Outcome:
    """The steady profile, and how the layer creeps below its angle of friction, 20.9 degrees."""
    y, u = chute_profile(particles, *overrides)
    _, slow = chute_profile(particles, "angle=20", *overrides)
    weight = PACKING * DENSITY * G * math.sin(math.radians(20))
    exact = chute_speed(y)
    top = y > 0.75 * DEPTH
    line = np.linspace(0, DEPTH, 101)
    return Outcome(
        {
            PROFILE: Value(rms(u - exact) / rms(exact)),
            SURFACE: Value(float(u[top].mean()), float(exact[top].mean())),
            CREEP: Value(float(slow.mean()), weight * DEPTH**2 / (3 * VISCOSITY_MAX)),
        },
        [Curve("", u, y, points=True)],
        [Curve("Bagnold", chute_speed(line), line)],
    )


def wet_chute(particles: float, *overrides: str) -> Outcome:
    """The steady profile of saturated beads on a slope that dry ones would lie on."""
    wet = (f"angle={WET_ANGLE}", f"pore={PORE}")
    y, u = chute_profile(particles, *wet, *overrides)
    exact = chute_speed(y, WET_ANGLE, PORE)
    top = y > 0.75 * DEPTH
    line = np.linspace(0, DEPTH, 101)
    return Outcome(
        {
            PROFILE: Value(rms(u - exact) / rms(exact)),
            SURFACE: Value(float(u[top].mean()), float(exact[top].mean())),
        },
        [Curve("", u, y, points=True)],
        [Curve("Bagnold", chute_speed(line, WET_ANGLE, PORE), line)],
    )


BINGHAM_RUN = between_plates("bingham", bingham_speed)
CASSON_RUN = between_plates("casson", casson_speed)
AS_BINGHAM = (
    "material.water.rheology=herschel_bulkley",
    "material.water.casson_viscosity=0",
    f"material.water.consistency={CASSON_VISCOSITY}",
)


def plug_flow(
    name: str, title: str, run: Callable[..., Outcome], control: Control, reason: str
) -> Case:
    """A liquid with a yield stress between plates."""
    return Case(
        name=name,
        title=title,
        across="d/dp",
        resolutions=(10, 20, 40),
        run=run,
        criteria=(
            Criterion(PROFILE, (at_most(0.08), at_most(0.04), at_most(0.02)), reason),
            Criterion(
                PLUG, (within(0.08), within(0.04), within(0.02)), "as for the profile", "m/s"
            ),
        ),
        axes=("u (m/s)", "y (m)"),
        controls=(control,),
    )


BINGHAM = plug_flow(
    "bingham",
    "Bingham's plastic between two plates",
    BINGHAM_RUN,
    Control("no yield stress", PLUG, lambda n: BINGHAM_RUN(n, "yield_stress=0")),
    "twice the newtonian bands: a kink at the edge of the plug, and its regularisation",
)
CASSON = plug_flow(
    "casson",
    "Casson's fluid between two plates",
    CASSON_RUN,
    Control("Bingham's plastic of the same numbers", PLUG, lambda n: CASSON_RUN(n, *AS_BINGHAM)),
    "those of Bingham's plastic; viscosity_max adds 0.3 %",
)
CHUTE = Case(
    name="granular-chute",
    title="Dense granular flow down a chute",
    across="depth/dp",
    resolutions=(8, 16, 32),
    run=chute,
    criteria=(
        Criterion(
            PROFILE,
            (at_most(0.12), at_most(0.05), at_most(0.02)),
            "a parabola of the same surface speed is 8 % away; order 1.5 to the coarser ones",
        ),
        Criterion(SURFACE, (within(0.12), within(0.05), within(0.02)), "as for the profile", "m/s"),
        Criterion(
            CREEP,
            (within(0.1),),
            "friction holds the layer: it creeps as a liquid of viscosity_max, but for its surface",
            "m/s",
        ),
    ),
    axes=("speed (m/s)", "y (m)"),
    controls=(
        Control(
            "friction that does not grow with I",
            SURFACE,
            lambda n: chute(n, "material.beads.mu_2=0.382"),
        ),
    ),
)
WET_CHUTE = Case(
    name="saturated-chute",
    title="Saturated grains down a chute",
    across="depth/dp",
    resolutions=(8, 16, 32),
    run=wet_chute,
    criteria=(
        Criterion(PROFILE, (at_most(0.12), at_most(0.05), at_most(0.02)), "as for dry grains"),
        Criterion(SURFACE, (within(0.12), within(0.05), within(0.02)), "as for dry grains", "m/s"),
    ),
    axes=("speed (m/s)", "y (m)"),
    controls=(Control("no pore pressure", SURFACE, lambda n: wet_chute(n, "pore=0")),),
)
MUD_FILM = Case(
    name="mud-film",
    title="Film of mud on a slope",
    across="depth/dp",
    resolutions=(8, 12, 16),
    run=film,
    criteria=(
        Criterion(
            PROFILE,
            (at_most(0.08), at_most(0.06), at_most(0.04)),
            "those of Bingham's plastic between plates, where as few particles shear",
        ),
        Criterion(PLUG, (within(0.08), within(0.06), within(0.04)), "as for the profile", "m/s"),
    ),
    axes=("speed (m/s)", "y (m)"),
    controls=(
        Control("mud of another pit", PLUG, lambda n: film(n, "material.mud.soil=aspen_pit_2")),
    ),
)
CASES = (BINGHAM, CASSON, CHUTE, WET_CHUTE, MUD_FILM)
