"""One run of a study, in a process of its own: it is run, read, and given its row.

python -m doseki.studies.runs.one_run DIR NAME
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from pathlib import Path

import numpy as np

from ...errors import DosekiError, ResourceError, UserError, one_line
from ...record.folder import RunFolder
from ...record.lock import holder_of
from ...record.reader import Run, load
from ...running.resume import resume_run
from ...running.runner import RunOptions, run_scenario
from ...scenario.load import load_scenario
from ...util.files import write_whole_text
from ..plan.file import Plan
from ..reading.bands import CurveBand, curve_text
from ..reading.observations import total_score
from .folder import RunPlace, StudyFolder, read_job, reading_digest, stored_plan
from .row import DONE, FAILED, LOST, Row, read_row, write_row

LONGEST_WAIT = 60.0  # s for a process that still ends
GRACE = 15.0  # s to end a run in good order


def carry_out(directory: str, name: str) -> None:
    """Run, or go on with, the run NAME of the study in a folder, and write its row."""
    folder = StudyFolder(Path(directory))
    plan, place = stored_plan(folder), RunPlace(folder.runs / name)
    _wait_for_others(place)
    reading = reading_digest(plan)
    there = read_row(place.row)
    if there is not None and there.reading == reading and there.status != LOST:
        return  # a job of a cluster that outlived the study
    started = time.monotonic()
    try:
        if not _simulated(plan, place):
            return  # stopped: it goes on another time
        row = _read(plan, place, reading)
    except (MemoryError, ResourceError) as error:
        row = Row(LOST, reading, one_line(str(error) or "out of memory"))
    except DosekiError as error:
        row = Row(FAILED, reading, one_line(str(error)))
    seconds = _seconds(place, time.monotonic() - started)
    write_row(place.row, Row(**{**vars(row), "seconds": seconds}))
    if plan.top.keep == "results" and row.status != LOST:
        thin(place.record)


def _simulated(plan: Plan, place: RunPlace) -> bool:
    """Bring the run to its end, from its last checkpoint where it has one; False: stopped."""
    options = RunOptions(threads=plan.top.threads)
    record = place.record
    if record.is_run():
        status = load(record.path).summary.get("status")
        if status == "done":
            return True
        if status != "failed":
            try:
                summary, _ = resume_run(record.path, (), options)
                return bool(summary["status"] == "done")
            except UserError:
                pass  # what is there cannot be gone on from
    settings, _ = read_job(place)
    scenario = load_scenario(plan.scenario_name, settings)
    options.overwrite = record.is_run()
    return bool(run_scenario(scenario, record.path, options)["status"] == "done")


def _read(plan: Plan, place: RunPlace, reading: str) -> Row:
    """All that the study reads of a finished run."""
    run = load(place.record.path)
    results = {name: result.read(run) for name, result in plan.results.items()}
    misfits = {
        name: each.misfit(run, results, plan.folder) for name, each in plan.observations.items()
    }
    for name, band in plan.bands.items():
        if isinstance(band, CurveBand):
            write_whole_text(place.curve(name), curve_text(band.curve(run)))
    score = total_score(plan.observations, misfits)
    return Row(DONE, reading, _gaps(misfits), results, misfits, score, trust=_verdict(run))


def _gaps(misfits: dict[str, float]) -> str:
    missing = [name for name, value in misfits.items() if not np.isfinite(value)]
    return f"nothing to compare with observation {', '.join(missing)}" if missing else ""


def _verdict(run: Run) -> str:
    return str(run.trust.get("verdict", ""))


def _seconds(place: RunPlace, taken: float) -> float:
    """Wall time of the run, also where it was only read anew."""
    try:
        return float(load(place.record.path).summary["wall_seconds"])
    except (DosekiError, KeyError, TypeError, ValueError):
        return taken


def thin(record: RunFolder) -> None:
    """Remove the snapshots, checkpoints and inputs of a run; gauges, history and maps stay."""
    files = [
        *record.snapshot_files(), *record.checkpoints.glob("*.h5"), *record.inputs.glob("*"),
        record.series,
    ]  # fmt: skip
    for file in files:
        file.unlink(missing_ok=True)


def _wait_for_others(place: RunPlace) -> None:
    """A process that ran here may still be ending; raises UserError where it does not."""
    end = time.monotonic() + LONGEST_WAIT
    while holder := holder_of(place.record.path):
        if time.monotonic() > end:
            raise UserError(f"{place.path}: {holder} is writing here")
        time.sleep(0.1)


def _end_with_parent() -> None:
    """End, with a checkpoint where there is time, when whoever started this process is gone."""

    def watch() -> None:
        while os.read(0, 1024):
            pass
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(GRACE)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def main() -> None:
    """Entry point of the process."""
    directory, name = sys.argv[1:]
    _end_with_parent()
    code = 0
    try:
        carry_out(directory, name)
    except DosekiError as error:
        print(error, file=sys.stderr)
        code = error.exit_code
    except Exception:
        traceback.print_exc()
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # the thread that watches standard input does not end


if __name__ == "__main__":
    main()
