"""`doseki bench`: how fast the scheme runs here, and where the time goes."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import product
from pathlib import Path
from statistics import median
from typing import Any

from ..compiled import (
    DEVICES,
    available_instruction_sets,
    card_here,
    load_core,
    use_device,
)
from ..errors import ResourceError, UserError
from ..scenario.schemes import UETA2022
from ..solver.protocol import CoreSimulation
from ..util.cores import allowed_cores, shared_cores
from ..version import version
from .case import SCHEMES, Case, clocked, make_simulation
from .flows import FLOWS, print_flows, time_flows
from .report import checks, growth, machine, memory_check, phase_table, speed_table
from .roofline import print_work, work_of

SIZES = (4_000, 10_000, 100_000, 1_000_000)
QUICK_SIZES = (4_000, 10_000, 100_000)
COMPARED_SIZE, QUICK_COMPARED_SIZE = 100_000, 10_000  # where instruction sets are compared
SMALLEST = 1_000  # particles
PRECISIONS = ("double", "mixed")
ROUNDS, QUICK_ROUNDS = 5, 3
LIVES_PER_ROUND = 4  # of the lists, at most
ROUND_SECONDS = 0.1  # at least, unless the lists' lives are up
BARE_SECONDS = 0.05
OF_BLOCK = ("--sizes", "--dims", "--isa", "--device", "--scheme")

Row = dict[str, Any]


@dataclass(frozen=True)
class Plan:
    """What is to be timed; what is empty is chosen for this machine."""

    dims: Sequence[int] = (2, 3)
    precisions: Sequence[str] = PRECISIONS
    sizes: Sequence[int] = ()
    threads: Sequence[int] = ()
    isas: Sequence[str] = ()
    quick: bool = False
    scheme: str = UETA2022
    block: bool = True  # whether it is timed
    flows: Sequence[str] = ()

    def groups(self) -> Iterator[list[Case]]:
        """Cases to be timed in turns, so that what disturbs the machine disturbs them alike."""
        for dim, n in product(self.dims, self.sizes or (QUICK_SIZES if self.quick else SIZES)):
            yield [*self._cases(dim, n), *self._other_instruction_sets(dim, n)]

    def _cases(self, dim: int, n: int) -> list[Case]:
        isas = self.isas or available_instruction_sets()[:1]
        return [
            Case(dim, n, precision, threads, isa, scheme=self.scheme)
            for isa, precision, threads in product(
                isas, self.precisions, self.threads or default_threads()
            )
        ]

    def _other_instruction_sets(self, dim: int, n: int) -> list[Case]:
        """One thread in double, at one size, to compare with."""
        compared = QUICK_COMPARED_SIZE if self.quick else COMPARED_SIZE
        if self.isas or n != compared or "double" not in self.precisions:
            return []
        others = available_instruction_sets()[1:]
        return [Case(dim, n, "double", 1, isa, scheme=self.scheme) for isa in others]


def default_threads() -> list[int]:
    """One, two, and all."""
    every = allowed_cores()
    return sorted({1, min(2, every), every})


@dataclass
class Timing:
    """One case, and what has been measured of it so far."""

    case: Case
    simulation: CoreSimulation
    update_rates: list[float] = field(default_factory=list)  # per second
    core_shares: list[float] = field(default_factory=list)  # processor time / (time x threads)
    bare_rates: list[float] = field(default_factory=list)  # pairs per second of one thread
    steps: int = 0
    rebuilds: int = 0

    @classmethod
    def of(cls, case: Case) -> Timing:
        """Makes the simulation and runs it to the end of its first lists."""
        timing = cls(case, make_simulation(case))
        timing._live_once()
        timing.simulation.time_phases(True)
        return timing

    def _live_once(self) -> None:
        """Steps up to and including the next build of lists."""
        simulation = self.simulation
        built = simulation.rebuilds
        while simulation.rebuilds == built:
            simulation.advance(limit=1e30, pause=1e30, max_steps=1)

    def _live_for_a_round(self) -> None:
        started = time.perf_counter()
        for _ in range(LIVES_PER_ROUND):
            self._live_once()
            if time.perf_counter() - started > ROUND_SECONDS:
                break

    def run_round(self) -> None:
        """Adds one measurement, of whole lives of the lists."""
        simulation = self.simulation
        load_core(self.case.isa).set_threads(self.case.threads)
        first_step, first_build = simulation.steps, simulation.rebuilds
        seconds, core_share = clocked(self.case.threads, self._live_for_a_round)
        steps = simulation.steps - first_step
        self.update_rates.append(self.case.n * steps / seconds)
        self.core_shares.append(core_share)
        self.steps += steps
        self.rebuilds += simulation.rebuilds - first_build
        on_device = self.case.isa in DEVICES.values()
        if self.case.threads == 1 and self.case.scheme == UETA2022 and not on_device:
            self.bare_rates.append(simulation.bare_pair_rate(BARE_SECONDS))

    def shares(self) -> dict[str, float]:
        """Share of each phase in the time of a step."""
        load_core(self.case.isa).set_threads(self.case.threads)
        seconds = self.simulation.phase_seconds()
        total = sum(seconds.values())
        return {phase: value / total for phase, value in seconds.items()}

    def row(self, bare_rate: float | None) -> Row:
        """The result; `bare_rate` is that of the pair loop by itself, where it was measured."""
        case, simulation = self.case, self.simulation
        rate = median(self.update_rates)
        pairs = simulation.interacting_pairs() / case.n
        pair_rate = rate * pairs / case.threads
        shares = self.shares()
        return {
            "dim": case.dim,
            "precision": case.precision,
            "scheme": case.scheme,
            "n": case.n,
            "threads": case.threads,
            "isa": case.isa,
            "updates_per_s": rate,
            "pairs_per_s": pair_rate,
            "bytes_per_particle": simulation.bytes_per_particle,
            "phases": shares,
            "work": work_of(case, simulation, rate, shares),
            "pairs_per_particle": pairs,
            "list_to_pair": simulation.entries_per_particle * case.lanes / pairs,
            "bare_pairs_per_s": bare_rate,
            "bare_fraction": pair_rate / bare_rate if bare_rate else None,
            "seconds_per_step": case.n / rate,
            "steps_per_rebuild": self.steps / self.rebuilds,
            "skin": simulation.skin,
            "core_share": median(self.core_shares),
            "spread": (max(self.update_rates) - min(self.update_rates)) / rate,
        }


def run_group(cases: Sequence[Case], rounds: int) -> list[Row]:
    """Times the cases in turns; the medians are the rows."""
    timings = [Timing.of(case) for case in cases]
    for _ in range(rounds):
        for timing in timings:
            timing.run_round()
    bare = {
        (timing.case.precision, timing.case.isa): median(timing.bare_rates)
        for timing in timings
        if timing.bare_rates
    }
    return [timing.row(bare.get((timing.case.precision, timing.case.isa))) for timing in timings]


def run_bench(plan: Plan) -> Iterator[list[Row]]:
    """The rows of one group of cases after another."""
    for group in plan.groups():
        yield run_group(group, QUICK_ROUNDS if plan.quick else ROUNDS)


def _words(option: str, text: str | None, allowed: Sequence[str]) -> list[str]:
    words = [word.strip() for word in text.split(",")] if text else []
    for word in words:
        if word not in allowed:
            raise UserError(f"{option} {word}: must be one of {', '.join(allowed)}")
    return words


def counts_of(option: str, text: str | None, most: float) -> list[int]:
    """Whole numbers separated by commas; raises UserError for anything else."""
    try:
        counts = [float(word) for word in text.split(",")] if text else []
    except ValueError:
        raise UserError(f"{option} {text}: expected numbers separated by commas") from None
    for count in counts:
        if not (1 <= count <= most and count == int(count)):
            raise UserError(f"{option} {count:g}: must be a whole number from 1 to {most:g}")
    return [int(count) for count in counts]


def modules_here() -> list[str]:
    """Modules of the core that can be timed here, that of a card among them."""
    return [*available_instruction_sets(), *(["cuda"] if card_here() else [])]


def make_plan(options: Mapping[str, str | None], quick: bool) -> Plan:
    """The plan for options as typed; raises UserError for what cannot be run here."""
    sizes = counts_of("--sizes", options["--sizes"], 1e8)
    if sizes and min(sizes) < SMALLEST:
        raise UserError(
            f"--sizes {min(sizes)}: fewer than {SMALLEST} particles are not worth timing"
        )
    isas = _words("--isa", options["--isa"], modules_here())
    if device := options["--device"]:
        if isas:
            raise UserError("--isa: not with --device, which says what is timed")
        use_device(_words("--device", device, list(DEVICES))[0])
        isas = [DEVICES[device]]
    flows = _chosen_flows(options, quick)
    scheme = (_words("--scheme", options["--scheme"], SCHEMES) or [UETA2022])[0]
    precisions = _words("--precision", options["--precision"], PRECISIONS) or list(PRECISIONS)
    return Plan(
        scheme=scheme,
        dims=[int(word) for word in _words("--dims", options["--dims"], ["2", "3"])] or [2, 3],
        precisions=precisions,
        sizes=sizes,
        threads=counts_of("--threads", options["--threads"], 4096),
        isas=isas,
        quick=quick,
        block=options["--flows"] is None,
        flows=flows,
    )


def _chosen_flows(options: Mapping[str, str | None], quick: bool) -> list[str]:
    """All of them beside the block, unless options choose something of either."""
    text = options["--flows"]
    if text is None:
        chosen = [*OF_BLOCK, "--precision"]
        return [] if quick or any(options[name] is not None for name in chosen) else list(FLOWS)
    of_block = [name for name in OF_BLOCK if options[name] is not None]
    if quick or of_block:
        option = "--quick" if quick else of_block[0]
        raise UserError(f"{option} goes with the block of particles, not with --flows")
    names = _words("--flows", text, [*FLOWS, "all"])
    if not names:
        raise UserError(f"--flows: name some of {', '.join([*FLOWS, 'all'])}")
    return list(FLOWS) if "all" in names else names


def append_history(path: Path, rows: Sequence[Row]) -> None:
    """Adds one line of JSON to `path`: when, where, and the rows."""
    date = datetime.now(UTC).isoformat(timespec="seconds")
    record = {"date": date, "version": version(), "machine": machine(), "rows": list(rows)}
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(record) + "\n")


def print_report(rows: Sequence[Row]) -> None:
    """Tables, growth and targets, as Markdown."""
    print(f"{machine()}; scheme {rows[0]['scheme']}")
    for title, table in (("Speed and memory", speed_table), ("Share of a step, %", phase_table)):
        print(f"\n{title}\n\n{table(rows)}")
    print_work(rows)
    print("\nStep time ~ N^a\n")
    for name, exponent in growth(rows):
        print(f"- {name}: a = {exponent:.3f}")
    print("\nTargets\n")
    for check in checks(rows):
        print(f"- {check}")


def bench_command(plan: Plan, as_json: bool, history: Path | None) -> None:
    """`doseki bench`; raises ResourceError when memory is over its limit."""
    rows: list[Row] = []
    for group in run_bench(plan) if plan.block else ():
        rows += group
        print(
            f"doseki bench: {group[0]['dim']}-D, {group[0]['n']} particles timed", file=sys.stderr
        )
    flows: list[Row] = []
    for group in time_flows(plan.flows, plan.precisions, plan.threads or default_threads()):
        flows += group
        print(f"doseki bench: {group[0]['flow']} timed", file=sys.stderr)
    if as_json:
        print(json.dumps([*rows, *flows]))
    else:
        for doubt in shared_cores(max(row["threads"] for row in [*rows, *flows])):
            print(f"warning: {doubt}")
        if rows:
            print_report(rows)
        if flows:
            print_flows(flows)
    if history:
        append_history(history, [*rows, *flows])
    memory = memory_check(rows)
    if memory and not memory.holds:
        raise ResourceError(f"over the limit of memory: {memory}")
