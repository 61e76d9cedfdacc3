"""What a scene takes from the snapshot of an earlier run: particles and bodies as they were."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import UserError
from ..record.particles import FIXED, FREE, ParticleSet
from ..scenario.earlier import Earlier
from ..scenario.model import Scenario
from ..util.finding import Finding
from .bodies import ElasticBody
from .groups import Group
from .kinds.body import Body
from .moved import Displacement, is_gone
from .periodic import nearest_image, periods, wrapped

AT_PLACE = 1e-6  # dp within which a fixed particle is where it should be
SAME_SIZE = 1e-6  # relative difference of diameters
FIELDS = ("position", "velocity", "mass", "density", "smoothing_length", "deviatoric_stress")
POSITIVE = ("mass", "density", "smoothing_length")


@dataclass(frozen=True)
class WithoutSprings(Finding):
    """Bodies whose contacts had springs that no snapshot holds."""

    def __str__(self) -> str:
        return (
            f"{self.place}: taken from a snapshot, which holds no springs of contacts: friction "
            "of bodies that rest on one another builds up anew"
        )


class CarriedOver:
    """The state in a snapshot, by the bodies of the scenario that starts from it.

    Every method raises UserError where the snapshot is not that of such bodies.
    """

    def __init__(self, scenario: Scenario, earlier: Earlier, names: list[str]) -> None:
        """`names` are those that the field `body` of the new particles is to index."""
        self._scenario, self._earlier, self._names = scenario, earlier, names
        self._snapshot = snapshot = earlier.snapshot
        self.fields = {key: np.asarray(snapshot[key], float) for key in FIELDS}
        self._motion = snapshot.stored("motion")
        self._check()
        self._body_name, self._material_name = snapshot["body"], snapshot["material"]

    def _check(self) -> None:
        for key, values in self.fields.items():
            finite = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
            above = values > 0 if key in POSITIVE else finite
            for good, wrong in ((finite, "is not finite"), (above, "is not above 0")):
                if not good.all():
                    raise self._scenario.where.error(
                        ("start", "from"),
                        f"start.from: {self._snapshot.path}: the {key.replace('_', ' ')} of "
                        f"particle {int(np.argmin(good))} {wrong}: the snapshot is damaged; take "
                        "another one",
                    )

    def findings(self, moves: bool) -> list[Finding]:
        """What is to be said of the start; `moves`: bodies do."""
        lost: list[Finding] = [WithoutSprings("start")] if moves and self._snapshot.grains else []
        return [*self._earlier.findings, *lost]

    def particles(self, name: str, motions: tuple[int, ...] = (FREE, FIXED)) -> ParticleSet:
        """The particles of [body.NAME] or an inflow that are no parts of bodies; `id` is the row.

        Those behind the section of an inflow are not among them.
        """
        mine = np.isin(self._body_name, self._names_of(name)) & np.isin(self._motion, motions)
        rows = np.flatnonzero(mine)
        own = {key: values[rows] for key, values in self.fields.items()}
        del own["deviatoric_stress"]
        own["position"] = wrapped(self._scenario, own["position"])
        return ParticleSet(
            **own,
            material=self._indices(self._material_name[rows], self._scenario.material_names),
            body=self._indices(self._body_name[rows], self._names),
            motion=self._motion[rows].astype(np.int32),
            id=rows.astype(np.int64),
        )

    def _indices(self, words: np.ndarray, names: list[str]) -> np.ndarray:
        """Of each word in a list of names."""
        found, which = np.unique(words, return_inverse=True)
        if unknown := sorted(set(found) - set(names)):
            raise UserError(f'{self._snapshot.path}: "{unknown[0]}" is not part of the scenario')
        return np.array([names.index(word) for word in found], np.int32)[which]

    def _names_of(self, name: str) -> list[str]:
        return self._scenario.names_of_bodies(name) if name in self._scenario.body else [name]

    def loose(self, name: str, built: ParticleSet, way: np.ndarray | None) -> ParticleSet:
        """Those of [body.NAME], of which `built` are those that it has at time zero.

        The fixed ones have come by a `way` (n, dim) below slants of other bodies, which the earlier
        run may not have had.
        """
        found = self.particles(name)
        fixed, place = found.motion == FIXED, built.position[built.motion == FIXED]
        for before in (place,) if way is None else (place, place - way):
            if len(before) == int(fixed.sum()) and self._are_at(
                found.position[fixed], name, before
            ):
                return found
        raise self._error(
            name,
            "its fixed particles are not where the earlier run has them; a motion may change only "
            "from the start of this run on, and what thins to nothing on it cannot be left out",
        )

    def _are_at(self, position: np.ndarray, name: str, before: np.ndarray) -> bool:
        """Whether particles of a body that were somewhere at time zero have moved as it has."""
        place = Displacement(self._scenario, name).points(before)
        off = nearest_image(position - place, periods(self._scenario))
        return bool((np.abs(off) <= AT_PLACE * self._scenario.dp).all())

    def group(self, group: Group) -> Group:
        """The rigid bodies of a table that have not left, where they are."""
        if group.breakable:
            raise self._error(
                group.name,
                'a snapshot does not hold the cracks of bodies with kinematics = "breakable"; '
                "resume the earlier run, or name it in start.without",
            )
        grains = self._grains_of(group.name)
        reach = 2 * np.array([shape.reach for shape in group.shapes])
        diameter = grains["diameter"]
        which = np.argmin(np.abs(reach[None] - diameter[:, None]), axis=1)
        if not (np.abs(reach[which] - diameter) <= SAME_SIZE * reach[which]).all():
            raise self._error(group.name, "the earlier run has bodies of another size")
        centre = wrapped(self._scenario, grains["position"])
        orientation = np.ascontiguousarray(grains["orientation"])
        return replace(group, shape=which.astype(np.int32), centre=centre, orientation=orientation)

    def velocities(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Velocities (n, dim) and spins (n, 3) of the bodies of `group`."""
        grains = self._grains_of(name)
        return grains["velocity"], grains["spin"]

    def _grains_of(self, name: str) -> dict[str, np.ndarray]:
        table = self._snapshot.grains
        if not table:
            raise self._error(name, "the snapshot holds no bodies that move")
        mine = (table["body"] == name) & (table["removed"] == 0)
        found = {key: values[mine] for key, values in table.items()}
        for key in ("position", "velocity", "spin", "orientation", "diameter"):
            if not np.isfinite(found[key]).all():
                raise self._error(name, f"the snapshot's {key} of bodies is not finite")
        length = np.linalg.norm(found["orientation"], axis=1)
        if not (np.abs(length - 1) < 1e-3).all():
            raise self._error(name, "the snapshot's orientation of bodies is no quaternion")
        return found

    def elastic(
        self, name: str, particles: ParticleSet, bodies: list[ElasticBody]
    ) -> tuple[ParticleSet, list[ElasticBody]]:
        """The points of deformable bodies where they are, from those that stand as they were made.

        `bodies` number their members from those of the first on.
        """
        rows = np.flatnonzero(np.isin(self._body_name, self._names_of(name)))
        if len(rows) != len(particles):
            raise self._error(
                name, f"the earlier run has {len(rows)} particles of it, expected {len(particles)}"
            )
        if (self._snapshot["damage"][rows] > 0).any():
            raise self._error(
                name,
                "it has cracks, which a snapshot does not hold; resume the earlier run, start "
                "before it cracks, or leave it out",
            )
        position, velocity = self.fields["position"][rows], self.fields["velocity"][rows]
        first, period, moved = min(b.members.min() for b in bodies), periods(self._scenario), []
        for body in bodies:
            own = body.members - first
            # As far as its first point has gone, give or take less than half a period.
            gone = position[own] - body.rest
            gone = gone[0] + nearest_image(gone - gone[0], period)
            moved.append(replace(body, position=body.rest + gone, velocity=velocity[own]))
        there = replace(particles, position=wrapped(self._scenario, position), velocity=velocity)
        return there, moved

    def stresses(self, origin: np.ndarray) -> np.ndarray:
        """Deviatoric stresses (N, 3, 3), Pa, of particles from these rows; zero where it is -1."""
        stress = np.zeros((len(origin), 3, 3))
        stress[origin >= 0] = self.fields["deviatoric_stress"][origin[origin >= 0]]
        return stress

    def _error(self, name: str, wrong: str) -> UserError:
        where = self._scenario.where
        return where.error(("body", name), f"body.{name} cannot carry over: {wrong}")


