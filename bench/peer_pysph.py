"""Times PySPH on given particles. Run by peers.py with the Python of PySPH's own environment.

Weakly compressible SPH after its own scheme, with the Wendland C6 kernel and the support, timestep
and neighbours of ours; one evaluation of the forces a step (its PEC integrator).
"""

import json
import sys
import time

import numpy as np
from cyarray.api import UIntArray
from pysph.base.kernels import WendlandQuinticC6
from pysph.base.nnps import LinkedListNNPS
from pysph.base.utils import get_particle_array_wcsph
from pysph.solver.application import Application
from pysph.sph.scheme import WCSPHScheme

WARM_UP = 5  # steps, not timed
KERNEL_SUPPORT = 2.0  # of WendlandQuinticC6, in smoothing lengths


class DamBreak(Application):
    """A column of water falling in a tank, of particles read from a file."""

    def __init__(self, case, *arguments):
        self.case = case
        self.clock = {}
        super().__init__(*arguments)

    def create_particles(self):
        case = self.case
        arrays = []
        for name, mask in (("fluid", case["fixed"] == 0), ("tank", case["fixed"] == 1)):
            columns = dict(zip("xyz", case["position"][mask].T, strict=False))
            columns |= dict(zip("uvw", case["velocity"][mask].T, strict=False))
            array = get_particle_array_wcsph(name=name, rho=float(case["rho0"]), **columns)
            array.m[:] = case["rho0"] * case["dp"] ** case["dim"]
            array.h[:] = case["support"] / KERNEL_SUPPORT
            arrays.append(array)
        return arrays

    def create_scheme(self):
        case = self.case
        dim, h = int(case["dim"]), float(case["support"]) / KERNEL_SUPPORT
        gravity = {"gy" if dim == 2 else "gz": -9.8}
        return WCSPHScheme(
            ["fluid"], ["tank"], dim=dim, rho0=float(case["rho0"]), c0=float(case["c0"]), h0=h,
            hdx=h / float(case["dp"]), alpha=0.1, **gravity,
        )  # fmt: skip

    def configure_scheme(self):
        dt, dim = float(self.case["timestep"]), int(self.case["dim"])
        self.scheme.configure_solver(kernel=WendlandQuinticC6(dim=dim), dt=dt, tf=1e9, adaptive_timestep=False)

    def post_step(self, solver):
        self.clock[solver.count] = time.perf_counter()

    def seconds_per_step(self):
        """Mean over the steps after the warm-up."""
        first, last = min(k for k in self.clock if k >= WARM_UP), max(self.clock)
        return (self.clock[last] - self.clock[first]) / (last - first)

    def neighbours(self):
        """Mean number of neighbours of fluid particles within support."""
        nnps = LinkedListNNPS(int(self.case["dim"]), self.particles, radius_scale=KERNEL_SUPPORT)
        found, total = UIntArray(), 0
        chosen = np.arange(0, len(self.particles[0].x), 17)
        for source in range(len(self.particles)):
            nnps.set_context(source, 0)
            for i in chosen:
                nnps.get_nearest_particles(source, 0, int(i), found)
                total += found.length
        return total / len(chosen) - 1


def main(particle_file, result_file, steps, threads):
    """Runs `steps` timed steps; writes seconds per step and neighbours as JSON."""
    case = np.load(particle_file)
    case = {name: case[name] for name in case.files}
    options = ["--disable-output", "--max-steps", str(int(steps) + WARM_UP), "--fname", "peer"]
    app = DamBreak(case)
    app.run(argv=[*options, *(["--openmp"] if int(threads) > 1 else ["--no-openmp"])])
    result = {"seconds_per_step": app.seconds_per_step(), "neighbours": app.neighbours()}
    with open(result_file, "w") as file:
        json.dump(result, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
