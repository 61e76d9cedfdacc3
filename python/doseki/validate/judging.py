"""From runs to rows of verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..errors import DosekiError
from .case import Case, Control, Criterion, Outcome, Value
from .convergence import fitted_order

PASS, FAIL, REPORTED = "pass", "FAIL", "reported"
SHORT = "falls short"  # misses a band, and is known to


@dataclass(frozen=True)
class Row:
    """One quantity at one resolution, or why there is none."""

    case: str
    quantity: str
    resolution: float
    verdict: str
    value: Value | None = None
    unit: str = ""
    band: str = ""
    order: float | None = None
    note: str = ""

    def table(self) -> dict[str, Any]:
        """The row as JSON holds it."""
        numbers: dict[str, float | None] = {"value": None, "expected": None, "error": None}
        if self.value is not None:
            numbers["value"], numbers["expected"] = self.value.number, self.value.expected
            numbers["error"] = self.value.error
        said = "case quantity resolution verdict unit band order note".split()
        return {name: getattr(self, name) for name in said} | numbers


@dataclass
class Result:
    """A case with its rows, and the outcomes that its picture is drawn from."""

    case: Case
    rows: list[Row] = field(default_factory=list)
    outcomes: dict[float, Outcome] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """The worst of its rows."""
        verdicts = {row.verdict for row in self.rows}
        return next((word for word in (FAIL, SHORT) if word in verdicts), PASS)


def validate_case(case: Case, tier: str, tell: Callable[[str], None]) -> Result:
    """Run a case and its controls; a run that goes wrong is a row that fails."""
    result = Result(case)
    for resolution in case.resolutions_of(tier):
        tell(f"{case.name}: {case.across} = {resolution:g}")
        try:
            result.outcomes[resolution] = case.run(resolution)
        except DosekiError as error:
            result.rows.append(Row(case.name, "", resolution, FAIL, note=str(error)))
            return result
    result.rows += judged(case, result.outcomes)
    for control in case.controls:
        tell(f"{case.name}: control: {control.what}")
        result.rows.append(controlled(case, control))
    return result


def judged(case: Case, outcomes: dict[float, Outcome]) -> list[Row]:
    """The rows of every criterion; the order stands on the row of the finest resolution."""
    rows = []
    for criterion in case.criteria:
        values = {size: outcome.values[criterion.quantity] for size, outcome in outcomes.items()}
        order = fitted_order(list(values), [value.error for value in values.values()])
        finest = max(values)
        rows += [
            _row(case, criterion, size, value, order if size == finest else None)
            for size, value in values.items()
        ]
    return rows


def _row(
    case: Case, criterion: Criterion, resolution: float, value: Value, order: float | None
) -> Row:
    band = criterion.band(case.resolutions.index(resolution))
    asked = [] if band is None else [(str(band), band.holds(value))]
    if order is not None and criterion.order is not None:
        asked.append((f"order at least {criterion.order}", not order < criterion.order))
    verdict = PASS if asked else REPORTED
    if not all(holds for _, holds in asked):
        verdict = SHORT if criterion.short else FAIL
    return Row(
        case.name, criterion.quantity, resolution, verdict, value, criterion.unit,
        ", ".join(text for text, _ in asked), order, criterion.short if verdict == SHORT else "",
    )  # fmt: skip


def controlled(case: Case, control: Control) -> Row:
    """The wrong model, at the coarsest resolution: it must leave the band, with a number."""
    resolution, criterion = case.resolutions[0], case.criterion(control.quantity)
    band = next(band for band in criterion.bands if band is not None)
    row = Row(
        case.name, control.quantity, resolution, FAIL, unit=criterion.unit, band=f"not {band}",
        note=f"control: {control.what}",
    )  # fmt: skip
    try:
        value = control.run(resolution).values[control.quantity]
    except DosekiError as error:
        return replace(row, note=f"{row.note}: {error}")
    caught = math.isfinite(value.number) and not band.holds(value)
    return replace(row, verdict=PASS if caught else FAIL, value=value)


def failed(results: Sequence[Result]) -> bool:
    """Whether any case fails or falls short."""
    return any(result.verdict in (FAIL, SHORT) for result in results)
