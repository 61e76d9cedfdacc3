"""Gauges of fixed bodies whose forces the core sums in every step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

import numpy as np

from ...schemes import UETA2022
from ...values.types import BodyNames
from ..gauge import Gauge, Setting

Row = Mapping[str, np.ndarray]  # what one meter has summed, by the keys of solver.protocol.Loads


class Metered(Gauge):
    """One that reads a load meter of the core."""

    has_meter: ClassVar[bool] = True

    bodies: BodyNames

    def objections(self, setting: Setting) -> Iterator[tuple[str, str]]:
        """Its bodies must be fixed, and the scheme must know forces on walls."""
        for name in self.bodies:
            if not setting.fixed[name]:
                yield "bodies", f': "{name}" is not a fixed body'
        if setting.scheme == UETA2022:
            yield (
                "kind",
                f' = "{self.kind}" needs scheme = "resolved"; {setting.scheme} has no force on'
                " walls",
            )

    def meter(self, setting: Setting) -> dict[str, object]:
        """The table of the core's add_load_meter; its body names are those of the run."""
        return {
            "bodies": [setting.body_names.index(name) for name in setting.bodies_of(self.bodies)],
            "about": [0.0] * setting.dim,
        }
