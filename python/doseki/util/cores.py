"""Which processor cores a run may count on."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .finding import Finding

MOST_DIGITS = 9  # of a number of threads that OpenMP takes
BUSY = 0.5  # cores that others may take without being spoken of
GROUPS = Path("/sys/fs/cgroup")
MEMBERSHIP = Path("/proc/self/cgroup")


def allowed_cores() -> int:
    """Cores that this process may run on, as its affinity and the quota of its group say."""
    cores, limit = len(os.sched_getaffinity(0)), quota()
    return cores if limit >= cores else max(1, int(limit))


def chosen_threads() -> bool:
    """Whether the environment says how many threads there are to be."""
    return bool(os.environ.get("OMP_NUM_THREADS"))


def quota(groups: Path = GROUPS, membership: Path = MEMBERSHIP) -> float:
    """Processors whose time the control groups of this process allow it; infinite without a limit.

    A container sees all cores of its host and gets the time of some: threads beyond that stand
    still, all together, for a part of every tenth of a second.
    """
    return min((_limit(folder) for folder in _folders(groups, membership)), default=math.inf)


def _folders(groups: Path, membership: Path) -> Iterator[Path]:
    """The folders of the groups that the process is in, of both versions, with those above."""
    try:
        lines = membership.read_text().splitlines()
    except (OSError, ValueError):
        return
    for line in lines:
        _, controllers, path = [*line.split(":", 2), "", ""][:3]
        names = controllers.split(",")
        if controllers and "cpu" not in names:
            continue
        top = groups / "cpu" if controllers else groups
        folder = top / path.lstrip("/")
        yield folder
        yield from (above for above in folder.parents if above.is_relative_to(top))


def _limit(folder: Path) -> float:
    """The quota of one group over its period; infinite where it has none."""
    try:
        if (folder / "cpu.max").exists():
            limit, period = (folder / "cpu.max").read_text().split()
        else:
            limit = (folder / "cpu.cfs_quota_us").read_text()
            period = (folder / "cpu.cfs_period_us").read_text()
        found = float(limit) / float(period)
    except (OSError, ValueError, ZeroDivisionError):
        return math.inf
    return found if found > 0 else math.inf


@dataclass(frozen=True)
class SharedCores(Finding):
    """Cores that other programs use, or a quota that allows less than the threads ask for."""

    threads: int
    cores: int
    load: float  # programs that run or wait, a mean over the last minute
    quota: float  # processors

    @property
    def doubts(self) -> list[str]:
        """What keeps the threads from having a core each."""
        said = []
        if self.threads > self.quota:
            said.append(f"the quota of this process is the time of {self.quota:.3g} processors")
        if self.threads > self.cores:
            said.append(f"it may use {self.cores} cores")
        if self.load + self.threads > self.cores + BUSY and self.load > BUSY:
            said.append(f"others run here (a load of {self.load:.3g} on {self.cores} cores)")
        return said

    def __str__(self) -> str:
        threads = f"{self.threads} thread{'s' * (self.threads > 1)}"
        return (
            f"the cores are not this run's own: {threads}, and {'; '.join(self.doubts)}: it will "
            "be slower than expected"
        )


def shared_cores(threads: int | None = None) -> list[SharedCores]:
    """What is to be said of the cores before a run of so many threads (default: all) begins."""
    cores = len(os.sched_getaffinity(0))
    threads = threads or int_of(os.environ.get("OMP_NUM_THREADS")) or allowed_cores()
    found = SharedCores("", threads, cores, os.getloadavg()[0], quota())
    return [found] if found.doubts else []


def int_of(text: str | None) -> int | None:
    """The first of the whole numbers that OMP_NUM_THREADS may hold."""
    first = (text or "").split(",")[0].strip()
    readable = first.isdecimal() and len(first) <= MOST_DIGITS
    return int(first) if readable and int(first) > 0 else None
