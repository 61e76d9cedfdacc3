"""What a dam has held and let over, and how the masses close."""

from __future__ import annotations

import numpy as np

from ..record.reader import Run
from ..scenario.gauges.gauge import Gauge
from ..scenario.gauges.loads.overtopping import Overtopping
from .loads import DamBalance, Peak
from .views import gauge_record, tables

OVER = ("mass_over", "volume_over")  # which older records do not have


def dam_balances(run: Run) -> list[DamBalance]:
    """One for each gauge of kind overtopping that has a sample."""
    found = []
    for name, gauge in tables(run, "gauge", Gauge).items():
        if not isinstance(gauge, Overtopping):
            continue
        record = gauge_record(run, name)
        if not len(record["time"]):
            continue
        upstream = record["mass_upstream"]
        over = {key: record[key][-1] if key in record else np.nan for key in OVER}
        highest = int(np.argmax(upstream))
        found.append(
            DamBalance(
                name=name,
                mass_upstream=float(upstream[-1]),
                volume_upstream=float(record["volume_upstream"][-1]),
                mass_passed=float(record["mass_passed"][-1]),
                volume_passed=float(record["volume_passed"][-1]),
                **{key: float(value) for key, value in over.items()},
                most_upstream=Peak(float(upstream[highest]), float(record["time"][highest])),
                residual=float(
                    upstream[0]
                    + record["mass_supplied"][-1]
                    - record["mass_passed"][-1]
                    - upstream[-1]
                ),
            )
        )
    return found
