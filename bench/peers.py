#!/usr/bin/env python3
"""doseki and other SPH codes, timed on the same particles in one run (see README.md here).

../.venv/bin/python peers.py                  doseki and PySPH
../.venv/bin/python peers.py --peer NAME N NEIGHBOURS "COMMAND with {steps}"
../.venv/bin/python peers.py --sphinxsys DIR --dualsphysics DIR   time to solution
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shlex
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from solution import Code, DamBreak, Doseki, DualSPHysics, SPHinXsys, measure

from doseki.bench.report import machine, markdown_table
from doseki.scenario.load import load_scenario
from doseki.solver.build import build_simulation, load_core

HERE = Path(__file__).resolve().parent
ENVIRONMENT = HERE.parent / ".tools" / "peers" / "pysph"  # ignored by git
# PySPH is a source distribution before its first release; it compiles with Cython 3.0, not before
# and not after, and with the NumPy of before 2.  Build isolation would take the newest of both.
BUILD_TOOLS = ("setuptools<70", "wheel", "Cython>=3.0,<3.1", "numpy<2", "mako")
# Each is compiled against those before it.
PYSPH = ("cyarray==1.2", "compyle==0.9.1", "pysph==1.0b2")

RESOLUTION = {2: 200, 3: 50}  # particles along the height of the column
WARM_UP = 5  # steps


@dataclass
class Result:
    """One code on one case."""

    name: str
    dim: int
    n: int
    threads: int
    neighbours: float
    seconds_per_step: float

    @property
    def updates(self) -> float:
        """Particle steps per second."""
        return self.n / self.seconds_per_step

    @property
    def pairs(self) -> float:
        """Interacting pairs, each counted both ways, per second."""
        return self.updates * self.neighbours


def dam_break(dim: int) -> Any:
    """The shipped dam break, its water moving as fast as a front so that neighbours change.

    In 3-D it is open at the sides: codes differ too much in how they make periodic images.
    """
    velocity = ", ".join(["2.4", *["0"] * (dim - 1)])
    settings = [f"dim={dim}", f"dp== column_height/{RESOLUTION[dim]}", "periodic=[]"]
    return load_scenario("dambreak", [*settings, f"body.water.velocity=[{velocity}]"])


def time_doseki(dim: int, threads: int, steps: int) -> Result:
    """Steps of the ueta2022 scheme in double, list builds included."""
    load_core().set_threads(threads)
    simulation, _names = build_simulation(dam_break(dim))
    simulation.advance(limit=1e30, pause=1e30, max_steps=WARM_UP)
    clock = time.process_time if threads == 1 else time.perf_counter
    started = clock()
    simulation.advance(limit=1e30, pause=1e30, max_steps=steps)
    seconds = (clock() - started) / steps
    n = len(simulation)
    return Result("doseki", dim, n, threads, simulation.interacting_pairs() / n, seconds)


def install_pysph() -> Path:
    """The Python of PySPH's environment; made and compiled where it is not there yet (minutes)."""
    python = ENVIRONMENT / "bin" / "python"
    if not (ENVIRONMENT / "complete").exists():
        print(f"making {ENVIRONMENT} ...", file=sys.stderr)
        subprocess.run([sys.executable, "-m", "venv", "--clear", ENVIRONMENT], check=True)
        pip = [python, "-m", "pip", "install", "--quiet", "--no-build-isolation"]
        subprocess.run([*pip, *BUILD_TOOLS], check=True)
        for package in PYSPH:
            subprocess.run([*pip, "--pre", package], check=True)
        (ENVIRONMENT / "complete").touch()
    return python


def write_case(path: Path, dim: int) -> None:
    """What peer_pysph.py reads: our particles, support and timestep."""
    scenario = dam_break(dim)
    simulation, _names = build_simulation(scenario)
    state = simulation.state()
    sound_speed = scenario.materials["water"].scaled(scenario.xi).speedsound
    simulation.advance(limit=1e30, pause=1e30, max_steps=1)
    np.savez(
        path,
        position=state["position"],
        velocity=state["velocity"],
        fixed=state["motion"] == 1,
        support=2.5 * state["smoothing_length"].max(),
        timestep=simulation.timestep,
        rho0=1000.0,
        c0=sound_speed,
        dp=scenario.dp,
        dim=dim,
    )


