"""Loads on structures as text, and as the files loads.json and loads.csv of a run."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..measure.loads import (
    BodyLoad,
    DamBalance,
    Expected,
    Peak,
    body_loads,
    comes_from_behind,
)
from ..measure.overtopping import dam_balances
from ..measure.views import gauge_record, tables
from ..record.reader import Run
from ..record.units import unit_in
from ..scenario.gauges.gauge import Gauge
from ..scenario.gauges.loads.approach import Approach
from ..util.files import write_whole_text
from ..util.finding import Finding

FORMAT = 1  # of loads.json
HEADER = ("gauge", "what", "quantity", "value", "unit", "time [s]")
WITH = ", with bodies"  # after the name of a formula
TOLERANCE = 1e-9  # of the masses of a dam, over the largest of them


@dataclass(frozen=True)
class Loads:
    """All that was measured for design in a run."""

    dim: int
    bodies: list[BodyLoad]
    dams: list[DamBalance]

    def __bool__(self) -> bool:
        return bool(self.bodies or self.dams)


@dataclass(frozen=True)
class AgainstFlow(Finding):
    """A section through which the flow comes from behind."""

    direction: tuple[float, ...]

    def __str__(self) -> str:
        now, turned = (
            ", ".join(repr(sign * x + 0.0).removesuffix(".0") for x in self.direction)
            for sign in (1, -1)
        )
        return (
            f"{self.place} = [{now}] points against the flow: thrust on its structure counts as "
            f"negative, and design formulas are left out; set it to [{turned}]"
        )


def sections_turned_round(run: Run) -> list[AgainstFlow]:
    """A finding for each gauge of kind approach through which the flow came from behind."""
    return [
        AgainstFlow(f"gauge.{name}.direction", tuple(gauge.direction.tolist()))
        for name, gauge in tables(run, "gauge", Gauge).items()
        if isinstance(gauge, Approach)
        and name in run.gauges
        and comes_from_behind(gauge_record(run, name))
    ]


def loads_of(run: Run) -> Loads:
    """The loads and dams of a run; none where it has no such gauges."""
    return Loads(run.scenario["dim"], body_loads(run), dam_balances(run))


def write_loads(run: Run) -> Loads:
    """Write loads.json and loads.csv where a run has gauges for them."""
    loads = loads_of(run)
    if loads:
        write_whole_text(run.folder.loads, json.dumps(as_json(loads), indent=2) + "\n")
        write_whole_text(run.folder.loads_table, as_csv(loads))
    return loads


def load_lines(loads: Loads) -> Iterator[tuple[str, str]]:
    """A name and a text for each line of a summary."""
    for body in loads.bodies:
        yield from _body_lines(body)
    for dam in loads.dams:
        yield from _dam_lines(dam, loads.dim)


def _body_lines(body: BodyLoad) -> Iterator[tuple[str, str]]:
    total = body.parts["total"]
    way = ", ".join(f"{x:.3g}" for x in body.direction)
    yield f"load {body.name}", _peaks_text(body)
    if math.isnan(body.step_peak.time):
        return
    shares = ", ".join(
        f"{part} {series.impulse:.4g}" for part, series in body.parts.items() if part != "total"
    )
    unit = _impulse_unit(body.unit)
    yield "", f"along ({way}); impulse {total.impulse:.4g} {unit} = {shares}"
    if any(math.isnan(peak.value) for peak in total.means.values()):
        yield "", f"no running mean shorter than the interval, {body.interval:.3g} s"
    for each in [*body.design, *([body.boulder] if body.boulder else [])]:
        unit = "N" if each is body.boulder else body.unit
        pressure = "" if each.pressure is None else f", {each.pressure.value:.4g} Pa"
        yield "", f"{_formula(body, each)}: {_at(each.force, unit)}{pressure}"
    if body.design and body.with_bodies:
        yield (
            "",
            f"with bodies: gauge.{body.with_bodies} has no `material`, and counts them as flow",
        )


def _formula(body: BodyLoad, each: Expected) -> str:
    """Its name, which says where the flow that it is fed with has bodies in it."""
    return each.formula + (WITH if body.with_bodies and each is not body.boulder else "")


def _peaks_text(body: BodyLoad) -> str:
    if math.isnan(body.step_peak.time):
        return "nothing acted"
    text = f"peak {_at(body.step_peak, body.unit)} at a step"
    for window, peak in body.parts["total"].means.items():
        if not math.isnan(peak.time):
            text += f", {_at(peak, body.unit)} over {1e3 * window:g} ms"
    return text


def _dam_lines(dam: DamBalance, dim: int) -> Iterator[tuple[str, str]]:
    mass, volume = unit_in("kg", dim), unit_in("m3", dim)
    over = ""
    if math.isfinite(dam.mass_over):
        over = f"{dam.mass_over:.5g} {mass} ({dam.volume_over:.4g} {volume}) of it over the crest, "
    yield (
        f"dam {dam.name}",
        f"past the plane {dam.mass_passed:.5g} {mass} ({dam.volume_passed:.4g} {volume}), {over}"
        f"upstream {dam.mass_upstream:.5g} {mass} ({dam.volume_upstream:.4g} {volume}), "
        f"residual {dam.residual:.2g}",
    )


def _at(peak: Peak, unit: str) -> str:
    return f"{peak.value:.4g} {unit} ({peak.time:.4g} s)"


def _impulse_unit(force: str) -> str:
    return "N s" if force == "N" else "N s/m"


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _peak(peak: Peak) -> dict[str, float | None]:
    return {"value": _number(peak.value), "time": _number(peak.time)}


def _expected(each: Expected) -> dict[str, Any]:
    said: dict[str, Any] = {"formula": each.formula, "force": _peak(each.force)}
    return said if each.pressure is None else said | {"pressure": _peak(each.pressure)}


def as_json(loads: Loads) -> dict[str, Any]:
    """The contents of loads.json; null where a number is not known."""
    return {
        "format": FORMAT,
        "bodies": {
            body.name: {
                "unit": body.unit,
                "direction": body.direction.tolist(),
                "interval": body.interval,
                "step_peak": _peak(body.step_peak),
                "parts": {
                    part: {
                        "impulse": _number(series.impulse),
                        "means": {f"{1e3 * w:g} ms": _peak(p) for w, p in series.means.items()},
                    }
                    for part, series in body.parts.items()
                },
                "design": [_expected(each) for each in body.design],
                "design_with_bodies": bool(body.design and body.with_bodies),
                "boulder": None if body.boulder is None else _expected(body.boulder),
            }
            for body in loads.bodies
        },
        "dams": {
            dam.name: {
                key: _peak(value) if isinstance(value, Peak) else _number(value)
                for key, value in vars(dam).items()
                if key != "name"
            }
            for dam in loads.dams
        },
    }


def as_csv(loads: Loads) -> str:
    """The contents of loads.csv: a row for each number."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for body in loads.bodies:
        writer.writerows(_body_rows(body))
    mass, volume = unit_in("kg", loads.dim), unit_in("m3", loads.dim)
    for dam in loads.dams:
        for key, value in vars(dam).items():
            if isinstance(value, Peak):
                writer.writerow((dam.name, "dam", key, value.value, mass, value.time))
            elif key != "name":
                unit = volume if key.startswith("volume") else mass
                writer.writerow((dam.name, "dam", key, value, unit, ""))
    return text.getvalue()


def _body_rows(body: BodyLoad) -> Iterator[tuple[object, ...]]:
    peak = body.step_peak
    yield body.name, "total", "peak at a step", peak.value, body.unit, peak.time
    for part, series in body.parts.items():
        for window, mean in series.means.items():
            quantity = f"mean over {1e3 * window:g} ms"
            yield body.name, part, quantity, mean.value, body.unit, mean.time
        yield body.name, part, "impulse", series.impulse, _impulse_unit(body.unit), ""
    for each in body.design:
        name = _formula(body, each)
        yield body.name, name, "force", each.force.value, body.unit, each.force.time
        if each.pressure is not None:
            pressure = each.pressure
            yield body.name, name, "pressure", pressure.value, "Pa", pressure.time
    if body.boulder is not None:
        force = body.boulder.force
        yield body.name, body.boulder.formula, "force", force.value, "N", force.time
