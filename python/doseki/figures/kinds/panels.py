"""What pictures of particles show, and how."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...measure.views import View

SIZES = {"grain": "to scale", "support": "circles of radius H h"}


@dataclass(frozen=True)
class Panels:
    """What is drawn: quantities as colours, and circles by `sizes` (see dots.dots)."""

    view: View
    colours: Sequence[str]
    title: str = ""
    sizes: Sequence[str] = ("grain",)
    material: str | None = None

    def panel_title(self, time: str, size: str) -> str:
        """The time, and how the particles are drawn where there is a choice."""
        return f"{time}, {SIZES[size]}" if len(self.sizes) > 1 else time
