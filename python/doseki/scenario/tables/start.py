"""[start]: the run that another one goes on from."""

from __future__ import annotations

from pydantic import ConfigDict, Field, model_validator

from ..table import Table
from ..values.types import Digest, NonNegative

MOST_FILES = 3  # scenario, snapshot, checkpoint


class Start(Table):
    """Where a run begins, if not with its bodies as they are given."""

    model_config = ConfigDict(populate_by_name=True)

    folder: str | list[str] = Field(
        alias="from",
        description="folder of a run, relative to this scenario file; or the files of one: its "
        "scenario, a snapshot and, where there is one, the checkpoint of the same step",
    )
    time: NonNegative | None = Field(
        None, description="of the snapshot, s, at which the clock goes on; default: the last one"
    )
    without: list[str] = Field(
        default_factory=list, description="bodies and inflows of that run that are left out"
    )
    digests: list[Digest] | None = Field(
        None, description="BLAKE2b of the files; other ones are refused"
    )

    @model_validator(mode="after")
    def _files(self) -> Start:
        if isinstance(self.folder, str):
            if self.digests is not None:
                raise ValueError("digests goes with the names of files in from")
            return self
        if not 2 <= len(self.folder) <= MOST_FILES:
            raise ValueError(
                "from is the folder of a run, or a list of its scenario, a snapshot and, where "
                "there is one, a checkpoint"
            )
        if self.digests is not None and len(self.digests) != len(self.folder):
            raise ValueError("give as many digests as files in from")
        return self
