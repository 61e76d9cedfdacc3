"""Units of numbers in a scenario file, and strings such as "25 mm" that name theirs."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,4})?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})(\s*[^\d\s.].*|\s+1/\S+\s*)")
_SPELLINGS = str.maketrans({"²": "2", "³": "3", "µ": "u", "μ": "u", "^": None, "·": " "})


@dataclass(frozen=True, eq=False)
class Unit:
    """What a number measures, and the units that a string may give it in.

    `factors` are by unit, the first of which is that of numbers without one.
    """

    what: str
    example: str
    factors: Mapping[str, Fraction]

    @property
    def own(self) -> str:
        """The unit of numbers without one."""
        return next(iter(self.factors))

    @property
    def allowed(self) -> str:
        """What a key may be given, in words."""
        words = [word for word in self.factors if word != "°"]
        return f'a number in {self.own} or a string such as "{self.example}" ({", ".join(words)})'

    def factor(self, word: str) -> float | None:
        """What one `word`, such as "mm", is in the own unit; None where it is no such unit."""
        factor = self.factors.get(_spelt(word))
        return None if factor is None else float(factor)

    def read(self, text: str) -> float | None:
        """The number that a string such as "25 mm" gives, in the own unit; None if it is none."""
        number, word = _parts(text)
        factor = self.factors.get(word)
        return None if factor is None or number is None else float(number * factor)


def _parts(text: str) -> tuple[Fraction | None, str]:
    """Number and unit of a string; no number where it is not one with a unit."""
    found = _QUANTITY.fullmatch(text) if len(text) <= 100 else None
    if found is None or not math.isfinite(float(found[1])):
        return None, ""
    # Exact, so that "35 mm" is the number that 0.035 is.
    number = Fraction(found[1]) if float(found[1]) else Fraction(0)
    return number, _spelt(found[2])


def _spelt(word: str) -> str:
    """A unit as `factors` spell it."""
    return " ".join(word.translate(_SPELLINGS).split())


def _of(what: str, example: str, factors: Mapping[str, str | float | Fraction]) -> Unit:
    return Unit(what, example, {word: Fraction(factor) for word, factor in factors.items()})


_DEGREE = Fraction(math.pi) / 180
LENGTH = _of("a length", "25 mm", {"m": "1", "cm": "1e-2", "mm": "1e-3", "um": "1e-6", "km": "1e3"})
AREA = _of("an area", "2 cm2", {"m2": "1", "cm2": "1e-4", "mm2": "1e-6"})
TIME = _of("a time", "20 ms", {"s": "1", "ms": "1e-3", "us": "1e-6", "min": "60", "h": "3600"})
FREQUENCY = _of("a frequency", "2 kHz", {"Hz": "1", "kHz": "1e3", "1/s": "1"})
SPEED = _of(
    "a speed",
    "40 km/h",
    {"m/s": "1", "cm/s": "1e-2", "mm/s": "1e-3", "km/h": Fraction(10, 36), "km/s": "1e3"},
)
ACCELERATION = _of("an acceleration", "981 cm/s2", {"m/s2": "1", "cm/s2": "1e-2"})
ANGLE = _of("an angle", "20 deg", {"degrees": "1", "deg": "1", "°": "1", "rad": 1 / _DEGREE})
ANGULAR_SPEED = _of(
    "an angular speed", "30 rpm", {"rad/s": "1", "deg/s": _DEGREE, "rpm": 6 * _DEGREE}
)
MASS = _of("a mass", "20 kg", {"kg": "1", "g": "1e-3", "t": "1e3"})
LINE_MASS = _of("a mass per length", "20 kg/m", {"kg/m": "1", "g/m": "1e-3", "t/m": "1e3"})
RATE = _of(
    "a rate",
    "3 L/s",
    {"m3/s": "1", "L/s": "1e-3", "l/s": "1e-3", "L/min": Fraction(1, 60000),
     "m3/h": Fraction(1, 3600)},
)  # fmt: skip
DENSITY = _of("a density", "1.5 g/cm3", {"kg/m3": "1", "g/cm3": "1e3", "t/m3": "1e3"})
PRESSURE = _of(
    "a pressure",
    "2 MPa",
    {"Pa": "1", "hPa": "1e2", "kPa": "1e3", "MPa": "1e6", "GPa": "1e9", "bar": "1e5"},
)
VISCOSITY = _of("a viscosity", "5 mPa s", {"Pa s": "1", "mPa s": "1e-3"})
KINEMATIC_VISCOSITY = _of(
    "a kinematic viscosity", "1 mm2/s", {"m2/s": "1", "cm2/s": "1e-4", "mm2/s": "1e-6"}
)
ENERGY_OF_AREA = _of(
    "an energy of an area",
    "20 J/m2",
    {"J/m2": "1", "N/m": "1", "kJ/m2": "1e3", "mJ/m2": "1e-3", "kN/m": "1e3", "N/mm": "1e3"},
)
NUMBER_OF_VOLUME = _of(
    "a number in a volume", "1e20 1/cm3", {"1/m3": "1", "1/cm3": "1e6", "1/mm3": "1e9"}
)
UNITS = (
    LENGTH, AREA, TIME, FREQUENCY, SPEED, ACCELERATION, ANGLE, ANGULAR_SPEED, MASS, LINE_MASS,
    RATE, DENSITY, PRESSURE, VISCOSITY, KINEMATIC_VISCOSITY,
    ENERGY_OF_AREA, NUMBER_OF_VOLUME,
)  # fmt: skip
_BY_WORD = {word: unit for unit in UNITS for word in unit.factors}


def unit_named(word: str) -> Unit | None:
    """The unit that has `word` among its words, such as "mm" or "m"."""
    return _BY_WORD.get(word)


def quantity(text: str) -> tuple[float, Unit] | None:
    """The number, in its unit's own word, and unit of a string such as "25 mm"; else None."""
    unit = _BY_WORD.get(_parts(text)[1])
    value = unit.read(text) if unit is not None else None
    return None if unit is None or value is None else (value, unit)


@dataclass(frozen=True)
class Measured:
    """What numbers of a key measure, also those in a list.  It annotates the type of the key.

    `plane` is the unit in 2-D where it is another; `words` are strings that stand for numbers.
    """

    unit: Unit
    plane: Unit | None = None
    words: tuple[str, ...] = ()

    def within(self, index: int) -> Measured:
        """What an entry of a list measures."""
        return self

    def unit_in(self, dim: Any) -> Unit:
        """The unit in a run of `dim` dimensions."""
        return self.plane if self.plane is not None and dim != 3 else self.unit


@dataclass(frozen=True)
class MeasuredColumns:
    """What the columns of a key that is a list of rows measure; None: plain numbers."""

    columns: tuple[Unit | None, ...]
    is_row: bool = False

    def within(self, index: int) -> MeasuredColumns | Measured | None:
        """What an entry of the list, a row, or of a row measures."""
        if not self.is_row:
            return MeasuredColumns(self.columns, True)
        unit = self.columns[index] if index < len(self.columns) else None
        return Measured(unit) if unit is not None else None
