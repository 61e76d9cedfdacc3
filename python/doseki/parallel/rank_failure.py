"""The report of a run that ended because one of its ranks did."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path

from ..record.folder import RunFolder

KIND = "rank"


@dataclass
class RankFailure:
    """Which rank failed (-1: not known) and why; `time` in s and `step` are None if not known."""

    rank: int
    message: str
    time: float | None = None
    step: int | None = None

    @property
    def who(self) -> str:
        """The rank, in words."""
        return f"Rank {self.rank}" if self.rank >= 0 else "A rank"

    @property
    def advice(self) -> str:
        """What to do."""
        return "Go on from the last checkpoint, on as many ranks as there are: doseki resume."

    def write(self, directory: Path) -> bool:
        """Write failure.json, unless another rank has done so; false then."""
        report = {"kind": KIND, "advice": self.advice, "who": self.who} | asdict(self)
        try:
            file = os.open(
                RunFolder(directory).failure, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666
            )
        except OSError:
            return False
        with os.fdopen(file, "w", encoding="utf-8") as stream:
            stream.write(json.dumps(report, indent=1) + "\n")
        return True
