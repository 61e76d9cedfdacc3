"""One dam break in 2-D by several codes to the same time, for peers.py.

All have the same spacing, sound speed, kernel radius and tank; each has its own scheme, walls and
rule for the time step.
"""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import numpy as np

from doseki.bench.report import markdown_table
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, load_core

HERE = Path(__file__).resolve().parent
BUILDS = HERE.parent / ".tools" / "peers"  # ignored by git
DENSITY, GAMMA = 1000.0, 7.0
KERNEL_SUPPORT = 2.0  # of the peers' Wendland kernel, in smoothing lengths
START = 0.02  # part of the time that is run once more and subtracted, for what a code does at first


@dataclass(frozen=True)
class DamBreak:
    """The shipped dam break with the resolved scheme, `rows` particles over the column."""

    rows: int
    end: float  # s

    def __post_init__(self) -> None:
        settings = ["scheme=resolved", f"dp== column_height/{self.rows}"]
        object.__setattr__(self, "scenario", load_scenario("dambreak", settings))

    @property
    def dp(self) -> float:
        """Spacing, m."""
        return self.scenario.dp

    @property
    def sound_speed(self) -> float:
        """Of water, m/s."""
        return self.scenario.materials["water"].scaled(self.scenario.xi).speedsound

    @property
    def radius(self) -> float:
        """Of the kernel, m."""
        return KERNEL_SUPPORT * self.scenario.eta * self.dp

    @property
    def gravity(self) -> float:
        """m/s2, downwards."""
        return float(np.linalg.norm(self.scenario.gravity))

    def box(self) -> tuple[float, float, float, float]:
        """Width and height of the column, length and height of the tank, m."""
        water, right = self.scenario.body["water"], self.scenario.body["right_wall"]
        return (*map(float, water.max), float(right.min[0]), float(right.max[1]))

    def particles(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions and whether each is fixed, as doseki has them at the start."""
        state = build_simulation(self.scenario)[0].state()
        return state["position"], state["motion"] == 1


@dataclass(frozen=True)
class Run:
    """What one run of a code took and gave."""

    seconds: float  # processor time of one thread, wall time of several
    steps: int
    front: float  # m: the 99th percentile of x of the water


def front_of(x: Sequence[float] | np.ndarray) -> float:
    """m; a few drops do not count."""
    return float(np.percentile(np.asarray(x, float), 99))


def timed_command(command: Sequence[object], threads: int, folder: Path) -> tuple[float, str]:
    """Seconds and what it printed; SystemExit with its last lines where it fails."""

    def clock() -> float:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime if threads == 1 else time.perf_counter()

    started = clock()
    done = subprocess.run(
        list(map(str, command)),
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": str(threads)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        last = "\n".join(done.stdout.splitlines()[-5:])
        raise SystemExit(f"{Path(str(command[0])).name} failed:\n{last}")
    return clock() - started, done.stdout


class Code(ABC):
    """A code that runs the dam break."""

    name: str

    @abstractmethod
    def run(self, case: DamBreak, end: float, threads: int) -> Run:
        """From the start to `end`, s."""


class Doseki(Code):
    """This one."""

    name = "doseki, resolved"

    def run(self, case: DamBreak, end: float, threads: int) -> Run:
        """See Code."""
        load_core().set_threads(threads)
        clock = time.process_time if threads == 1 else time.perf_counter
        started = clock()
        simulation, _names = build_simulation(case.scenario)
        simulation.advance(limit=end, pause=end, max_steps=10**12)
        seconds = clock() - started
        state = simulation.state()
        water = state["position"][state["motion"] == 0, 0]
        return Run(seconds, simulation.steps, front_of(water))


class Built(Code):
    """One that is compiled here from a source tree, in a build folder of its own."""

    folder: str  # of ours, with its CMakeLists.txt
    mark: str  # a file by which its source tree is known
    needs: str  # what it takes to compile it
    options: tuple[str, ...] = ()

    def __init__(self, source: Path) -> None:
        source = source.resolve()
        if not (source / self.mark).is_file():
            raise SystemExit(f"{source}: no {self.mark} there; give the folder of its sources")
        self.build = BUILDS / self.folder
        self._compile(source)

    def _compile(self, source: Path) -> None:
        here = str(Path(sys.executable).parent)
        cmake = shutil.which("cmake") or shutil.which("cmake", path=here)
        if cmake is None:
            raise SystemExit(f"{self.name}: cmake is missing (cmake of Debian or PyPI)")
        print(f"compiling {self.name} into {self.build} ...", file=sys.stderr)
        self.build.mkdir(parents=True, exist_ok=True)
        log = self.build / "build.log"
        peer = (source / self.mark).parent
        ours = HERE / "peer_codes" / self.folder
        configure = [cmake, "-S", ours, "-B", self.build, f"-DPEER={peer}", *self.options]
        make = [cmake, "--build", self.build, "--parallel", str(len(os.sched_getaffinity(0)))]
        with log.open("w", encoding="utf-8") as file:
            for command in ([*configure, "-DCMAKE_BUILD_TYPE=Release"], make):
                words = list(map(str, command))
                if subprocess.run(words, stdout=file, stderr=file, check=False).returncode:
                    raise SystemExit(f"{self.name} does not compile; it needs {self.needs}: {log}")


class DualSPHysics(Built):
    """On doseki's own particles, with its defaults for a dam break: Verlet, density diffusion."""

    name, folder, mark = "DualSPHysics", "dualsphysics", "src/source/main.cpp"
    needs = "g++ with OpenMP"

    def run(self, case: DamBreak, end: float, threads: int) -> Run:
        """See Code."""
        position, fixed = case.particles()
        order = np.argsort(~fixed, kind="stable")
        with TemporaryDirectory() as name:
            folder = Path(name)
            self._write(case, position[order], int(fixed.sum()), folder)
            command = [self.build / "dualsphysics", "-cpu", f"-ompthreads:{threads}", "dam", "out"]
            command += [f"-tmax:{end:.9g}", f"-tout:{end:.9g}", "-sv:binx", "-svres:0"]
            seconds, said = timed_command(command, threads, folder)
            steps = next(line for line in said.splitlines() if "Steps of simulation" in line)
            read = [self.build / "case", "read", folder / "out" / "data", 1]
            if not (folder / "out" / "data").is_dir():
                read[2] = folder / "out"
            x = [float(word) for word in timed_command(read, 1, folder)[1].split()]
        return Run(seconds, int(steps.rpartition(":")[2].replace(",", "")), front_of(x))

    def _write(self, case: DamBreak, position: np.ndarray, fixed: int, folder: Path) -> None:
        h, n = case.radius / KERNEL_SUPPORT, len(position)
        stiffness = case.sound_speed**2 * DENSITY / GAMMA
        mass = DENSITY * case.dp**2
        header = [n, fixed, case.dp, h, stiffness, DENSITY, GAMMA, mass]
        lines = [f"{x:.17g} 0 {z:.17g} 0 0 0" for x, z in position]
        subprocess.run(
            [str(self.build / "case"), "write", "dam"],
            input="\n".join([" ".join(map(repr, header)), *lines]),
            cwd=folder,
            text=True,
            check=True,
        )
        constants = {
            "data2d": "true", "data2dposy": 0, "cflnumber": 0.2, "gamma": GAMMA, "rhop0": DENSITY,
            "dp": case.dp, "h": h, "b": stiffness, "massbound": mass, "massfluid": mass,
        }  # fmt: skip
        parameters = {
            "StepAlgorithm": 1, "VerletSteps": 40, "Kernel": 2, "ViscoTreatment": 1, "Visco": 0.02,
            "DensityDT": 2, "DensityDTvalue": 0.1, "TimeMax": 1, "TimeOut": 1,
        }  # fmt: skip
        (folder / "dam.xml").write_text(
            "<case><execution><parameters>"
            + "".join(f'<parameter key="{k}" value="{v}"/>' for k, v in parameters.items())
            + f'</parameters><particles np="{n}" nb="{fixed}" nbf="{fixed}"'
            + ' mkboundfirst="11" mkfluidfirst="1">'
            + f'<fixed mkbound="0" mk="11" begin="0" count="{fixed}"/>'
            + f'<fluid mkfluid="0" mk="1" begin="{fixed}" count="{n - fixed}"/></particles>'
            + f'<constants><gravity x="0" y="0" z="{-case.gravity!r}"/>'
            + "".join(f'<{k} value="{v}"/>' for k, v in constants.items())
            + "</constants></execution></case>",
            encoding="utf-8",
        )


class SPHinXsys(Built):
    """On its own lattice in the same box: Riemann solver, steps of advection and of sound."""

    name, folder, mark = "SPHinXsys", "sphinxsys", "CMakeLists.txt"
    needs = "Simbody, TBB, Eigen, Boost and spdlog (libsimbody-dev ... of Debian)"
    options = ("-DDIM=2",)

    def run(self, case: DamBreak, end: float, threads: int) -> Run:
        """See Code."""
        numbers = [*case.box(), case.dp, case.sound_speed, case.gravity, end, threads]
        with TemporaryDirectory() as folder:
            command = [self.build / "dam_break", *numbers]
            seconds, said = timed_command(command, threads, Path(folder))
        steps, _, x = said.partition("steps ")[2].partition("\n")
        return Run(seconds, int(steps), front_of([float(word) for word in x.split()]))


def measure(codes: Sequence[Code], case: DamBreak, threads: int, repeats: int) -> str:
    """A table; codes take turns, so that what disturbs the machine disturbs all alike."""
    seconds: dict[str, list[float]] = {code.name: [] for code in codes}
    last: dict[str, Run] = {}
    for _ in range(repeats):
        for code in codes:
            short = code.run(case, START * case.end, threads)
            run = code.run(case, case.end, threads)
            seconds[code.name].append((run.seconds - short.seconds) / (1.0 - START))
            last[code.name] = run
            print(f"{code.name}: {seconds[code.name][-1]:.1f} s", file=sys.stderr)
    ours = median(seconds[codes[0].name])
    lines = []
    for name, run in last.items():
        took = median(seconds[name])
        spread = (max(seconds[name]) - min(seconds[name])) / took
        lines.append([
            name, f"{run.steps}", f"{1e6 * case.end / run.steps:.1f}", f"{run.front:.3f}",
            f"{took:.1f}", f"{100 * spread:.0f} %", f"{case.end / took:.2e}", f"{took / ours:.2f}",
        ])  # fmt: skip
    header = ["code", "steps", "step, us", "front, m", "s", "+-", "flow s/s", "times doseki's"]
    box = ", ".join(f"{size:.3g}" for size in case.box())
    return (
        f"dam break in 2-D (column and tank {box} m) to {case.end:g} s: dp = {case.dp:.4g} m,"
        f" c0 = {case.sound_speed:.3g} m/s, kernel radius {case.radius / case.dp:.2f} dp,"
        f" {threads} thread{'s' * (threads > 1)}, medians of {repeats}\n\n"
        + markdown_table(header, lines)
    )
