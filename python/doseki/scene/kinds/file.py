"""Particles from a file."""

from __future__ import annotations

import numpy as np

from ...record.particles import FIXED, FREE, ParticleSet
from ...scenario.tables.bodies import ParticleFile
from .body import Body


class FileBody(Body[ParticleFile]):
    """Particles as a file gives them; smoothing lengths by eq. 10 where it gives none."""

    def count(self) -> float:
        """See Body."""
        return len(self.scenario.particle_tables[self.name])

    def particles(self, names: list[str]) -> ParticleSet:
        """See Body."""
        scenario, table = self.scenario, self.scenario.particle_tables[self.name]
        n = len(table)
        materials = np.array([scenario.material_names.index(m) for m in table.material_names])
        own = [names.index(name) for name in scenario.names_of_bodies(self.name)]
        body = np.zeros(n, np.int32) if table.body is None else table.body
        fixed = np.full(n, self.table.fixed) if table.fixed is None else table.fixed
        h = table.smoothing_length
        return ParticleSet(
            position=table.position,
            velocity=table.velocity,
            mass=table.mass,
            density=table.density,
            smoothing_length=scenario.smoothing_length(table.mass, table.density)
            if h is None
            else h,
            material=materials[table.material].astype(np.int32),
            body=np.array(own, np.int32)[body],
            motion=np.where(fixed, FIXED, FREE).astype(np.int32),
            id=np.arange(n, dtype=np.int64),
        )
