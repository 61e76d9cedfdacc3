"""What the load on a structure comes to: peaks, running means, impulses, and design formulas.

Numbers are read from the record of gauges of kind `load`, `section` and `overtopping`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..record.particles import BOUND, DRIVEN, FREE
from ..record.reader import GaugeRecord, Run
from ..record.units import unit_in
from ..scenario.gauges.gauge import Gauge
from ..scenario.gauges.loads.approach import Approach
from ..scenario.gauges.loads.load import PARTS, Load
from . import design
from .maps.standing import KEYS, clamped_bodies, standing
from .views import gauge_record, tables

WINDOWS = (0.010, 0.100)  # s, of the running means
AGAINST = 0.5  # of all that passed a section, in excess, from which on the flow comes from behind
RESOLVED = 1 + 1e-6  # of a window, the longest interval between samples that shows it


@dataclass(frozen=True)
class Peak:
    """A highest value, and when: of a running mean the middle of its window.

    Where nothing acted it is zero, at no time.
    """

    value: float
    time: float  # s


NO_PEAK, NOTHING = Peak(float("nan"), float("nan")), Peak(0.0, float("nan"))


@dataclass(frozen=True)
class Series:
    """One part of a thrust: N (2-D: N/m)."""

    means: dict[float, Peak]  # by window, s
    impulse: float  # N s (2-D: N s/m)


@dataclass(frozen=True)
class Expected:
    """What a formula expects: its highest value over the run."""

    formula: str
    force: Peak  # N; 2-D: N/m
    pressure: Peak | None = None  # Pa


@dataclass(frozen=True)
class BodyLoad:
    """The load on the bodies of one gauge."""

    name: str
    direction: np.ndarray  # (dim,) along which thrust counts
    step_peak: Peak  # of the thrust, mean over the step of the largest force
    parts: dict[str, Series]  # total, static, dynamic, contact
    unit: str  # of forces
    interval: float  # s, the longest between samples
    design: list[Expected] = field(default_factory=list)
    boulder: Expected | None = None
    with_bodies: str = ""  # the section that takes bodies which move for flow, for the formulas


@dataclass(frozen=True)
class DamBalance:
    """What a dam has held and let over, kg and m3 (2-D: per metre)."""

    name: str
    mass_upstream: float
    volume_upstream: float
    mass_passed: float
    volume_passed: float
    mass_over: float  # of that, what passed above the position; nan: not known
    volume_over: float
    most_upstream: Peak  # kg
    residual: float  # kg: of the mass that was upstream, came and went


def body_loads(run: Run) -> list[BodyLoad]:
    """The loads on the bodies of all gauges of kind load that have two samples or more."""
    gauges = tables(run, "gauge", Gauge)
    found = []
    for name, gauge in gauges.items():
        if isinstance(gauge, Load) and len((record := gauge_record(run, name))["time"]) > 1:
            approach = gauges.get(gauge.approach or "")
            section = approach if isinstance(approach, Approach) else None
            found.append(_body_load(run, name, gauge, record, section))
    return found


def _body_load(
    run: Run, name: str, gauge: Load, record: GaugeRecord, section: Approach | None
) -> BodyLoad:
    dim = run.scenario["dim"]
    gravity = np.array(run.scenario["gravity"], float)
    time = record["time"]
    direction = _direction(record, dim, gravity, section)
    thrust = {part: columns(record, _prefix(part), dim) @ direction for part in ("total", *PARTS)}
    expected: list[Expected] = []
    if section is not None:
        width = gauge.width or 1.0
        g = float(np.linalg.norm(gravity))
        expected = expected_loads(gauge_record(run, str(gauge.approach)), width, g)
    return BodyLoad(
        name=name,
        direction=direction,
        step_peak=_step_peak(record, direction, dim),
        parts={part: _series(time, mean) for part, mean in thrust.items()},
        unit=unit_in("N", dim),
        interval=float(np.diff(time).max()),
        design=expected,
        boulder=_boulder(record),
        with_bodies=str(gauge.approach) if section and _takes_bodies(run, section) else "",
    )


def _takes_bodies(run: Run, section: Approach) -> bool:
    """Whether bodies move beside a liquid that a section cannot tell them from."""
    if section.material is not None or not len(run):
        return False
    state = {key: run[0].stored(key) for key in KEYS}
    clamped = clamped_bodies(run[0].body_names, run.scenario.get("body", {}))
    moving = (state["motion"] == BOUND) & ~standing(state, clamped)
    flows = np.isin(state["motion"], (FREE, DRIVEN)).any() or "inflow" in run.scenario
    return bool(flows and moving.any())


def _prefix(part: str) -> str:
    return "" if part == "total" else f"{part}_"


def columns(record: GaugeRecord, prefix: str, dim: int) -> np.ndarray:
    """The force (n, dim) of a part of a load."""
    return np.stack([record[f"{prefix}force_{axis}"] for axis in "xyz"[:dim]], axis=1)


def _direction(
    record: GaugeRecord, dim: int, gravity: np.ndarray, section: Approach | None
) -> np.ndarray:
    """That of the section; else that of the whole impulse across gravity, where there is one."""
    if section is not None:
        return np.asarray(section.direction / np.linalg.norm(section.direction))
    force, steps = columns(record, "", dim)[1:], np.diff(record["time"])
    whole = steps @ force
    g = np.linalg.norm(gravity)
    level = whole - (whole @ gravity) * gravity / g**2 if g > 0 else whole
    chosen = level if np.linalg.norm(level) > 1e-9 * np.linalg.norm(whole) else whole
    size = np.linalg.norm(chosen)
    return np.asarray(chosen / size) if size > 0 else np.eye(dim)[0]


def _step_peak(record: GaugeRecord, direction: np.ndarray, dim: int) -> Peak:
    thrust = columns(record, "peak_", dim) @ direction
    if not np.isfinite(thrust).any():
        return NO_PEAK
    if not np.nan_to_num(thrust).any():
        return NOTHING
    k = int(np.nanargmax(thrust))
    return Peak(float(thrust[k]), float(record["peak_time"][k]))


def _series(time: np.ndarray, mean: np.ndarray) -> Series:
    """`mean` (n,) of the time since the sample before; the first is none."""
    impulse = np.concatenate([[0.0], np.cumsum(mean[1:] * np.diff(time))])
    means = {window: running_peak(time, impulse, window) for window in WINDOWS}
    return Series(means, float(impulse[-1]))


def running_peak(time: np.ndarray, impulse: np.ndarray, window: float) -> Peak:
    """The highest mean over `window`, s, of what has the integral `impulse` at times (Eq. 99).

    nan where samples are farther apart than the window, or the record is shorter.  Between samples
    the force is constant, so that the highest mean begins or ends at one of them.
    """
    start, end = time[0], time[-1]
    if np.diff(time).max() > window * RESOLVED or end - start < window / RESOLVED:
        return NO_PEAK
    if not impulse.any():
        return NOTHING
    begins = np.concatenate([time, time - window])
    begins = np.unique(np.clip(begins, start, max(start, end - window)))
    later = np.interp(begins + window, time, impulse)
    means = (later - np.interp(begins, time, impulse)) / window
    k = int(np.argmax(means))
    return Peak(float(means[k]), float(begins[k] + 0.5 * window))


def expected_loads(approach: GaugeRecord, width: float, g: float) -> list[Expected]:
    """What formulas expect of the flow that a section gauge has seen, on `width`, m.

    Nothing where the flow went against its direction: along it goes what is thrown back.
    """
    if comes_from_behind(approach):
        return []
    time, h = approach["time"], approach["depth"]
    v, rho = approach["velocity"], approach["density"]
    flows = np.isfinite(v) & (v > 0) & (h > 0)
    if not flows.any():
        return []
    time, h, v, rho = (values[flows] for values in (time, h, v, rho))

    def of_force(formula: str, force: np.ndarray) -> Expected:
        return Expected(formula, _highest(time, width * force))

    def of_pressure(formula: str, pressure: np.ndarray) -> Expected:
        return Expected(formula, _highest(time, width * h * pressure), _highest(time, pressure))

    return [
        of_force("rho v2 h b", design.momentum_flux(h, v, rho)),
        of_force("rho g h2 b / 2", design.hydrostatic(h, rho, g)),
        of_pressure("Huebl & Holzinger (2003)", design.huebl_holzinger(h, v, rho, g)),
        of_pressure("Kwan (2012), alpha 2.5", design.kwan(v, rho)),
    ]


def comes_from_behind(approach: GaugeRecord) -> bool:
    """Whether the flow through a section went against the direction of its gauge."""
    rates = np.nan_to_num(approach["depth"] * approach["velocity"] * approach["density"])
    passed = 0.5 * (rates[1:] + rates[:-1]) * np.diff(approach["time"])
    return bool(passed.sum() < -AGAINST * np.abs(passed).sum())


def _highest(time: np.ndarray, values: np.ndarray) -> Peak:
    k = int(np.argmax(values))
    return Peak(float(values[k]), float(time[k]))


def _boulder(record: GaugeRecord) -> Expected | None:
    force = design.boulder(record["hit_speed"], record["hit_radius"])
    if not force.any():
        return None
    return Expected("Hertz, Kc 0.1, Kwan (2012)", _highest(record["time"], force))
