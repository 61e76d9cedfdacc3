"""What is made of each kind of table [body.NAME]: one line each."""

from __future__ import annotations

from typing import Any

from ...scenario.model import Scenario
from ...scenario.tables.bodies import (
    Box,
    Disc,
    Grains,
    ParticleFile,
    Points,
    Polygon,
    Polyhedron,
)
from ...scenario.tables.body import BodyTable
from ...scenario.tables.mesh import Mesh
from ...scenario.tables.terrain.release import Release
from .body import Body
from .box import BoxBody
from .disc import DiscBody
from .file import FileBody
from .grains import GrainsBody
from .mesh import MeshBody
from .points import PointsBody
from .polygon import PolygonBody
from .polyhedron import PolyhedronBody
from .release import ReleaseBody

MADE_OF: dict[type[BodyTable], type[Body[Any]]] = {
    Box: BoxBody,
    Disc: DiscBody,
    Grains: GrainsBody,
    Mesh: MeshBody,
    Release: ReleaseBody,
    ParticleFile: FileBody,
    Points: PointsBody,
    Polygon: PolygonBody,
    Polyhedron: PolyhedronBody,
}


def body_of(scenario: Scenario, name: str) -> Body[Any]:
    """The body [body.NAME]."""
    table = scenario.body[name]
    return MADE_OF[type(table)](scenario, name, table)


def bodies_of(scenario: Scenario) -> dict[str, Body[Any]]:
    """All bodies of a scenario, in its order."""
    return {name: body_of(scenario, name) for name in scenario.body}
