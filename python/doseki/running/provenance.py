"""With what a run was computed: DIR/provenance.json, an entry for its start and each resumption."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

import psutil

from ..compiled import load_core
from ..errors import UserError
from ..record.folder import RunFolder
from ..util.files import write_whole_text
from ..util.foreign import REMEDY, read_json_table
from ..version import version

LIBRARIES = (
    "numpy", "scipy", "h5py", "matplotlib", "pydantic", "simpleeval", "threadpoolctl", "trimesh",
    "rasterio", "pyogrio", "shapely", "mpi4py",
)  # fmt: skip
GIT_SECONDS = 5.0
MAX_BYTES = 4 * 2**20


def core_name() -> str:
    """The instruction set, or the device, of the core of this process."""
    return load_core().__name__.rpartition("_core_")[2]


def provenance_now(threads: int = 0, ranks: int = 1) -> dict[str, Any]:
    """Versions, machine and command of this process; the host's name is left out."""
    return {
        "doseki": version(),
        "commit": commit(),
        "core": core_name(),
        "python": platform.python_version(),
        "libraries": _libraries(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "memory_bytes": psutil.virtual_memory().total,
        "system": platform.platform(),
        "threads": threads,
        "ranks": ranks,
        "command": _command(),
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def note_provenance(
    folder: RunFolder,
    fresh: bool,
    threads: int,
    ranks: int,
    files: Sequence[Mapping[str, str]] = (),
) -> None:
    """Write down with what a run starts, or goes on where it is not `fresh`.

    `files` are those that its scenario named, with key, name and digest.
    What was written before is lost where it is damaged: a run goes on all the same. Raises
    ResourceError or UserError where nothing can be written.
    """
    before: list[dict[str, Any]] = []
    if not fresh:
        with suppress(UserError):
            before = read_provenance(folder)
    inputs = {"inputs": [dict(each) for each in files]} if fresh else {}
    entry = provenance_now(threads, ranks) | inputs
    text = json.dumps({"runs": [*before, entry]}, indent=1) + "\n"
    write_whole_text(folder.provenance, text)


def read_provenance(folder: RunFolder) -> list[dict[str, Any]]:
    """Entries of the start and of each resumption; none for the run of an earlier version.

    Raises UserError for a damaged file.
    """
    if not folder.provenance.exists():
        return []
    entries = read_json_table(folder.provenance, MAX_BYTES).get("runs")
    if not isinstance(entries, list) or not all(isinstance(each, dict) for each in entries):
        raise UserError(
            f'{folder.provenance}: is damaged: "runs" must be a list of tables; {REMEDY}'
        )
    return entries


def noted_files(folder: RunFolder) -> list[dict[str, str]]:
    """The files that the scenario of a run named; none where it does not say.

    Raises UserError for a damaged file.
    """
    entries = read_provenance(folder)
    files = entries[0].get("inputs") if entries else None
    tables = [each for each in files if isinstance(each, dict)] if isinstance(files, list) else []
    return [{key: str(each.get(key, "")) for key in ("key", "file", "digest")} for each in tables]


@cache
def commit() -> str | None:
    """The commit of the clone that this package is in, "+" after it where files were changed.

    None where it is in no clone of doseki, or git is not there.
    """
    root = Path(__file__).resolve().parents[3]
    if not ((root / ".git").exists() and (root / "core" / "run").is_dir()):
        return None
    head = _git(root, "rev-parse", "HEAD")
    changed = _git(root, "status", "--porcelain", "--untracked-files=no")
    return head + ("+" if changed else "") if head else None


def _git(root: Path, *command: str) -> str:
    """What git prints, or nothing where it fails."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    try:
        done = subprocess.run(
            ["git", "-C", str(root), *command],
            capture_output=True, text=True, timeout=GIT_SECONDS, env=environment,
        )  # fmt: skip
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


@cache
def _libraries() -> dict[str, str]:
    """Versions of the libraries that are installed."""
    found = {}
    for name in LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def _command(arguments: Sequence[str] | None = None) -> list[str]:
    """The words of the command line; of the program only its name."""
    words = list(sys.argv if arguments is None else arguments)
    return [Path(words[0]).name, *words[1:]] if words else []
