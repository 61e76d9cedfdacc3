"""The interactive view of a run: what browser/viewer.js reads."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...errors import UserError
from ...measure.census.grains import keep_their_shape
from ...record.reader import Run, Snapshot
from ...util.finding import percent
from .box import Box, box_of
from .colours import Field, fields_of, scale
from .particles import Block, ParticlePacker
from .rigid import RigidShapes, rigid_shapes
from .terrain import Grid
from .thinning import Thinning, spread, thinned

SAMPLES = 6  # snapshots that limits and sizes are taken from
TESTED = 3  # snapshots that are packed to see what they take
TRIES = 3  # where the snapshots that were packed take less than the others
FRAME = 300  # bytes that the page takes for a frame beside its numbers
WALLS = 0.2  # of the room, for what does not move
SHORT = 0.1  # s: of shorter runs times are in ms, as in figures
TERRAIN_BODY = "terrain"  # the body that stands for the terrain in a record
KEYS = ("position", "velocity", "mass", "density", "pressure", "material", "body", "motion", "id",
        "grain")  # fmt: skip


@dataclass
class Scene:
    """What the page holds of a view: a table, and blocks of numbers by their names."""

    table: dict[str, Any]
    blocks: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # what was left out
    not_finite: dict[str, int] = field(default_factory=dict)  # positions of what moves, by snapshot

    def add(self, name: str, block: Block) -> dict[str, Any]:
        """Keep a block; what the table says of it."""
        self.blocks[name] = block.text
        return {"id": name, "count": block.count}

    def table_text(self) -> str:
        """The table as JSON that may stand in a page."""
        return json.dumps(self.table, allow_nan=False).replace("<", "\\u003c")


class SceneMaker:
    """Packs the snapshots of a run."""

    def __init__(self, run: Run, terrain: Grid | None) -> None:
        self.run, self.terrain = run, terrain
        samples = [run[k] for k in spread(min(SAMPLES, len(run)), len(run))]
        for snapshot in samples:
            snapshot.prefetch(KEYS)
        self.box: Box = box_of(run, terrain.corners if terrain else [])
        self.fields: list[Field] = fields_of(run, samples)
        self.packer = ParticlePacker(run, self.box, self.fields, samples)
        self.shapes: RigidShapes | None = rigid_shapes(run, run[0])
        self.flow_name = self._flow_name(samples)
        self.walls_go = any(
            bool(np.any(snapshot["velocity"][snapshot["fixed"]])) for snapshot in samples
        )

    def _flow_name(self, samples: Sequence[Snapshot]) -> str:
        """What moves as particles, in words; empty where nothing does."""
        flows = deforms = False
        for snapshot in samples:
            moves = ~snapshot["fixed"] & ~self._as_shapes(snapshot)
            keeps_shape = np.append(keep_their_shape(self.run, snapshot), True)
            is_flow = keeps_shape[snapshot["grain"]]  # grain -1: of no body
            flows |= bool(np.any(moves & is_flow))
            deforms |= bool(np.any(moves & ~is_flow))
        return " and ".join(["flow"] * flows + ["deformable bodies"] * deforms)

    def _as_shapes(self, snapshot: Snapshot) -> np.ndarray:
        """Mask (N,) of the particles of bodies that are drawn as shapes."""
        none = np.zeros(len(snapshot["id"]), bool)
        return self.shapes.of_bodies(snapshot) if self.shapes else none

    def flow(self, snapshot: Snapshot, thinning: Thinning) -> Block:
        """What moves, but for bodies that are drawn as shapes."""
        return self.packer.flow(snapshot, thinning, self._as_shapes(snapshot))

    def walls(self, snapshot: Snapshot, thinning: Thinning) -> Block:
        """What does not move, but for the terrain where it is drawn as a surface."""
        of_terrain = np.zeros(len(snapshot["id"]), bool)
        if self.terrain is not None and TERRAIN_BODY in snapshot.body_names:
            index = snapshot.body_names.index(TERRAIN_BODY)
            of_terrain = snapshot.stored("body") == index
        return self.packer.walls(snapshot, thinning, of_terrain)

    def bodies(self, snapshot: Snapshot) -> Block | None:
        """Where the bodies are that are drawn as shapes; None without any."""
        return self.shapes.block(snapshot, self.box, self.fields) if self.shapes else None

    def snapshot(self, index: int) -> Snapshot:
        """A snapshot with all that is drawn of it read."""
        found = self.run[index]
        found.prefetch(KEYS)
        return found

    def choose(self, most: float) -> Thinning:
        """What of the flow is drawn, in `most` bytes."""
        indices = spread(min(TESTED, len(self.run)), len(self.run))

        def cost(thinning: Thinning) -> tuple[float, int]:
            snapshots = [self.snapshot(k) for k in indices]
            flows = [self.flow(snapshot, thinning) for snapshot in snapshots]
            bodies = [self.bodies(snapshot) for snapshot in snapshots]
            texts = [block.text for block in [*flows, *bodies] if block is not None]
            bytes_each = FRAME + sum(map(len, texts)) / len(snapshots)
            return bytes_each, max(block.count for block in flows)

        return thinned(len(self.run), self.box.dim == 3, most, cost)

    def choose_walls(self, most: float, frames: int) -> Thinning:
        """What of the walls is drawn, in `most` bytes."""
        first = self.snapshot(0)
        count = frames if self.walls_go else 1

        def cost(thinning: Thinning) -> tuple[float, int]:
            block = self.walls(first, thinning)
            return len(block.text) * count / thinning.frames, block.count

        return thinned(1, self.box.dim == 3, most, cost)


def make_scene(run: Run, most: float, terrain: Grid | None = None) -> Scene:
    """The view of a run in at most `most` bytes (a little more where that is hardly anything).

    Raises UserError for a run without any particle.
    """
    if not len(run):
        raise UserError(f"{run.directory}: the run has no snapshot to show")
    maker = SceneMaker(run, terrain)
    scene = Scene(_table(maker))
    if terrain is not None and terrain.corners:
        scene.blocks["terrain"] = terrain.text()
        scene.table["terrain"] = terrain.as_json(maker.box, "terrain")
        most -= len(scene.blocks["terrain"])
    if maker.shapes is not None:
        scene.table["bodies"] = maker.shapes.as_json(maker.fields)
        most -= len(json.dumps(scene.table["bodies"]))
    walls = maker.choose_walls(WALLS * most, len(run))
    most -= _add_walls(maker, scene, walls)
    thinning = maker.choose(most)
    blocks = _add_frames(maker, scene, thinning, walls)
    for _ in range(TRIES):
        used = sum(FRAME + len(block.text) for block in blocks) + _bytes_of_bodies(scene)
        if used <= most:
            break
        thinning = replace(thinning, share=0.97 * thinning.share * most / used)
        blocks = _add_frames(maker, scene, thinning, walls)
    scene.notes = _left_out(run, thinning, blocks, walls, scene.not_finite)
    return scene


def _table(maker: SceneMaker) -> dict[str, Any]:
    """What the page says of the view at the start."""
    box, scenario = maker.box, maker.run.scenario
    up = np.zeros(3)
    up[: box.dim] = -np.array(scenario.get("gravity", np.zeros(box.dim)))
    if not up.any():
        up[box.dim - 1] = 1.0
    times = maker.run.times
    return {
        "dim": box.dim,
        "corner": box.corner.tolist(),
        "size": box.size.tolist(),
        "flowBox": [end.tolist() for end in box.flow],
        "focus": [end.tolist() for end in box.focus],
        "up": up.tolist(),
        "axes": list("xyz"[: box.dim]),
        "flow": maker.flow_name,
        "clock": _clock(times),
        "start": 0,
        "radius": maker.packer.largest,
        "scale": scale(),
        "fields": [each.as_json() for each in maker.fields],
    }


def _clock(times: np.ndarray) -> dict[str, Any]:
    """How times, s, are written: in ms where all are short, with digits that tell them apart."""
    unit, factor = ("ms", 1e3) if times[-1] < SHORT else ("s", 1.0)
    shown = factor * times
    apart = float(np.median(np.diff(shown))) if len(times) > 1 else 1.0
    close = (n for n in range(9) if np.all(np.abs(np.round(shown, n) - shown) < 0.01 * apart))
    return {"unit": unit, "factor": factor, "digits": next(close, 9)}


def _liveliest(run: Run, times: Sequence[float]) -> int:
    """The index of the moment with the most kinetic energy: with it the view begins."""
    history = run.history
    if "kinetic_energy" not in history or not len(history["time"]):
        return 0
    energy = np.interp(times, history["time"], history["kinetic_energy"])
    return int(np.argmax(np.nan_to_num(energy)))


def _add_walls(maker: SceneMaker, scene: Scene, walls: Thinning) -> int:
    """Walls that stay where they are; returns the bytes that all walls take."""
    first = maker.walls(maker.snapshot(0), walls)
    if not first.count:
        return 0
    if maker.walls_go:
        scene.table["walls"] = {"count": 0}
        return len(first.text) * len(maker.run)
    scene.table["walls"] = scene.add("walls", first)
    return len(first.text)


def _add_frames(
    maker: SceneMaker, scene: Scene, thinning: Thinning, walls: Thinning
) -> list[Block]:
    """All snapshots that are shown; returns their blocks of what moves."""
    blocks = []
    scene.table["frames"] = []
    scene.table["swell"] = thinning.swell
    scene.table["wallSwell"] = walls.swell
    for number, index in enumerate(spread(thinning.frames, len(maker.run))):
        snapshot = maker.snapshot(index)
        lost = ~np.isfinite(snapshot["position"]).all(axis=1) & ~snapshot["fixed"]
        if lost.any():
            scene.not_finite[snapshot.path.name] = int(lost.sum())
        blocks.append(maker.flow(snapshot, thinning))
        frame = {"time": snapshot.time, "flow": scene.add(f"flow{number}", blocks[-1])}
        if maker.walls_go and "walls" in scene.table:
            frame["walls"] = scene.add(f"walls{number}", maker.walls(snapshot, walls))
        if (bodies := maker.bodies(snapshot)) is not None:
            frame["bodies"] = scene.add(f"bodies{number}", bodies)
        scene.table["frames"].append(frame)
    times = [frame["time"] for frame in scene.table["frames"]]
    scene.table["start"] = _liveliest(maker.run, times)
    return blocks


def _bytes_of_bodies(scene: Scene) -> int:
    return sum(len(text) for name, text in scene.blocks.items() if name.startswith("bodies"))


def _left_out(
    run: Run,
    thinning: Thinning,
    blocks: Sequence[Block],
    walls: Thinning,
    not_finite: Mapping[str, int],
) -> list[str]:
    """What the view leaves out, in sentences."""
    notes = [
        f"{file}: {count} position{'s are' if count > 1 else ' is'} not finite: the snapshot is "
        "damaged; what is there is left out."
        for file, count in not_finite.items()
    ]
    if thinning.frames < len(run):
        notes.append(f"{thinning.frames} of {len(run)} snapshots are shown.")
    shown = sum(block.count for block in blocks)
    there = sum(block.of for block in blocks) - sum(not_finite.values())
    if thinning.shell or thinning.share < 1:
        share = f"{100 * shown / max(1, there):.3g} % of the particles that move are shown"
        hidden = "those inside, which no one sees, are left out" if thinning.shell else ""
        lots = f"a random {percent(thinning.share)} are kept" if thinning.share < 1 else ""
        notes.append(f"{share}: {' and of the others '.join(filter(None, (hidden, lots)))}.")
    elif shown < there:
        notes.append(f"{there - shown} particles far from all others are left out (all snapshots).")
    if walls.shell or walls.share < 1:
        notes.append("Of what does not move, not all particles are shown.")
    return notes