def carried_over(scenario: Scenario, names: list[str]) -> CarriedOver | None:
    """What the earlier run of a scenario gives, if it starts from one."""
    earlier = scenario.earlier
    return None if earlier is None else CarriedOver(scenario, earlier, names)


def present(scenario: Scenario, bodies: Mapping[str, Body[Any]]) -> dict[str, Body[Any]]:
    """The bodies that have not been removed before the run begins."""
    return {name: body for name, body in bodies.items() if not is_gone(scenario, name)}


def placed_parts(
    scenario: Scenario,
    carried: CarriedOver | None,
    built: Mapping[str, ParticleSet],
    ways: Mapping[str, np.ndarray],
) -> dict[str, ParticleSet]:
    """Particles that are no parts of bodies where they are when the run begins.

    They are by body, and by inflow where one has brought some; `built` are those of time zero, of
    which fixed ones have come by `ways` below slants of others.
    """
    if carried is None:
        return dict(built)
    parts = {
        name: carried.loose(name, particles, ways.get(name))
        if name in scenario.carried
        else Displacement(scenario, name).particles(particles)
        for name, particles in built.items()
    }
    entered = [name for name in scenario.inflow if name not in scenario.body]
    return parts | {name: carried.particles(name, (FREE,)) for name in entered}


def placed_groups(
    scenario: Scenario, carried: CarriedOver | None, made: list[Group]
) -> list[Group]:
    """Bodies where they are when the run begins, without those that have left."""
    if carried is None:
        return made
    groups = []
    for group in made:
        if group.fixed:
            groups.append(Displacement(scenario, group.name).group(group))
        elif group.elastic or group.name not in scenario.carried:
            groups.append(group)
        else:
            groups.append(carried.group(group))
    return [group for group in groups if len(group)]
