"""The time step that light bodies in a liquid allow (Eq. 178)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ...util.finding import Finding
from ..kinematics import ELASTIC
from ..materials.material import Material
from ..schemes import RESOLVED
from ..tables.body import BodyTable
from ..tables.root import ScenarioTable


@dataclass(frozen=True)
class LightBody(Finding):
    """Bodies so light and small that the run takes shorter steps."""

    density: float  # kg/m3
    across: float  # particles
    asked: float
    taken: float

    def __str__(self) -> str:
        return (
            f"{self.place}: bodies of {self.density:g} kg/m3, {self.across:.2g} particles across, "
            f"swing on stiff water with cflnumber = {self.asked:g}; {self.taken:.2g} is taken"
        )


def stable_cflnumber(
    tables: ScenarioTable, materials: Mapping[str, Material]
) -> tuple[float, list[Finding]]:
    """The cflnumber that is asked for, or the greatest that is stable; and what is to be said."""
    asked = tables.cflnumber
    limits = {} if tables.scheme != RESOLVED else dict(_limits(tables, materials))
    name = min(limits, key=limits.__getitem__, default=None)
    if name is None or limits[name] >= asked:
        return asked, []
    body = tables.body[name]
    assert body.material is not None
    density, across = materials[body.material].rho0, _across(body, tables.dp)
    return limits[name], [LightBody(f"body.{name}", density, across, asked, limits[name])]


def _limits(
    tables: ScenarioTable, materials: Mapping[str, Material]
) -> Iterator[tuple[str, float]]:
    """Of each table of rigid bodies, in the densest liquid there is: 0.8 s R/dp, Eq. (178)."""
    used = [body.material for body in tables.body.values()]
    used += [inflow.material for inflow in tables.inflow.values()]
    known = [materials[name] for name in used if name is not None]
    liquids = [material.rho0 for material in known if material.law == "fluid"]
    for name, body in tables.body.items():
        if not liquids or body.material is None:
            continue
        material, across = materials[body.material], _across(body, tables.dp)
        kinematics = body.kinematics_in(tables.scheme, material.law)
        if kinematics.is_whole and kinematics != ELASTIC and across > 0:
            yield name, 0.4 * across * material.rho0 / max(liquids)


def _across(body: BodyTable, dp: float) -> float:
    """Particles across the smallest ball or thinnest side; 0 where the shape does not tell."""
    return body.layers(dp) or 0.0 if body.smallest is None else body.smallest / dp
