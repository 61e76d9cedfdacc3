"""Runs a scenario to its end, or to its failure."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from ..assess.estimates import solid_timestep
from ..assess.failure.failure import Failure, explain_failure, note_exhausted
from ..assess.ground.leaving import leaving_findings
from ..assess.ground.volumes import volumes_of
from ..assess.loads import sections_turned_round, write_loads
from ..assess.preflight import brief_doubts
from ..assess.summary import write_summary
from ..assess.trust.report import write_trust
from ..driver.active_run import ActiveRun, Progress
from ..driver.live import Watch
from ..driver.ranks import OneRank
from ..driver.schedule import CheckpointClock, StopRequests
from ..driver.start.first_state import first_state
from ..driver.threads import ThreadChoice
from ..errors import Interrupted, PhysicsError, ResourceError, UserError
from ..geodata.ground import write_ground
from ..measure.maps.leaving import what_left
from ..record.beginning import check_free
from ..record.reader import Run, load
from ..record.writer import Recorder
from ..scenario.gauges.loads.approach import Approach
from ..scenario.model import Scenario
from ..solver.build import load_core
from ..solver.protocol import SimulationView
from ..util.cores import chosen_threads
from ..util.finding import sentences
from ..util.telling import Tell, say_nothing
from .provenance import note_provenance

CHECKPOINT_MINUTES = 10.0  # what a crash may cost

# Scenario, core simulation, names of bodies, what is doubtful about them in sentences.
Started = Callable[[Scenario, SimulationView, list[str], Sequence[str]], None]


def _no_progress(_time: float, _timestep: float, _step: int) -> None:
    pass


def _say_nothing(
    _scenario: Scenario,
    _simulation: SimulationView,
    _body_names: list[str],
    _doubts: Sequence[str],
) -> None:
    pass


def _do_nothing() -> None:
    pass


@dataclass
class RunOptions:
    """How a run is carried out, as against what it simulates."""

    threads: int | None = None
    overwrite: bool = False
    progress: Progress = field(default=_no_progress)
    started: Started = field(default=_say_nothing)  # called before the first step
    checkpoint_every: float | None = None  # s of simulated time
    checkpoint_minutes: float = CHECKPOINT_MINUTES  # of wall time
    ranks: OneRank = field(default_factory=OneRank)
    tell: Tell = field(default=say_nothing)  # how far the work before the first step has come
    watch: Watch | None = None  # a callback that looks on; on one rank alone
    stops: Callable[[Path], StopRequests] = StopRequests  # what asks the run in a folder to stop
    # The files of a scenario that is one which a run stored: it named them, and names them no more.
    files: Sequence[Mapping[str, str]] = ()
    # Called before the first step of a run that goes on from a checkpoint.
    resumed: Callable[[], None] = field(default=_do_nothing)

    def __post_init__(self) -> None:
        if self.watch is not None and self.ranks.count > 1:
            raise UserError("a callback cannot look at a run on several ranks: run it on one")


def _summary(run: ActiveRun, status: str) -> dict[str, Any]:
    simulation, scenario = run.simulation, run.scenario
    last = run.history_row()
    solid = solid_timestep(scenario)
    last |= {"mass_through_ground": simulation.totals()["mass_through_ground"]}
    recorded, doubts = run.ranks.on_root(lambda: _recorded(run, last)) if scenario.bed else ({}, [])
    balance = last["mass_initial"] + last["mass_entered"] - last["mass_left"] - last["mass_inside"]
    return {
        "status": status,
        "title": scenario.title,
        "scheme": scenario.scheme,
        "dim": scenario.dim,
        "precision": scenario.precision,
        "dp": scenario.dp,
        "xi": scenario.xi,
        "sound_speed_from": run.beginning.sound_speed_from,
        "ranks": run.ranks.count,
        "wall_seconds": run.wall_seconds,
        "particle_updates_per_second": simulation.updates / run.wall_seconds,
        "neighbour_rebuilds": simulation.rebuilds,
        "bytes_per_particle": simulation.bytes_per_particle,
        "list_entries_per_particle": simulation.entries_per_particle,
        "ledger_residual": balance,
        "largest_overlap": simulation.grains()["worst_overlap"],
        "warnings": list(dict.fromkeys([*_warnings(run), *doubts])),
        **({} if solid is None else {"solid_timestep": solid}),
        **recorded,
        **({"runout": run.maps.runout} if run.maps else {}),
        **last,
    }


def _recorded(run: ActiveRun, last: Mapping[str, float]) -> tuple[dict[str, Any], list[str]]:
    """What the record of a run on a terrain says of its releases and lakes, and of what left it,
    with what is doubtful; `last` are the masses at its end, kg.  What cannot be read harms no run.
    """
    try:
        record = load(run.folder.path)
        found = what_left(record, last["mass_left"] - last["mass_through_ground"])
        left = {} if found is None else {"left": asdict(found)}
        table = volumes_of(run.scenario, record).table | left
    except (Exception, Interrupted) as error:
        return {}, [f"what left the terrain is not known: {error or repr(error)}"]
    return table, sentences(leaving_findings({**last, **left}))


def _warnings(run: ActiveRun) -> Iterator[str]:
    """What is doubtful about a run: its set-up, its maps, and its gauges."""
    yield from run.beginning.warnings
    if run.maps:
        yield from [*sentences(run.maps.findings), *run.maps.remarks]
    if any(isinstance(gauge, Approach) for gauge in run.scenario.gauge.values()):
        yield from run.ranks.on_root(lambda: _of_gauges(run.folder.path))


def _of_gauges(directory: Path) -> list[str]:
    """What the record of a run says of its sections; what cannot be read harms no run."""
    try:
        return sentences(sections_turned_round(load(directory)))
    except (Exception, Interrupted) as error:
        return [f"the gauges of the run could not be judged: {error or repr(error)}"]


def run_scenario(
    scenario: Scenario, directory: str | Path, options: RunOptions | None = None
) -> dict[str, Any]:
    """Simulates `scenario` and writes its record into `directory`.

    Returns the summary, which is also DIR/summary.json; its `status` is "done", or "stopped" after
    SIGINT, SIGTERM or a file DIR/STOP.  Raises UserError for a scenario or folder that cannot be
    used (nothing is written then), PhysicsError when the state becomes unphysical (the record up to
    there is kept, the summary says "failed"), ResourceError when memory or disk runs out.
    """
    options = options or RunOptions()
    with run_folder(directory, options.overwrite, options.ranks):
        state = first_state(scenario, options.ranks, options.tell)
        names = scenario.material_names, state.body_names
        text, inputs = scenario.effective_toml(stored=True), scenario.inputs
        named = options.ranks.on_root(lambda: [each.table for each in scenario.named_files])
        recorder = options.ranks.recorder(
            directory,
            lambda: Recorder(directory, text, *names, scenario.dim, options.overwrite, inputs),
        )
        if (bed := scenario.bed) is not None:
            options.ranks.on_root(lambda: write_ground(Path(directory), bed.ground))
        run = ActiveRun(
            scenario, state.simulation, recorder, state.body_names, options.ranks, state.warnings
        )
        run.goes_on = state.goes_on
        return carry_out(run, replace(options, files=options.files or named), fresh=True)


@contextmanager
def run_folder(directory: str | Path, overwrite: bool, ranks: OneRank) -> Iterator[None]:
    """Hold the folder of a new run, which is looked at before the work of making a scene.

    Raises UserError where another process writes there, or where something else is.
    """
    ranks.on_root(lambda: check_free(directory, overwrite))
    with ranks.holding(directory):
        yield


def _explained(run: ActiveRun, message: str) -> Failure:
    """What happened to a run, which is taken back to the last good step and recorded there."""
    simulation = run.simulation
    kind, particle, position = simulation.failure
    state, time, steps = simulation.state(), simulation.time, simulation.steps
    rewound = run.step_back()
    if rewound or run.rewind.last is None:  # else it is back before what was recorded last
        run.record_snapshot()
    run.write_maps()
    failure = Failure(kind, particle, position, message, state, time, steps, rewound)
    explain_failure(run, failure)
    return failure


def _tell_of_start(run: ActiveRun, started: Started) -> None:
    """Keep what is doubtful about a run that has just been started, and tell of it."""

    def look(whole: SimulationView) -> None:
        of_run = run.scenario, whole, run.body_names
        run.beginning.warnings = brief_doubts(*of_run, run.warnings)
        started(*of_run, run.beginning.warnings)

    run.ranks.show(run.simulation, look)


def carry_out(run: ActiveRun, options: RunOptions, fresh: bool) -> dict[str, Any]:
    """Takes a run, `fresh` or restored, to its end; see run_scenario."""
    core, directory = load_core(), run.folder.path
    run.watch = options.watch
    threads, before = run.ranks.threads(options.threads), core.threads()
    core.set_threads(threads)
    if not (options.threads or chosen_threads() or run.ranks.count > 1):
        run.threads = ThreadChoice(threads, core.set_threads)
    ranks, files = run.ranks.count, options.files
    run.ranks.on_root(lambda: note_provenance(run.folder, fresh, threads, ranks, files))
    run.ranks.working_in(directory, run.simulation)
    stop = options.stops(directory)
    reason = ""
    try:
        with stop.listening():
            if fresh:
                run.start(partial(_tell_of_start, run, options.started))
            clock = CheckpointClock(
                options.checkpoint_every,
                options.checkpoint_minutes,
                run.position.next_checkpoint,
                run.simulation.time,
            )
            status = "done" if run.advance(clock, options.progress, stop) else "stopped"
            reason = _reason(options.watch, stop) if status == "stopped" else ""
    except core.ResourceFailure as failure:
        note_exhausted(run, str(failure))
        raise ResourceError(str(failure)) from failure
    except core.PhysicsFailure as failure:
        try:
            explained = _explained(run, str(failure))
        except ResourceError as full:
            raise PhysicsError(f"{failure}. It could not be recorded: {full}") from failure
        run.recorder.close(_summary(run, "failed") | {"failure": str(failure)})
        run.ranks.on_root(partial(write_reports, directory))
        raise PhysicsError(
            f"{failure}. {explained.advice} The record up to there is in {directory};"
            f" more: doseki explain {directory}",
            explained.kind,
            explained.particle,
            explained.position,
        ) from failure
    except ResourceError as error:
        note_exhausted(run, str(error))
        raise ResourceError(f"{error}; what was written before is whole, in {directory}") from None
    finally:
        core.set_threads(before)
    summary = _summary(run, status) | ({"stopped_by": reason} if reason else {})
    run.recorder.close(summary)
    for reports in (JUDGEMENTS, TEXT):
        if remark := run.ranks.on_root(partial(write_reports, directory, reports)):
            summary["warnings"].append(remark)
            run.recorder.close(summary)
    return summary


def _reason(watch: Watch | None, stop: StopRequests) -> str:
    """What stopped a run."""
    if watch is not None and watch.error is not None:
        return f"an error in the callback: {watch.error!r}"
    return "the callback" if watch is not None and watch.stopped else stop.reason


Report = tuple[str, Callable[[Run], object]]  # what, and what writes it
JUDGEMENTS: tuple[Report, ...] = (("trust report", write_trust), ("table of loads", write_loads))
TEXT: tuple[Report, ...] = (("summary.txt", write_summary),)  # what it says begins with the others


def write_reports(directory: str | Path, reports: Sequence[Report] = JUDGEMENTS + TEXT) -> str:
    """Say what a run came to; what cannot be written is returned in words, and harms no run."""
    remarks = []
    for what, write in reports:
        try:
            write(load(directory))
        except (Exception, Interrupted) as error:
            remarks.append(f"no {what}: {error or repr(error)}")
    return "; ".join(remarks)
