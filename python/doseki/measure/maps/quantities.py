"""What is mapped: names, units, and what other programs call it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MapQuantity:
    """One map.

    Attributes:
        name: of its file in DIR/maps.
        unit: in files.
        label: what it is, for pictures and metadata.
        avaframe: what AvaFrame calls the like of it; its pft is measured normal to the slope, and
            its ppr is in kPa.

    """

    name: str
    unit: str
    label: str
    avaframe: str = ""


PEAK_DEPTH = MapQuantity("peak_depth", "m", "largest depth, vertical", "pft")
PEAK_SPEED = MapQuantity("peak_speed", "m/s", "largest speed", "pfv")
PEAK_PRESSURE = MapQuantity("peak_pressure", "Pa", "largest dynamic pressure rho v2", "ppr")
PEAK_TOTAL_PRESSURE = MapQuantity(
    "peak_total_pressure", "Pa", "largest sum of rho v2 and the weight on the bed"
)
PEAK_MOMENTUM_FLUX = MapQuantity("peak_momentum_flux", "m3/s2", "largest momentum flux h v2")
PEAK_TRAVEL_ANGLE = MapQuantity(
    "peak_travel_angle", "deg", "largest travel angle of what came by", "pta"
)
ARRIVAL_TIME = MapQuantity("arrival_time", "s", "time of arrival")
DEPOSIT = MapQuantity("deposit", "m", "depth of what has come to rest, vertical")

PEAKS = (PEAK_DEPTH, PEAK_SPEED, PEAK_PRESSURE, PEAK_TOTAL_PRESSURE, PEAK_MOMENTUM_FLUX)
REMEMBERED = (*PEAKS, PEAK_TRAVEL_ANGLE, ARRIVAL_TIME)  # of all the time so far
QUANTITIES = (*REMEMBERED, DEPOSIT)
