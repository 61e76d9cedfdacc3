"""Whatever a checkpoint holds: the run goes on from it, or it is refused in one sentence."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.run.channel import environment

from .examples import FREE

ROOT = Path(__file__).parents[2]


def mutate(count: int, log: Path, program: tuple[str, ...] = (), **variables: str) -> dict:
    """What came of so many mutations (see checkpoint_mutations); none may end the process."""
    done = subprocess.run(
        [sys.executable, *program, "-m", "tests.fuzz.checkpoint_mutations", str(count), log],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env=environment() | {"OMP_NUM_THREADS": "1"} | variables,
    )
    last = log.read_text() if log.exists() else "before the first"
    assert done.returncode == 0, f"{done.returncode} after {last}: {done.stderr[-3000:]}"
    return json.loads(done.stdout.splitlines()[-1])


def test_any_checkpoint(tmp_path):
    counts = mutate(2000 if FREE else 60, tmp_path / "last")
    assert counts["refused"] > sum(counts.values()) / 2
    assert counts["went on"] > 0
