"""One run in progress: the simulation, its record, and where it stands in it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from ..record.folder import RunFolder
from ..record.history import BODY_ENERGIES, BROKEN
from ..record.writer import Recorder
from ..scenario.gauges.loads.overtopping import LOOKS
from ..scenario.model import Scenario
from ..solver.protocol import Simulation
from ..solver.rigid_bodies import grain_table
from ..util.finding import Finding, sentences
from .checkpoint import Beginning, Checkpoint, CheckpointFolder, Position
from .counts import Counts, build_counts
from .gauges import GaugeReader, build_gauges
from .identity import identity_of
from .live import LiveView, Watch
from .maps import RunningMaps
from .means import Means, build_means
from .meters import LoadMeans, build_meters
from .ranks import OneRank
from .rewind import Rewind
from .schedule import CheckpointClock, OutputTimes, StopRequests
from .sensors import Sensor, build_sensors
from .threads import ThreadChoice

BURST_SECONDS = 0.2  # wall time between two looks at signals and the progress bar
FIRST_BURST, LAST_BURST = 1, 1_000_000  # steps

Progress = Callable[[float, float, int], None]  # time, timestep, step


def history_row(simulation: Simulation, material_names: list[str]) -> dict[str, float]:
    """One row of history.csv (columns and units: docs/output.md)."""
    totals = simulation.totals()
    axes = "xyz"[: len(totals["momentum"])]
    row = {"time": simulation.time, "step": simulation.steps, "dt": simulation.timestep}
    row["mass"] = totals["mass"]
    row |= {f"momentum_{axis}": p for axis, p in zip(axes, totals["momentum"], strict=True)}
    row["kinetic_energy"] = totals["kinetic_energy"]
    row["bulk_energy"] = totals["bulk_energy"]
    row["shear_energy"] = totals["shear_energy"]
    row["av_dissipation"] = totals["av_dissipation"]
    row["gravity_work"], row["wall_work"] = totals["gravity_work"], totals["wall_work"]
    row["contact_work"], row["scheme_work"] = totals["contact_work"], totals["scheme_work"]
    row["relaxation_work"] = totals["relaxation_work"]
    row |= {name: totals[name] for name in (*BODY_ENERGIES, *BROKEN)}  # type: ignore[literal-required]
    row["energy_entered"], row["energy_left"] = totals["energy_entered"], totals["energy_left"]
    carried = {name: totals[name] for name in ("impulse", "momentum_entered", "momentum_left")}
    for name, vector in carried.items():
        row |= {f"{name}_{axis}": p for axis, p in zip(axes, vector, strict=True)}
    row["mass_asked"] = totals["mass_asked"]
    row["mass_entered"] = totals["mass_entered"]
    row["mass_left"] = totals["mass_left"]
    row["mass_inside"] = totals["mass"]
    row["mass_initial"] = totals["mass_initial"]
    row["n_particles"] = len(simulation)
    row |= {f"n_{name}": n for name, n in zip(material_names, totals["count"], strict=True)}
    return row


class ActiveRun:
    """A run between its start and its end."""

    def __init__(
        self,
        scenario: Scenario,
        simulation: Simulation,
        recorder: Recorder,
        body_names: list[str],
        ranks: OneRank,
        warnings: Sequence[Finding] = (),
    ) -> None:
        """`warnings` are those that came up when the scene was built."""
        self.scenario = scenario
        self.simulation = simulation
        self.recorder = recorder
        self.body_names = body_names
        self.ranks = ranks
        self.folder = RunFolder(recorder.directory)
        self.checkpoints = CheckpointFolder(self.folder.checkpoints)
        self.identity = ranks.on_root(lambda: identity_of(self.folder.scenario))
        self.position = Position()
        self.goes_on = False  # the simulation has its first rates already
        self.threads: ThreadChoice | None = None  # None: their number does not change
        self.rewind = Rewind()
        self.watch: Watch | None = None  # who else looks on
        self.outputs = OutputTimes(scenario.time_out, scenario.time_max)
        self.rows = OutputTimes(scenario.time_history, scenario.time_max)
        self.gauges = [
            (gauge, OutputTimes(gauge.interval, scenario.time_max))
            for gauge in build_gauges(scenario, body_names)
        ]
        readers = [gauge for gauge, _ in self.gauges]
        self.maps = RunningMaps(scenario, body_names, self.folder, ranks) if scenario.maps else None
        self.warnings = [*warnings, *(self.maps.findings if self.maps else ())]
        self.beginning = Beginning(sentences(warnings), dict([scenario.sound_speed_key]))
        self.sensors = build_sensors(readers)
        self.means: dict[str, Means | LoadMeans | Counts] = {
            **build_means(readers),
            **build_meters(readers),
            **build_counts(readers),
        }
        self.stride = self._steps_between_looks()
        self._started = time.perf_counter()

    @property
    def wall_seconds(self) -> float:
        """Wall time spent, parts before a resumption included."""
        return self.position.wall_seconds + time.perf_counter() - self._started

    def record_snapshot(self) -> None:
        """Write the state; the next snapshot is due one interval later."""
        simulation = self.simulation
        self.recorder.snapshot(
            simulation.state(),
            time=simulation.time,
            step=simulation.steps,
            dt=simulation.timestep,
            grains=grain_table(simulation),
        )
        self.position.outputs += 1
        self.position.snapshots += 1

    def record_history(self) -> None:
        """Write a row of diagnostics."""
        self.recorder.history(self.history_row())
        self.position.rows += 1

    def history_row(self) -> dict[str, float]:
        """What is known of the run now."""
        row = history_row(self.simulation, self.scenario.material_names)
        return row | self.ranks.balance(self.simulation)

    def record_gauge(self, gauge: GaugeReader) -> None:
        """Write a sample."""
        if gauge.name in self.sensors:
            rows = [self.sensors[gauge.name].row()]
        elif gauge.name in self.means:
            rows = self.means[gauge.name].sample(self.simulation)
        else:
            rows = gauge.read(self.simulation)
        self.recorder.gauge(gauge.name, gauge.header, rows)
        written = self.position.gauge_rows.get(gauge.name, 0) + len(rows)
        self.position.gauge_rows = self.position.gauge_rows | {gauge.name: written}

    def checkpoint(self) -> Checkpoint:
        """A copy of the state and of where the run stands."""
        sensors = {name: each.state for name, each in self._with_memory.items()}
        now = {"wall_seconds": self.wall_seconds, "sensors": sensors}
        position = Position(**vars(self.position) | now)
        names = self.scenario.material_names, self.body_names
        maps = self.maps.state if self.maps else {}
        state = self.simulation.checkpoint()
        return Checkpoint(state, position, *names, maps, self.identity, self.beginning)

    def write_checkpoint(self, clock: CheckpointClock | None = None) -> None:
        """Put the state safely on the disk, and `clock` forward if it was that which said so."""
        if clock is not None:
            clock.reset(self.simulation.time)
            self.position.next_checkpoint = clock.next_time
        self.recorder.sync()
        self.store(self.checkpoint())

    def store(self, checkpoint: Checkpoint) -> None:
        """Write a copy of the state."""
        state = self.ranks.whole_checkpoint(self.simulation, checkpoint.state)
        self.ranks.on_root(lambda: self.checkpoints.write(replace(checkpoint, state=state)))

    def next_output(self) -> float:
        """Time of the next snapshot; the last one is always at time_max."""
        return self.outputs.time(self.position.outputs)

    def limit_at(self, simulated: float) -> float:
        """The limit that steps have at a simulated time: the next snapshot or sample.

        Steps of bodies alone may be long: a row of the history that is asked for is one of theirs.
        """
        times = [self.outputs, *(times for _, times in self.gauges)]
        times += [self.maps.times] if self.maps else []
        times += [self.rows] if self.scenario.rows_end_steps else []
        limit = min(each.after(simulated) for each in times)
        return min(limit, self.scenario.time_max)

    def start(self, look: Callable[[], None] = lambda: None) -> None:
        """Take the first rates, record the initial state and write the first checkpoint.

        `look` is called before the checkpoint, which keeps what is found doubtful then.
        """
        if not self.goes_on:
            self.simulation.start()
        self.record_snapshot()
        self.position.outputs += self.outputs.passed(self.simulation.time)
        self.record_history()
        self._follow()
        for gauge, _ in self.gauges:
            self.record_gauge(gauge)
        if self.maps:
            self.maps.look(self.simulation)
        look()
        self.write_checkpoint()

    @property
    def _with_memory(self) -> dict[str, Sensor | Means | LoadMeans | Counts]:
        """What remembers something of the time before, by name of the gauge."""
        return {**self.sensors, **self.means}

    def go_on_from(self, checkpoint: Checkpoint) -> None:
        """Stand in the record where a checkpoint did; raises ValueError for one of another run."""
        self.position = position = checkpoint.position
        self.beginning = checkpoint.beginning
        if set(position.sensors) != set(self._with_memory):
            raise ValueError("the gauges with filter_hz or means are not those of its checkpoint")
        for name, each in self._with_memory.items():
            each.state = position.sensors[name]
        if self.maps:
            self.maps.go_on_from(checkpoint.maps)

    def advance(self, clock: CheckpointClock, progress: Progress, stop: StopRequests) -> bool:
        """Steps to the end, or to the first look after a stop request; true if it came to the end.

        `clock` says when to write checkpoints; `progress` is called after each burst of steps.
        """
        simulation, burst = self.simulation, FIRST_BURST
        stopped = self._is_watched_enough()
        while simulation.time < self.scenario.time_max and not stopped:
            if self.ranks.agree(self.rewind.is_due()):
                self.rewind.keep(self.checkpoint)
            burst = self._burst(burst, clock.next_time)
            if self.ranks.agree(clock.is_due(simulation.time)):
                self.write_checkpoint(clock)
            progress(simulation.time, simulation.timestep, simulation.steps)
            stopped = self._is_watched_enough() or self.ranks.agree(bool(stop))
        self.write_checkpoint(clock)
        is_over = simulation.time >= self.scenario.time_max
        if not is_over:
            self.record_snapshot()
            self.record_history()
        self.write_maps()
        return is_over

    def _is_watched_enough(self) -> bool:
        """Let who watches look, if it is time; whether that ends the run."""
        watch, simulation = self.watch, self.simulation
        if watch is not None and watch.is_due(simulation.time, simulation.steps):
            names = {"material": self.scenario.material_names, "body": self.body_names}
            watch.look(LiveView(simulation, self.scenario.time_max, names, self.history_row))
        return watch is not None and watch.stopped and simulation.time < self.scenario.time_max

    def write_maps(self) -> None:
        """Write the maps of the run so far, if it has any."""
        if self.maps:
            self.maps.write(self.simulation)

    def _burst(self, steps: int, pause: float) -> int:
        """Steps and records; returns how many steps to take next time."""
        simulation, limit = self.simulation, self.limit_at(self.simulation.time)
        samples = [(gauge, times.after(simulation.time)) for gauge, times in self.gauges]
        look = self.maps.times.after(simulation.time) if self.maps else math.inf
        # Also a step that ends there but for rounding, wherever bursts end.
        next_row = min(self.rows.after(simulation.time), self.scenario.time_max)
        next_row *= 1 - 0.5 * OutputTimes.SAME
        started, processor, first = time.perf_counter(), time.process_time(), simulation.steps
        pause = min(limit, pause, next_row)
        if self.watch is not None:
            pause = min(pause, self.watch.next_time)
            steps = min(steps, self.watch.steps_left(simulation.steps) or steps)
        self._step(limit, pause, steps)
        wall, done = time.perf_counter() - started, simulation.steps - first
        rate = done / wall
        if self.threads is not None:
            self.threads.spent(done, wall, time.process_time() - processor)
        if self.outputs.is_due(simulation.time, self.next_output()):
            self.record_snapshot()
        for gauge, planned in samples:
            if self.outputs.is_due(simulation.time, planned):
                self.record_gauge(gauge)
        if self.maps and self.outputs.is_due(simulation.time, look):
            self.maps.look(simulation)
        if simulation.time >= next_row:
            self.record_history()
        return self.ranks.agree(max(1, min(LAST_BURST, int(rate * BURST_SECONDS))))

    def _step(self, limit: float, pause: float, steps: int) -> None:
        """Steps of the simulation, of which sensors see each, and planes as many as they need."""
        simulation = self.simulation
        if self.stride is None:
            simulation.advance(limit=limit, pause=pause, max_steps=steps)
            return
        last = simulation.steps + steps
        while simulation.steps < last and simulation.time < min(limit, pause):
            until_look = self.stride - simulation.steps % self.stride
            most = min(last - simulation.steps, until_look)
            simulation.advance(limit=limit, pause=pause, max_steps=most)
            self._follow()

    def _steps_between_looks(self) -> int | None:
        """Of what follows the run; None where nothing does."""
        if self.sensors or (self._counts and self.scenario.has_bodies_alone):
            return 1
        return LOOKS if self._counts else None

    @property
    def _counts(self) -> list[Counts]:
        return [each for each in self.means.values() if isinstance(each, Counts)]

    def _follow(self) -> None:
        for sensor in self.sensors.values():
            sensor.follow(self.simulation)
        for counts in self._counts:
            counts.follow(self.simulation)

    def step_back(self) -> bool:
        """After a failed step, go back to the state before it and put that safely on the disk.

        False if there is no way back: the run failed before its first step, or fails on the way.
        """
        simulation, steps = self.simulation, self.simulation.steps
        copy = self.rewind.back_to(simulation, steps, self.limit_at)
        if copy is None:
            return False
        # The step before may be past saving; the run may go on from the state well before it.
        self.store(copy)
        if simulation.steps < steps:
            return False
        self.write_checkpoint()
        return True
