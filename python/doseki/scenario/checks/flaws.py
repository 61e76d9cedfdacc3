"""Flaws of which one number is given and the other that of a preset or of another material."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...util.finding import Finding
from ..materials import Material
from ..tables.root import ScenarioTable

PAIR = ("weibull_k", "weibull_m")  # fitted together


@dataclass(frozen=True)
class HalfOfFlaws(Finding):
    """A material with one of the two numbers of Weibull's distribution replaced."""

    given: str
    kept: str
    source: str
    values: tuple[float, float]

    def __str__(self) -> str:
        used = " and ".join(f"{key} = {x:.3g}" for key, x in zip(PAIR, self.values, strict=True))
        return (
            f"{self.place}: {self.given} is given without {self.kept}, which is that of "
            f"{self.source}, but the two are fitted together; used are {used}: give both"
        )


def halves_of_flaws(
    tables: ScenarioTable, materials: Mapping[str, Material]
) -> Iterator[HalfOfFlaws]:
    """The materials with flaws that are half their own."""
    for name, table in tables.material.items():
        own = table.model_dump(exclude_none=True)
        given = [key for key in PAIR if key in own]
        source = next((key for key in ("preset", "based_on") if key in own), None)
        material = materials[name]
        if material.fracture == "grady_kipp" and len(given) == 1 and source is not None:
            kept = PAIR[1 - PAIR.index(given[0])]
            said = f'{source} = "{own[source]}"'
            k, m = (float(material.of_laws[key]) for key in PAIR)
            yield HalfOfFlaws(f"material.{name}", given[0], kept, said, (k, m))
