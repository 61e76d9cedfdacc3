"""`doseki export DIR --paraview`: a folder with a state of ParaView and what it shows."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import UserError
from ...figures.colouring import limits
from ...figures.dots import ends_of_most
from ...measure.numbers import speed
from ...measure.views import fluid_names
from ...record.reader import Run, Snapshot
from ...scenario.load import load_scenario
from ...scenario.model import Scenario
from ...scenario.values.directions import upwards
from ...util.files import write_whole, write_whole_text
from ..folder import pvd, whole_folder
from ..polydata import PolyData
from .gauges import gauge_marks
from .grains import grain_points, grain_polygons, grain_shapes
from .structures import Structures, ground_surface

STATE = "state.py"
SAMPLES = 8  # snapshots that say how fast and how large things are
MOST_LABELS = 60  # of gauges: more are not read


def export_paraview(run: Run, out: Path | None = None) -> list[str]:
    """Write bodies, structures, the ground and gauges as VTP, and a state; lines that say what.

    They go to `out` (default: DIR/paraview), which must not exist or be empty. Particles are not
    copied: the state opens the snapshots of the run, and its surfaces where they were exported.
    Paths in it are relative.

    Raises:
        UserError: the run has no snapshot, or its scenario cannot be read any more.

    """
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot yet")
    folder = out if out is not None else run.directory / "paraview"
    scenario = load_scenario(run.folder.scenario)
    with whole_folder(folder) as unfinished:
        writer = _Writer(run, scenario, unfinished)
        writer.grains()
        writer.structures()
        writer.finish(os.path.relpath(run.directory.resolve(), folder.resolve()))
    return [f"{folder / STATE}: open it in ParaView (File, Load State)", *writer.notes]


class _Writer:
    """Writes the parts of the folder, one after the other, and remembers what there is."""

    def __init__(self, run: Run, scenario: Scenario, folder: Path) -> None:
        self._run, self._scenario, self._folder = run, scenario, folder
        self._scene: dict[str, Any] = {}
        self.notes: list[str] = []

    def grains(self) -> None:
        """Bodies that move."""
        if "body" not in self._run[0].grains:
            return
        known, unknown = grain_shapes(self._scenario, self._run[0])
        if unknown:
            self.notes.append(
                f"shapes of {', '.join(unknown)} are not known: balls of their diameter are shown"
            )
        self._series("grains", lambda snapshot: grain_points(snapshot, known))
        if known.has_others:
            self._series("shapes", lambda snapshot: grain_polygons(snapshot, known))

    def structures(self) -> None:
        """Fixed bodies, the ground, and gauges."""
        structures = Structures(self._scenario)
        if structures.names and structures.move:
            self._series("structures", lambda snapshot: structures.at(snapshot.time))
        elif structures.names:
            self._one("structures", structures.at(0.0))
        ground = self._run.ground
        if ground is not None:
            self._one("ground", ground_surface(ground))
        marks, nowhere = gauge_marks(self._scenario, ground, structures.top)
        if marks.points:
            self._one("gauges", marks.polydata())
        if nowhere:
            self.notes.append(f"gauges without a place are not shown: {', '.join(nowhere)}")
        if len(marks.labels) > MOST_LABELS:
            self.notes.append(f"names are shown of {MOST_LABELS} of {len(marks.labels)} gauges")
        self._scene["labels"] = dict(list(marks.labels.items())[:MOST_LABELS])

    def finish(self, run: str) -> None:
        """The table of the scene and the state that reads it; `run` is the way to the run."""
        scenario, first = self._scenario, self._run[0]
        fluids = fluid_names(self._run)
        up = upwards(np.asarray(scenario.gravity))
        self._scene |= {
            "title": scenario.title,
            "run": Path(run).as_posix(),
            "dim": scenario.dim,
            "spacing": scenario.dp,
            "up": [*up.tolist(), *[0.0] * (3 - scenario.dim)],
            "fluids": {n: k for k, n in enumerate(first.material_names) if n in fluids},
            **self._measured(),
        }
        text = json.dumps(self._scene, indent=1, allow_nan=False)
        write_whole_text(self._folder / "scene.json", text + "\n")
        source = Path(__file__).with_name(STATE)
        write_whole(self._folder / STATE, lambda part: shutil.copyfile(source, part))

    def _measured(self) -> dict[str, Any]:
        """The highest speed of most of what moves, m/s, and the box that it keeps to, m."""
        step = max(1, len(self._run) // SAMPLES)
        speeds, ends = [np.zeros(1)], []
        for snapshot in (*self._run[::step], self._run[-1]):
            place, moves = snapshot["position"], ~snapshot["fixed"]
            finite = np.isfinite(place).all(axis=1)
            shown = finite & moves if (finite & moves).any() else finite
            if shown.any():
                ends.append(ends_of_most(place[shown]))
            speeds.append(speed(snapshot["velocity"])[finite & moves])
        low = np.min([e[0] for e in ends], axis=0) if ends else np.zeros(self._scenario.dim)
        high = np.max([e[1] for e in ends], axis=0) if ends else np.ones(self._scenario.dim)
        rest = [0.0] * (3 - self._scenario.dim)
        fastest = float(limits(np.concatenate(speeds))[1])
        return {
            "speed": fastest if fastest > 0 else 1.0,
            "low": [*low.tolist(), *rest],
            "high": [*high.tolist(), *rest],
        }

    def _series(self, name: str, make: Callable[[Snapshot], PolyData]) -> None:
        """A file for each snapshot, and their index."""
        (self._folder / name).mkdir()
        entries = []
        for snapshot in self._run:
            file = self._folder / name / f"{snapshot.path.stem}.vtp"
            write_whole(file, make(snapshot).write)
            entries.append((snapshot.time, f"{name}/{file.name}"))
        write_whole_text(self._folder / f"{name}.pvd", pvd(entries))
        self._scene[name] = f"{name}.pvd"

    def _one(self, name: str, data: PolyData) -> None:
        write_whole(self._folder / f"{name}.vtp", data.write)
        self._scene[name] = f"{name}.vtp"
