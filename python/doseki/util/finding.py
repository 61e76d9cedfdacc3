"""What is doubtful about a scenario."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass

MAP = 1e3  # m; coordinates beyond are those of maps


@dataclass(frozen=True)
class Finding(ABC):
    """Something doubtful: the fields hold the facts, str() is the sentence made from them."""

    place: str  # the body, or the key, that it is about; "" for all of the scenario

    @abstractmethod
    def __str__(self) -> str:
        """One sentence, with the remedy where there is one."""


def place_text(place: Iterable[float]) -> str:
    """Coordinates, m, in four digits; those of a map to a decimetre."""
    return ", ".join(f"{x:.4g}" if abs(x) < MAP else f"{x:.1f}" for x in place)


def percent(share: float) -> str:
    """A share in per cent, of two digits: 100 where `.2g` would say 1e+02."""
    return f"{float(f'{100 * share:.2g}'):g} %"


def no_more_than(most: float) -> str:
    """The largest number of two digits that is no larger: what a remedy may say would do."""
    unit = 10.0 ** (math.floor(math.log10(most)) - 1)
    return f"{math.floor(most / unit + 1e-9) * unit:.2g}"


def no_less_than(least: float) -> str:
    """The smallest number of three digits that is no smaller."""
    return f"{rounded_up(least, digits=3):g}"


def below(value: float, limit: float) -> str:
    """A number below a limit, of two digits or as many as show that it is."""
    shown = (f"{value:.{digits}g}" for digits in range(2, 17))
    return next((text for text in shown if float(text) < limit), repr(value))


def rounded_up(value: float, digits: int = 2) -> float:
    """The next number of so many digits that is not less; what is not finite stays."""
    if not math.isfinite(value) or value <= 0:
        return value
    exponent = math.floor(math.log10(value)) + 1 - digits
    first = math.ceil(value / 10.0**exponent * (1 - 1e-9))
    return float(f"{first}e{exponent}")


def sentences(findings: Iterable[Finding]) -> list[str]:
    """What findings say; what they say alike of copies NAME.1, NAME.2 ... is said once."""
    places: dict[tuple[str, str], list[str]] = {}
    for finding in findings:
        text, stem = str(finding), _stem(finding.place)
        rest = text.removeprefix(f"{finding.place}:") if stem else text
        places.setdefault((stem if rest != text else "", rest), []).append(finding.place)
    return [
        f"{names[0]}{_others(len(names) - 1)}:{rest}" if stem else rest
        for (stem, rest), names in places.items()
    ]


def _stem(place: str) -> str:
    """NAME of NAME.1; nothing for what is no copy."""
    stem, _, number = place.rpartition(".")
    return stem if number.isdigit() else ""


def _others(count: int) -> str:
    return f" and {count} of its copies" if count else ""
