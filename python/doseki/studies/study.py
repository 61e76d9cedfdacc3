"""`doseki study FILE`: many runs of one scenario, their table, pictures, bands, and calibration."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path

from ..assess.cost import Estimate, estimate
from ..assess.summary import duration_text
from ..errors import UserError
from ..solver.build import filled_simulation
from ..util.cores import allowed_cores
from ..util.files import write_whole_text
from .calibration import Calibration, calibrated
from .outcome.pictures import Pictures
from .outcome.table import Entry, Table, check_parquet, write_table
from .plan.file import Plan, read_plan
from .plan.sampling import Point
from .runs.cluster import ClusterRuns
from .runs.evaluation import Engine, Evaluation, Tell
from .runs.folder import StudyFolder, StudyRuns
from .runs.local import LocalRuns
from .runs.row import DONE

LISTED = 5  # failed runs that are named


@dataclass
class StudyReport:
    """What a study came to.

    Attributes:
        table: of all runs.
        made: runs of this session; the others were there.
        calibration: None without one.
        files: that were written.
        notes: what was not, and why.

    """

    table: Table
    made: int
    calibration: Calibration | None = None
    files: list[Path] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def run_study(
    path: Path,
    directory: Path,
    tell: Tell,
    at_once: int | None = None,
    retry: bool = False,
    pictures: bool = True,
) -> StudyReport:
    """Make the runs of a study file that are missing in a folder, and what follows from all.

    `at_once` is how many run at the same time here, `retry` makes those again that failed.

    Raises:
        UserError: the file, or the folder, cannot be used, or a file STOP ended it.
        ResourceError: memory or disk run out.

    """
    plan = read_plan(path)
    if plan.top.parquet:
        check_parquet()
    for remark in plan.remarks:
        tell(f"warning: {remark}")
    folder = StudyFolder(directory)
    with folder.held():
        runs = StudyRuns(folder, plan)
        engine = _engine(plan, folder, at_once)
        evaluation = Evaluation(runs, engine, tell, retry)
        tell(_beginning(plan, engine))
        points = plan.points()
        evaluation.rows(points)
        found = None
        if plan.calibrate is not None:
            found = calibrated(plan.axes, evaluation, plan.calibrate, points)
        report = StudyReport(_table(evaluation, plan), evaluation.made, found)
        report.files += write_table(report.table, directory)
        if found is not None:
            report.files.append(_write_calibration(found, plan, directory))
        if pictures:
            drawn = Pictures(report.table, directory)
            drawn.draw()
            report.files += drawn.files
            report.notes += drawn.notes
    return report


def check_study(path: Path, at_once: int | None = None) -> str:
    """What a study will take, from a second of stepping in the middle of its ranges."""
    plan = read_plan(path)
    _check_at_once(plan, at_once)
    count = len(plan.points()) + (plan.calibrate.max_runs if plan.calibrate else 0)
    simulation, names, _ = filled_simulation(plan.scenario)
    simulation.start()
    expected = estimate(plan.scenario, simulation, names)
    lines = [plan.top.title or path.stem, "", *_described(plan)]
    if plan.cluster is not None:
        together = plan.cluster.at_once
    else:
        together = at_once or max(1, allowed_cores() // plan.top.threads)
    lines += list(_costs(plan, expected, count, together))
    lines += ["", *(f"warning: {remark}" for remark in plan.remarks)] if plan.remarks else []
    return "\n".join(lines)


def report_text(report: StudyReport) -> str:
    """A study on one screen."""
    table = report.table
    lines = [table.plan.top.title or "study", "", *_counts(report)]
    if found := report.calibration:
        lines += list(_calibration_lines(found, table.plan))
    elif best := table.best():
        lines.append(_line("best score", f"{best.row.score:.4g}, run {best.place.path.name}"))
        lines += [_line("", text) for text in _values(table.plan, best.point)]
    return "\n".join(lines)


def _engine(plan: Plan, folder: StudyFolder, at_once: int | None) -> Engine:
    _check_at_once(plan, at_once)
    if plan.cluster is None:
        return LocalRuns(folder, plan.top.threads, at_once)
    return ClusterRuns(folder, plan.top.threads, plan.cluster)


def _check_at_once(plan: Plan, at_once: int | None) -> None:
    if plan.cluster is not None and at_once is not None:
        raise UserError("--at-once is of this machine; a cluster has cluster.at_once")


def _beginning(plan: Plan, engine: Engine) -> str:
    parts = [f"{len(plan.points())} runs"] if plan.sample else []
    if plan.calibrate:
        parts.append(f"a calibration of at most {plan.calibrate.max_runs} runs")
    where = "here" if plan.cluster is None else f"on {plan.cluster.kind}"
    return f"{' and '.join(parts)}, {engine.at_once} at once {where}"


def _table(evaluation: Evaluation, plan: Plan) -> Table:
    """Every run of the sample, and every one that a calibration has looked at."""
    entries = [
        Entry(place, evaluation.point_of(place), row) for place, row in evaluation.known().items()
    ]
    return Table(plan, sorted(entries, key=lambda entry: entry.place.number))


def _write_calibration(found: Calibration, plan: Plan, directory: Path) -> Path:
    path = directory / "calibration.json"
    best = {} if found.point is None else dict(zip(_names(plan), found.point, strict=True))
    about = {**asdict(found), "score": None if found.point is None else found.score}
    del about["point"]
    units = {axis.name: axis.own_unit for axis in plan.axes}
    text = json.dumps({"values": best, "units": units, **about}, indent=1)
    write_whole_text(path, text + "\n")
    return path


def _names(plan: Plan) -> list[str]:
    return [axis.name for axis in plan.axes]


def _described(plan: Plan) -> Iterator[str]:
    """What varies, and how."""
    for axis in plan.axes:
        if axis.choices:
            yield _line(axis.label, ", ".join(str(choice) for choice in axis.choices))
        else:
            how = " by ratios" if axis.log else ""
            yield _line(axis.label, f"{axis.low:g} to {axis.high:g}{how}")
    if plan.sample is not None:
        yield _line("sample", f"{plan.sample.kind}, {len(plan.points())} runs")
    if plan.calibrate is not None:
        yield _line("calibration", f"{plan.calibrate.method}, up to {plan.calibrate.max_runs} runs")


def _costs(plan: Plan, expected: Estimate, count: int, together: int) -> Iterator[str]:
    """Time, memory and disk, as one run in the middle has them."""
    if math.isnan(expected.seconds):
        yield _line("one run", "not known: nothing has entered within a burst of a second")
        return
    rounds = -(-count // together)
    disk = expected.disk * count
    yield _line("one run", f"{duration_text(expected.seconds)}, in the middle of the ranges")
    yield _line("all runs", f"{duration_text(rounds * expected.seconds)}, {together} at once")
    yield _line("memory", f"{expected.memory * together / 1e6:.0f} MB")
    most = "at most " if plan.top.keep == "results" else ""
    yield _line("disk", f"{most}{disk / 1e6:.0f} MB")


def _counts(report: StudyReport) -> Iterator[str]:
    entries = report.table.entries
    done = len(report.table.done)
    yield _line("runs", f"{len(entries)}, {done} done, {report.made} made now")
    others = [entry for entry in entries if entry.row.status != DONE]
    for entry in others[:LISTED]:
        yield _line("", f"{entry.place.path.name} {entry.row.status}: {entry.row.reason}")
    if len(others) > LISTED:
        yield _line("", f"and {len(others) - LISTED} more: results.csv")
    lost = sum(entry.row.status == "lost" for entry in others)
    if lost:
        yield _line("", f"{lost} lost runs are made again when the study is started again")


def _calibration_lines(found: Calibration, plan: Plan) -> Iterator[str]:
    if found.point is None:
        yield _line("calibration", "no run has a score")
        return
    yield _line(
        "calibration", f"score {found.score:.4g} after {_looked_at(found)}; {found.message}"
    )
    for text in _values(plan, found.point):
        yield _line("", text)


def _looked_at(found: Calibration) -> str:
    """How many runs, those of a sample among them."""
    own = found.runs - found.sampled
    return f"{own} runs" + (f" and {found.sampled} of the sample" if found.sampled else "")


def _values(plan: Plan, point: Point) -> list[str]:
    return [
        f"{axis.name} = {axis.text(value)}" for axis, value in zip(plan.axes, point, strict=True)
    ]


def _line(name: str, text: str) -> str:
    return f"{name:<18}{text}"
