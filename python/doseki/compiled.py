"""The compiled core: which instruction set runs here."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

if TYPE_CHECKING:  # the build runs this file without numpy
    import numpy as np

# What a module was compiled for, and the processor flags that must be there for it.
INSTRUCTION_SETS: dict[str, dict[str, set[str]]] = {
    "x86": {
        "v4": {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
        "v3": {"avx2", "fma", "bmi1", "bmi2", "f16c"},
        "scalar": set(),
        "device": set(),
    },
    "other": {"native": set(), "scalar": set(), "device": set()},
}

# The module of each device: that of a graphics card, and the same code on the processor.
DEVICES = {"host": "device", "cuda": "cuda"}

# How long a thread that waits for the others spins before it sleeps (decision 0024).  OpenMP's own
# choice, some milliseconds, makes a run many times slower as soon as another program wants one of
# its cores.  A user who says how threads wait is obeyed.
SPIN_COUNT = "2000"

Table = list[list[float]]  # columns of numbers


class PointFunction(Protocol):
    """A function of core/physics on columns of numbers, one column per argument and result."""

    def __call__(self, columns: Table, pack: bool = False) -> Table:
        """The results; `pack` works on several rows at once."""
        ...


class PointFunctions(Protocol):
    """The functions of core/physics in one number of dimensions."""

    def __getattr__(self, name: str) -> PointFunction: ...


class Physics(PointFunctions, Protocol):
    """Point functions: those in two or three dimensions, and those that know no dimension."""

    two: PointFunctions
    three: PointFunctions
    equations_of_state: Mapping[str, list[str]]  # parameters of each, in the order of its columns
    least_relative_density: float  # of a liquid in the resolved scheme, over rho0


class HeightField(Protocol):
    """The surface of a bed; columns of numbers by name, one row for each place."""

    def at(self, places: np.ndarray) -> dict[str, np.ndarray]:
        """At places (N, dim - 1), m: `height`, m, `area` over that of the plan, `normal`, and
        whether the height is `unknown`.
        """
        ...

    def nearest(self, points: np.ndarray) -> dict[str, np.ndarray]:
        """Signed `distance`, m, of points (N, dim) above the surface, and the `normal` there."""
        ...

    def layer(
        self, low: Sequence[float], side: float, dp: float, depth: float
    ) -> dict[str, np.ndarray]:
        """Of a layer so deep below a square of the surface (above it: below 0), in parts of equal
        `area` (N,), near dp^2, m2 (2-D: near dp, m): the `place` (N, dim - 1), m, above each.
        """
        ...


class SurfaceMesh(Protocol):
    """A mesh of triangles as the core searches it."""

    def from_wall(self, position: np.ndarray, width: float) -> np.ndarray:
        """Signed distance, negative inside, and outward normal (n, 4) of points (n, 3), m."""
        ...

    def winding(self, position: np.ndarray) -> np.ndarray:
        """How often the mesh, which is closed, goes around each of the points (n, 3)."""
        ...

    def cuts(self) -> tuple[int, float, float, float]:
        """How often an edge goes through another triangle, and where it does so first, m."""
        ...


class Core(Protocol):
    """A compiled module."""

    __name__: str
    lanes: int  # numbers of double precision that it works on at once
    physics: Physics
    PhysicsFailure: type[Exception]
    ResourceFailure: type[Exception]

    def Simulation(  # noqa: N802 (a class)
        self,
        scheme: str,
        dim: int,
        precision: str,
        materials: Sequence[Mapping[str, object]],
        options: Mapping[str, object],
    ) -> object:
        """A solver.protocol.CoreSimulation.

        Raises ValueError for a key or word that is unknown, or a key that is missing.
        """
        ...

    def HeightField2(self, table: Mapping[str, object]) -> HeightField:  # noqa: N802 (a class)
        """The bed of a 2-D run: origin, cell, heights, unknown."""
        ...

    def HeightField3(self, table: Mapping[str, object]) -> HeightField:  # noqa: N802 (a class)
        """The same of a 3-D run."""
        ...

    def SurfaceMesh(  # noqa: N802 (a class)
        self, corners: np.ndarray, thickness: float
    ) -> SurfaceMesh:
        """Triangles by their corners (3 m, 3), m; a thickness above 0 is that of a sheet."""
        ...

    def pair_work(
        self, scheme: str, dim: int, precision: str, wide_kernel: bool
    ) -> list[dict[str, Any]]:
        """Of each sum over moving neighbours, `sum` being its phase: the sums, products, quotients,
        roots and comparisons of a pair, and the bytes that are read of a neighbour.
        """
        ...

    def set_threads(self, n: int) -> None:
        """Threads of the calls that follow."""
        ...

    def threads(self) -> int:
        """How many threads calls take."""
        ...

    def use_card(self, k: int) -> None:
        """Let this process work on card k of the machine, counted round; of "cuda" alone."""
        ...


def _processor_flags() -> set[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return next((set(line.split()) for line in lines if line.startswith("flags")), set())


def usable_instruction_sets() -> list[str]:
    """Instruction sets that this processor has, fastest first, whether built or not."""
    machine = "x86" if platform.machine() in {"x86_64", "AMD64"} else "other"
    flags = _processor_flags()
    return [isa for isa, needed in INSTRUCTION_SETS[machine].items() if needed <= flags]


def available_instruction_sets() -> list[str]:
    """Instruction sets that were built and that this processor has, fastest first."""
    return [
        isa for isa in usable_instruction_sets() if find_spec(f"doseki._core_{isa}") is not None
    ]


@cache
def load_core(isa: str | None = None) -> Core:
    """The extension module for an instruction set.

    `isa` is "v4" (AVX-512), "v3" (AVX2), "native" (other processors) or "scalar" (one lane, the
    reference); by default the environment variable DOSEKI_ISA, else the fastest one available.
    "device" and "cuda" are those of DEVICES.  Raises UserError when it is not available here, and
    ResourceError when there is no graphics card for it.
    """
    from .errors import ResourceError, UserError  # the build runs this file by itself

    available = available_instruction_sets()
    chosen = isa or os.environ.get("DOSEKI_ISA") or (available[0] if available else None)
    if not os.environ.get("OMP_WAIT_POLICY"):
        os.environ.setdefault("GOMP_SPINCOUNT", SPIN_COUNT)
    if chosen == "cuda":
        core = import_module("doseki._core_cuda")
        if problem := core.card_problem():
            raise ResourceError(f"no graphics card can be used: {problem}")
        return cast(Core, core)
    if chosen not in available:
        raise UserError(
            f"instruction set {chosen!r} is not available on this {platform.machine()} processor;"
            f" built and usable here: {', '.join(available) or 'none (is the core built?)'}"
        )
    return cast(Core, import_module(f"doseki._core_{chosen}"))


class Card(NamedTuple):
    """The graphics card of this process, and its memory in bytes."""

    name: str
    memory: float


def card_here() -> Card | None:
    """The card that a run would take; none where the core was not built for one."""
    if find_spec("doseki._core_cuda") is None:
        return None
    core = import_module("doseki._core_cuda")
    return None if core.card_problem() else Card(core.card_name(), core.card_memory())


class Peaks(NamedTuple):
    """What a card can do at best: operations per second, and bytes per second."""

    in_double: float
    in_float: float
    bandwidth: float


def card_peaks() -> Peaks | None:
    """Of the card that a run would take; none where there is none."""
    if card_here() is None:
        return None
    core = import_module("doseki._core_cuda")
    return Peaks(core.card_arithmetic(True), core.card_arithmetic(False), core.card_bandwidth())


def module_is_chosen() -> bool:
    """Whether the environment says which module of the core is to be taken."""
    return bool(os.environ.get("DOSEKI_ISA"))


def use_device(name: str) -> None:
    """Let load_core() take the module of a device from now on; "cpu" leaves the choice as it is.

    Raises UserError where the core was not built for it, and ResourceError without a card.
    """
    from .errors import UserError

    if name == "cpu":
        return
    module = DEVICES[name]
    if find_spec(f"doseki._core_{module}") is None:
        with_nvcc = " with nvcc, which pip install 'doseki[cuda]' brings" if name == "cuda" else ""
        raise UserError(
            f"--device {name}: the core is not built for it; in a clone,"
            f" DOSEKI_INSTRUCTION_SETS='host;{module}' ./doseki list builds it{with_nvcc}"
        )
    load_core(module)
    os.environ["DOSEKI_ISA"] = module
    load_core.cache_clear()


if __name__ == "__main__":  # what CMakeLists.txt asks: the one instruction set to build here
    print(usable_instruction_sets()[0])