def time_pysph(scheme: str, dim: int, threads: int, steps: int) -> Result:
    """As many steps of PySPH on the same particles."""
    with TemporaryDirectory() as folder:
        case, result = Path(folder) / "case.npz", Path(folder) / "result.json"
        write_case(case, dim)
        command = [install_pysph(), HERE / "peer_pysph.py", scheme, case, result, steps, threads]
        environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
        subprocess.run(
            list(map(str, command)),
            check=True,
            cwd=folder,
            env=environment,
            stdout=subprocess.DEVNULL,
        )
        measured = json.loads(result.read_text())
        n = len(np.load(case)["fixed"])
    seconds = measured["seconds_per_step"]
    return Result(f"PySPH, {scheme}", dim, n, threads, measured["neighbours"], seconds)


def _seconds_of_children() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _run_command(command: str, steps: int, threads: int) -> float:
    """Seconds: processor time of one thread, wall time of several."""
    words = shlex.split(command.format(steps=steps, threads=threads))
    clock = _seconds_of_children if threads == 1 else time.perf_counter
    started = clock()
    environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
    subprocess.run(words, check=True, env=environment, stdout=subprocess.DEVNULL)
    return clock() - started


def time_peer(words: list[str], dim: int, threads: int, steps: int) -> Result:
    """Any executable: 2 x steps minus 1 x steps leaves out what it does at the start."""
    name, n, neighbours, command = words
    short, long = (_run_command(command, k * steps, threads) for k in (1, 2))
    return Result(name, dim, int(float(n)), threads, float(neighbours), (long - short) / steps)


def table(results: list[Result]) -> str:
    """All results, with what doseki does per update and per pair in the same time."""
    ours = {(r.dim, r.threads): r for r in results if r.name == "doseki"}
    lines = []
    for r in results:
        reference = ours[r.dim, r.threads]
        lines.append([
            str(r.dim), str(r.threads), r.name, str(r.n), f"{r.neighbours:.0f}",
            f"{r.updates / 1e6:.3f}", f"{r.pairs / 1e6:.1f}",
            f"{reference.updates / r.updates:.1f}", f"{reference.pairs / r.pairs:.1f}",
        ])  # fmt: skip
    header = ["dim", "threads", "code", "N", "neighbours", "M updates/s", "M pairs/s",
              "doseki / it, updates", "doseki / it, pairs"]  # fmt: skip
    return markdown_table(header, lines)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--dims", type=int, nargs="+", default=[2, 3], choices=[2, 3])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--steps", type=int, default=50, help="timed steps [50]")
    parser.add_argument(
        "--pysph", nargs="*", default=["wcsph", "stress"], metavar="SCHEME", help="[wcsph stress]"
    )
    parser.add_argument(
        "--peer",
        nargs=4,
        action="append",
        default=[],
        metavar=("NAME", "N", "NEIGHBOURS", "COMMAND"),
        help="an executable; {steps} and {threads} in COMMAND are filled in",
    )
    sources = parser.add_argument_group(
        "time to solution",
        "With one of these, codes run a dam break in 2-D to the same time; they are compiled from"
        "\ntheir source trees first, into .tools/peers.",
    )
    sources.add_argument("--sphinxsys", type=Path, metavar="DIR", help="sources of SPHinXsys")
    sources.add_argument("--dualsphysics", type=Path, metavar="DIR", help="sources of DualSPHysics")
    sources.add_argument("--rows", type=int, default=60, help="particles over the column [60]")
    sources.add_argument("--until", type=float, default=0.4, help="s of flow [0.4]")
    sources.add_argument("--repeats", type=int, default=3, help="in turns [3]")
    return parser.parse_args()


def time_to_solution(options: argparse.Namespace) -> None:
    """Prints one table for each number of threads."""
    codes: list[Code] = [Doseki()]
    for peer, source in ((DualSPHysics, options.dualsphysics), (SPHinXsys, options.sphinxsys)):
        if source is not None:
            codes.append(peer(source))
    for threads in options.threads:
        case = DamBreak(options.rows, options.until)
        print(f"{machine()}; {measure(codes, case, threads, options.repeats)}\n")


def main() -> None:
    """Times every code on every case and prints one table."""
    options = arguments()
    if options.sphinxsys or options.dualsphysics:
        time_to_solution(options)
        return
    results = []
    for dim in options.dims:
        for threads in options.threads:
            case = (dim, threads, options.steps)
            results.append(time_doseki(*case))
            results += [time_pysph(scheme, *case) for scheme in options.pysph]
            results += [time_peer(words, *case) for words in options.peer]
            print(f"{dim}-D, {threads} threads: timed", file=sys.stderr)
    print(f"{machine()}; {options.steps} steps\n\n{table(results)}")


if __name__ == "__main__":
    main()
