"""Figures as files: one that cannot be drawn is told, and costs nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

from ..errors import DosekiError, ResourceError, UserError, one_line
from ..util.files import clear_errors, write_whole
from .nothing import NothingToDrawError
from .text import missing_text, plain_text


@dataclass
class Drawn:
    """The pictures that were drawn, and what is to be said of those that are missing."""

    pictures: list[Path] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # of those that would be empty
    is_full: bool = False  # memory or disk ran out for one that failed
    _missing: list[str] = field(default_factory=list)  # characters that no font has

    @property
    def remarks(self) -> list[str]:
        """All that is wrong: what failed, and once for all pictures what no font has."""
        return [*self.failures, *missing_text(self._missing)]

    def check(self, message: str) -> None:
        """Raise ResourceError or UserError with a message where a picture failed."""
        if self.failures:
            raise (ResourceError if self.is_full else UserError)(message)

    def add(self, path: Path, make: Callable[[], Figure]) -> None:
        """Draw one figure into a PNG file, or say why there is none."""
        name = path.stem
        try:
            with plain_text() as missing:
                _save(make(), path)
            self._missing += missing
            self.pictures.append(path)
        except NothingToDrawError as reason:
            self.notes.append(one_line(f"figure {name} is not drawn: {reason}"))
        except Exception as error:
            # Whatever a picture stumbles over: the run, and the other pictures, do not.
            self.is_full |= isinstance(error, ResourceError | MemoryError)
            said = str(error) if isinstance(error, DosekiError) else repr(error)
            self.failures.append(one_line(f"figure {name} could not be drawn: {said}"))


def _save(figure: Figure, path: Path) -> None:
    with clear_errors(path):
        path.parent.mkdir(exist_ok=True)
    write_whole(path, lambda temporary: figure.savefig(temporary, format="png"))
