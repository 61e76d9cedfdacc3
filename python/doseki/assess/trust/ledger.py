"""The account that a run of the resolved scheme keeps of energy and momentum."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...record.reader import Run
from ...scenario.kinematics import DEFORM
from .snapshots import gravity_of, is_resolved
from .verdicts import Check, judged, unknown

HELD = ("kinetic_energy", "bulk_energy", "shear_energy", "elastic_energy")
GIVEN = ("gravity_work", "wall_work", "contact_work", "scheme_work", "energy_entered")
TAKEN = ("av_dissipation", "energy_left", "fracture_work", "parting_work", "damping_work")
OF_BODIES = "elastic_energy"  # without it in the history, nothing of deformable bodies is
# Of the energy at a fifteenth of the speed of sound in water, reduced as in the run: where nothing
# moves there is no more than rounding.
ROUNDING, FAST = 1e-12, 100.0  # share, m/s
RELAXATION = "relaxation_work"  # a part of scheme_work
NUMERICAL = (0.01, 0.05)  # work of corrections over the largest energy that took part
CONTACTS = (0.01, 0.05)  # what contacts gave, over the same


@dataclass(frozen=True)
class Ledger:
    """Energies and momenta of the history, row by row; energies in J, 2-D: J/m."""

    run: Run
    unknown: str  # what is not recorded of this run; empty where all is

    def _values(self, name: str) -> np.ndarray:
        history = self.run.history
        return history[name] if name in history else np.zeros(len(history["time"]))

    def _column(self, name: str) -> np.ndarray:
        values = self._values(name)
        return values - values[0]

    def _vector(self, name: str) -> np.ndarray:
        values = self._vector_values(name)
        return np.asarray(values - values[0])

    def _vector_values(self, name: str) -> np.ndarray:
        axes = "xyz"[: self.run.scenario["dim"]]
        return np.array([self._values(f"{name}_{axis}") for axis in axes]).T

    @property
    def deforms(self) -> bool:
        """Whether there are deformable bodies."""
        bodies = self.run.scenario.get("body", {}).values()
        return any(b.get("enabled", True) and b.get("kinematics") in DEFORM for b in bodies)

    @property
    def _weight(self) -> np.ndarray:
        return np.asarray(np.linalg.norm(gravity_of(self.run.scenario)) * self._values("mass"))

    @property
    def _is_alone(self) -> bool:
        """Whether nothing from outside acts on what moves, and nothing enters or leaves."""
        outside = ("impulse", "momentum_entered", "momentum_left")
        pushed = max(float(np.max(np.abs(self._vector(name)))) for name in outside)
        changes = float(np.ptp(self._values("mass")))
        rounding = ROUNDING * float(np.max(np.linalg.norm(self._vector_values("momentum"), axis=1)))
        return pushed <= rounding and changes <= ROUNDING * float(np.max(self._values("mass")))

    @property
    def _kinetic(self) -> np.ndarray:
        """Kinetic energy that can take part: what is alone keeps that of its mass centre."""
        kinetic, mass = self._values("kinetic_energy"), self._values("mass")
        if not self._is_alone:
            return kinetic
        of_centre = np.sum(self._vector_values("momentum") ** 2, axis=1)
        of_centre = of_centre / (2 * np.where(mass > 0, mass, np.inf))
        return np.asarray(np.maximum(0.0, kinetic - of_centre))

    @property
    def largest(self) -> float:
        """The largest of the energies that took part, and no less than their rounding."""
        moved = [self._column(name) for name in (*GIVEN, *TAKEN)]
        held = [self._kinetic, *(self._values(name) for name in HELD[1:])]
        return max(self._rounding, *(float(np.max(np.abs(values))) for values in (*held, *moved)))

    @property
    def _largest_at_rest(self) -> float:
        """The same, or weight times spacing: what hardly moves has next to no other."""
        return max(self.largest, float(self._weight.max()) * self.run.scenario["dp"])

    @property
    def _rounding(self) -> float:
        speed = FAST * float(self.run.scenario.get("xi", 1.0))
        return ROUNDING * speed**2 * float(np.max(self._values("mass")))

    def energy_residual(self) -> np.ndarray:
        """Energy that is there, less that of the start and what came and went: (rows,)."""
        kept = np.sum([self._column(name) for name in (*HELD, *TAKEN)], axis=0)
        return np.asarray(kept - np.sum([self._column(name) for name in GIVEN], axis=0))

    def energy_check(self, name: str, limits: tuple[float, float]) -> Check:
        """Held + dissipated + left against start + works + entered."""
        if self.unknown:
            return unknown(name, limits, self.unknown)
        residual, largest = float(np.max(np.abs(self.energy_residual()))), self.largest
        details = {what: float(self._column(what)[-1]) for what in (*GIVEN, *TAKEN)}
        counted = "all rows of the history, with what gravity, walls, inflows, contacts of bodies"
        counted += " and corrections of the scheme gave, and viscosity, friction, outflows, cracks"
        counted += " and dampers of deformable bodies took"
        remedy = "lower dp: walls, bodies of few particles and bodies that shatter at once make or"
        remedy += " take energy; raise speed_max; lower cflnumber (now "
        remedy += f"{self.run.scenario.get('cflnumber', 0.1):g}) by half"
        if self.deforms:
            remedy += ", and again: what water strikes rings with too much stress until the gap is"
            remedy += " closed"
        value = residual / largest if largest else residual
        return judged(name, value, limits, counted, remedy, residual=residual, **details)

    def numerical_checks(self) -> list[Check]:
        """Work of walls, films and shifting, and of the relaxation of density.

        That water rises or sinks by a hundredth of a spacing is good.
        """
        relaxed = self._column(RELAXATION)
        others = self._column("scheme_work") - relaxed
        counted = "largest work of walls beyond what they do to the density, films and shifting"
        remedy = "lower dp; shifting = false tells what shifting takes"
        checks = [self._work_check("energy of corrections", others, NUMERICAL, counted, remedy)]
        if RELAXATION in self.run.history:
            checks.append(self._relaxation_check(relaxed))
        return checks

    def _relaxation_check(self, relaxed: np.ndarray) -> Check:
        """Bad where it makes energy, or takes more than all else that dissipates."""
        doubtful = NUMERICAL[1]
        if -relaxed.min() >= relaxed.max() and self._largest_at_rest:
            taken = float(self._column("av_dissipation").max()) / self._largest_at_rest
            doubtful = max(doubtful, taken)
        counted = "largest work of the relaxation of density, which takes the densities that "
        counted += "continuity adds up to those of the arrangement; doubtful is what viscosity took"
        remedy = "what splashes and meets again loses it at any dp, as eddies would take it; lower "
        remedy += "dp where water stays together"
        limits = (NUMERICAL[0], doubtful)
        return self._work_check("energy of relaxation", relaxed, limits, counted, remedy)

    def _work_check(
        self,
        name: str,
        column: np.ndarray,
        limits: tuple[float, float],
        counted: str,
        remedy: str,
    ) -> Check:
        work, largest = float(np.max(np.abs(column))), self._largest_at_rest
        value = work / largest if largest else work
        return judged(name, value, limits, counted, remedy, work=work, largest=largest)

    def contact_check(self, name: str, unseen: str) -> Check:
        """What contacts gave: without energy at the start, they only take and give back.

        `unseen`: why it is not known, if so.
        """
        if self.unknown or unseen:
            return unknown(name, CONTACTS, self.unknown or unseen)
        gained = float(np.max(self._column("contact_work")))
        largest = self._largest_at_rest
        counted = "all rows of the history: the most that contacts of bodies had given"
        remedy = "this is a mistake in doseki: report it; a smaller time_out may help"
        value = gained / largest if largest else gained
        return judged(name, value, CONTACTS, counted, remedy, gained=gained, largest=largest)

    def momentum_check(self, name: str, limits: tuple[float, float]) -> Check:
        """Momentum against start + impulses of outer forces + entered - left."""
        if self.unknown:
            return unknown(name, limits, self.unknown)
        history = self.run.history
        carried = self._vector("momentum_entered") - self._vector("momentum_left")
        given = self._vector("impulse") + carried
        residual = np.linalg.norm(self._vector("momentum") - given, axis=1)
        drift = float(residual.max())
        energy = max(self._rounding, float(np.max(self._kinetic)))
        moving = math.sqrt(2 * float(np.max(history["mass"])) * energy)
        scale = max(moving, float(np.sum(self._weight[1:] * np.diff(history["time"]))))
        counted = "all rows of the history, less the impulses of gravity, walls, inflows and fixed"
        counted += " bodies, and what entered and left carried; over the impulse of the weight"
        value = drift / scale if scale else drift
        return judged(name, value, limits, counted, "lower dp", drift=drift, scale=scale)


def ledger_of(run: Run) -> Ledger | None:
    """The account of a run; None where its scheme or its record has none, or too few rows."""
    history, scenario = run.history, run.scenario
    if not is_resolved(scenario) or "gravity_work" not in history or len(history["time"]) < 2:
        return None
    why = "the work of the attraction is not recorded" if scenario.get("attraction", 0.0) else ""
    ledger = Ledger(run, why)
    return None if ledger.deforms and OF_BODIES not in history else ledger
