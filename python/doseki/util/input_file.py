"""A file that a scenario names, known by its digest."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError
from .foreign import open_regular

DIGEST_BYTES = 16
DIGEST = re.compile(rf"[0-9a-f]{{{2 * DIGEST_BYTES}}}")
CHUNK = 2**20  # bytes


def digest_of(path: Path) -> str:
    """BLAKE2b digest of an ordinary file, in hexadecimal digits; raises UserError for others."""
    digest = hashlib.blake2b(digest_size=DIGEST_BYTES)
    with open_regular(path) as (file, size):
        for start in range(0, size, CHUNK):
            digest.update(file.read(min(CHUNK, size - start)))
    return digest.hexdigest()


def input_file(path: Path) -> InputFile:
    """A file with its content as it is now; raises UserError for one that cannot be read."""
    return InputFile(path.resolve(), digest_of(path))


@dataclass(frozen=True)
class InputFile:
    """Where a file is, and what its content was when it was looked at."""

    path: Path
    digest: str

    @property
    def name(self) -> str:
        """Its name in the folder of a run: files of different content have different ones."""
        stem = re.sub(r"[^\w.-]", "_", self.path.stem).removesuffix(f"-{self.digest}")
        return f"{stem[:40]}-{self.digest}{self.path.suffix[:10]}"

    def copy_to(self, path: Path) -> None:
        """Copy it; raises UserError where its content is another by now."""
        digest = hashlib.blake2b(digest_size=DIGEST_BYTES)
        with open_regular(self.path) as (file, size), path.open("wb") as copy:
            for start in range(0, size, CHUNK):
                chunk = file.read(min(CHUNK, size - start))
                digest.update(chunk)
                copy.write(chunk)
        if digest.hexdigest() != self.digest:
            raise UserError(f"{self.path}: has changed since it was read; start again")
