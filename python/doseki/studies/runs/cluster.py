"""Runs of a study as jobs of a cluster, by submitit (docs/decisions/0036-cluster-engine.md)."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from ...errors import ResourceError, UserError
from ..plan.tables import Cluster
from .folder import RunPlace, StudyFolder
from .local import Finished

POLL = {"slurm": 5.0, "local": 0.1}  # s between looks at jobs
MISSING = "runs on a cluster need submitit: pip install 'doseki[cluster]'"


class ClusterRuns:
    """Submits an array of jobs, one for each run, and waits for them.

    Jobs go on when this process ends; a study that goes on later waits for those that still run.
    """

    def __init__(self, folder: StudyFolder, threads: int, cluster: Cluster) -> None:
        """Raises UserError where submitit, or the cluster's own commands, are missing."""
        self._folder, self._cluster = folder, cluster
        self.at_once = cluster.at_once
        self._executor = _executor(folder, threads, cluster)

    def carry_out(self, places: Sequence[RunPlace], finished: Finished) -> None:
        """Run all; `finished` is called as each ends. A file STOP withdraws what has not ended.

        Raises ResourceError where the cluster takes no jobs.
        """
        for start in range(0, len(places), self._batch):
            if self._folder.stop.exists():
                return
            self._carry_out(places[start : start + self._batch], finished)

    @property
    def _batch(self) -> int:
        """submitit's own processes all start at once; SLURM holds an array back itself."""
        return self.at_once if self._cluster.kind == "local" else 1000

    def _carry_out(self, places: Sequence[RunPlace], finished: Finished) -> None:
        jobs = self._submit(places)
        going = dict(zip(places, jobs, strict=True))
        try:
            while going:
                for place in [place for place, job in going.items() if job.done()]:
                    finished(place, _reason(going.pop(place)))
                if self._folder.stop.exists():
                    return
                time.sleep(POLL[self._cluster.kind])
        finally:
            for job in going.values():
                with suppress(Exception):
                    job.cancel()

    def _submit(self, places: Sequence[RunPlace]) -> list[Any]:
        import submitit

        directory = str(self._folder.path.resolve())
        commands = [
            submitit.helpers.CommandFunction(
                [sys.executable, "-m", "doseki.studies.runs.job", directory, place.path.name],
                verbose=False,
            )
            for place in places
        ]
        try:
            with self._executor.batch():
                return [self._executor.submit(command) for command in commands]
        except submitit.core.utils.FailedJobError as error:
            kind = self._cluster.kind
            raise ResourceError(f"{kind} takes no jobs: {error}; start the study again") from None


def _executor(folder: StudyFolder, threads: int, cluster: Cluster) -> Any:
    """submitit's executor with what the study file says of jobs."""
    try:
        import submitit
    except ImportError:
        raise UserError(MISSING) from None
    logs = folder.path / "jobs"
    try:
        executor = submitit.AutoExecutor(logs, cluster=cluster.kind)
    except RuntimeError as error:
        raise UserError(f"[cluster] kind = {cluster.kind!r}: {error}") from None
    options: dict[str, Any] = {
        "timeout_min": cluster.minutes,
        "cpus_per_task": threads,
        "mem_gb": cluster.memory_gb,
        "name": "doseki",
    }
    if cluster.kind == "slurm":
        options["slurm_array_parallelism"] = cluster.at_once
        options["slurm_setup"] = cluster.setup
        if cluster.partition is not None:
            options["slurm_partition"] = cluster.partition
        if cluster.account is not None:
            options["slurm_account"] = cluster.account
    executor.update_parameters(**options)
    return executor


def _reason(job: Any) -> str:
    """Why a job ended without a row, as its last words or its state have it."""
    said = job.stderr() or ""
    lines = [line for line in said.strip().splitlines() if line.strip()]
    return f"job {job.job_id}: {lines[-1] if lines else job.state}"
