"""Times PySPH on given particles. Run by peers.py with the Python of PySPH's own environment.

Two schemes of its own equations, with the Wendland C6 kernel and the support, timestep and
neighbours of ours, one evaluation of the forces a step (its PEC integrator) and neighbours sought
anew each step, as it always does:

- wcsph: continuity, pressure and artificial viscosity of a weakly compressible fluid (its
  WCSPHScheme); about half of the work that ueta2022 does for a pair;
- stress: velocity gradient, elastic stress, and momentum with the stress tensor, in two passes as
  ueta2022 has them.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
from cyarray.api import UIntArray
from pysph.base.kernels import WendlandQuinticC6
from pysph.base.nnps import LinkedListNNPS
from pysph.base.utils import get_particle_array_wcsph
from pysph.solver.application import Application
from pysph.solver.solver import Solver
from pysph.sph.basic_equations import (
    ContinuityEquation,
    MonaghanArtificialViscosity,
    VelocityGradient2D,
    VelocityGradient3D,
)
from pysph.sph.equation import Group
from pysph.sph.integrator import PECIntegrator
from pysph.sph.integrator_step import SolidMechStep
from pysph.sph.scheme import WCSPHScheme
from pysph.sph.solid_mech.basic import (
    HookesDeviatoricStressRate,
    IsothermalEOS,
    MomentumEquationWithStress,
    get_particle_array_elastic_dynamics,
)

WARM_UP = 5  # steps, not timed
KERNEL_SUPPORT = 2.0  # of WendlandQuinticC6, in smoothing lengths
NAMES = ["fluid", "tank"]
SAMPLE = 17  # neighbours are counted for every so many particles


class DamBreak(Application):
    """A column falling in a tank, of particles read from a file."""

    def __init__(self, case):
        self.case = case
        self.dim = int(case["dim"])
        self.clock = {}
        super().__init__()

    def create_particles(self):
        """Fluid and tank."""
        case = self.case
        arrays = []
        for name, mask in zip(NAMES, (case["fixed"] == 0, case["fixed"] == 1), strict=True):
            columns = dict(zip("xyz", case["position"][mask].T, strict=False))
            columns |= dict(zip("uvw", case["velocity"][mask].T, strict=False))
            array = self.new_array(name, columns)
            array.rho[:] = case["rho0"]
            array.m[:] = case["rho0"] * case["dp"] ** self.dim
            array.h[:] = case["support"] / KERNEL_SUPPORT
            arrays.append(array)
        return arrays

    def kernel(self):
        """The kernel of the ueta2022 scheme."""
        return WendlandQuinticC6(dim=self.dim)

    def post_step(self, solver):
        """Keeps the time."""
        self.clock[solver.count] = time.perf_counter(), time.process_time()

    def seconds_per_step(self, threads):
        """Mean after the warm-up; one thread by its processor time, several by the wall clock."""
        first, last = min(k for k in self.clock if k >= WARM_UP), max(self.clock)
        which = 1 if threads == 1 else 0
        return (self.clock[last][which] - self.clock[first][which]) / (last - first)

    def neighbours(self):
        """Mean number within support, not counting pairs of the tank with itself."""
        nnps = LinkedListNNPS(self.dim, self.particles, radius_scale=KERNEL_SUPPORT)
        found, total, sizes = UIntArray(), 0.0, [len(array.x) for array in self.particles]
        for source, destination in ((0, 0), (1, 0), (0, 1)):
            chosen = range(0, sizes[destination], SAMPLE)
            nnps.set_context(source, destination)
            count = 0
            for i in chosen:
                nnps.get_nearest_particles(source, destination, i, found)
                count += found.length - (source == destination)
            total += count / len(chosen) * sizes[destination]
        return total / sum(sizes)


class Wcsph(DamBreak):
    """PySPH's standard scheme."""

    def new_array(self, name, columns):
        """An empty array of the scheme."""
        return get_particle_array_wcsph(name=name, **columns)

    def create_scheme(self):
        """As PySPH's own dam breaks have it."""
        case, h = self.case, float(self.case["support"]) / KERNEL_SUPPORT
        gravity = {"gy" if self.dim == 2 else "gz": -9.8}
        return WCSPHScheme(
            NAMES[:1], NAMES[1:], dim=self.dim, rho0=float(case["rho0"]), c0=float(case["c0"]),
            h0=h, hdx=h / float(case["dp"]), alpha=0.1, **gravity,
        )  # fmt: skip

    def configure_scheme(self):
        """Kernel and timestep of ours."""
        dt = float(self.case["timestep"])
        self.scheme.configure_solver(kernel=self.kernel(), dt=dt, tf=1e9, adaptive_timestep=False)


class Stress(DamBreak):
    """The equations of an elastic solid, which are those that ueta2022 has."""

    def new_array(self, name, columns):
        """A soft rock with the sound speed of the fluid."""
        modulus = 1.2 * float(self.case["rho0"] * self.case["c0"] ** 2)
        constants = {"E": modulus, "nu": 0.3, "rho_ref": float(self.case["rho0"])}
        return get_particle_array_elastic_dynamics(name=name, constants=constants, **columns)

    def create_equations(self):
        """Two passes."""
        fluid = {"dest": "fluid", "sources": NAMES}
        gradient = VelocityGradient2D if self.dim == 2 else VelocityGradient3D
        return [
            Group([IsothermalEOS("fluid", None), IsothermalEOS("tank", None), gradient(**fluid)]),
            Group([
                ContinuityEquation(**fluid),
                ContinuityEquation(dest="tank", sources=["fluid"]),
                MomentumEquationWithStress(**fluid),
                MonaghanArtificialViscosity(**fluid, alpha=1.0, beta=0.0),
                HookesDeviatoricStressRate("fluid", None),
            ]),
        ]  # fmt: skip

    def create_solver(self):
        """One evaluation a step, as in the other scheme."""
        integrator = PECIntegrator(fluid=SolidMechStep())
        dt = float(self.case["timestep"])
        return Solver(
            kernel=self.kernel(),
            dim=self.dim,
            integrator=integrator,
            dt=dt,
            tf=1e9,
            adaptive_timestep=False,
        )


SCHEMES = {"wcsph": Wcsph, "stress": Stress}


def main(scheme, particle_file, result_file, steps, threads):
    """Runs `steps` timed steps; writes seconds per step and neighbours as JSON."""
    with np.load(particle_file) as file:
        app = SCHEMES[scheme](dict(file))
    parallel = "--openmp" if int(threads) > 1 else "--no-openmp"
    app.run(argv=["--disable-output", "--max-steps", str(int(steps) + WARM_UP), parallel])
    result = {
        "seconds_per_step": app.seconds_per_step(int(threads)),
        "neighbours": app.neighbours(),
    }
    Path(result_file).write_text(json.dumps(result))


if __name__ == "__main__":
    main(*sys.argv[1:])
