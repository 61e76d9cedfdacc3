"""What `doseki census` leaves in DIR/census: tables as CSV and HDF5, figures, a short text."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import h5py
import numpy as np
from matplotlib.figure import Figure

from ..errors import UserError
from ..measure.census.census import (
    CLASSES,
    Census,
    SpeedDraws,
    deposit_outline,
    draw_speeds,
    take_census,
)
from ..measure.grading import grading_table, gradings, has_parts
from ..measure.views import View, named_window, windows
from ..record.reader import Run, load
from ..record.units import unit_in
from ..util.files import clear_errors, write_whole, write_whole_text
from .census import (
    draw_classes,
    draw_deposit,
    draw_grading,
    draw_passed,
    draw_speed_histogram,
)
from .saving import Drawn

ORIGINS = ("structure", "load")  # of a grain: whether it is of the load
OUTLET, DEPOSIT = "outlet", "deposit"  # windows that are used by default


@dataclass(frozen=True)
class CensusOptions:
    """What of a census is asked for."""

    window: str | None = None  # of the speeds; default: "outlet" if there is one, else everywhere
    start: float = -math.inf  # s, of the speeds
    end: float = math.inf
    # m, at which passing mass is summed; default: zero, where that is in the scene
    sections: tuple[float, ...] | None = None
    sample: int = 30
    draws: int = 2000
    bin_width: float = 0.1  # m/s


def write_census(directory: str | Path, options: CensusOptions) -> list[str]:
    """Take the census of the run in `directory` into DIR/census; returns lines that tell of it.

    Raises UserError for no run, no grains, an unknown window or an empty range of time.
    """
    run = load(directory)
    if options.end < options.start:
        raise UserError(f"--to = {options.end:g} s must not be before --from = {options.start:g} s")
    census = take_census(run)
    known = windows(run)
    name = options.window or (OUTLET if OUTLET in known else None)
    view = named_window(run, name)
    rows = census.rows(view, options.start, options.end)
    speeds = np.linalg.norm(census.table["velocity"][rows], axis=1)
    drawn = draw_speeds(speeds, options.bin_width, options.sample, options.draws)
    folder = run.directory / "census"
    with clear_errors(folder):
        folder.mkdir(exist_ok=True)
    tables = {
        "grains": grain_table(census),
        "classes": class_table(census),
        "speeds": speed_table(drawn),
    }
    sections = _sections(run, census) if options.sections is None else options.sections
    if sections:
        tables["passed"] = passed_table(census, sections)
    outline = _outline(census, known)
    if outline is not None:
        tables["deposit"] = {
            "x": outline[:, 0],
            "height" if run.scenario["dim"] == 2 else "y": outline[:, 1],
        }
    breaks = has_parts(run)
    if breaks:
        tables["grading"] = grading_table(run)
    write_tables(folder, tables)
    where = f"window {name}" if name else "everywhere"
    makers = _makers(run, census, drawn, where, outline)
    if sections:
        makers["passed"] = partial(draw_passed, census, sections, run.scenario["dim"])
    if breaks:
        makers["grading"] = lambda: draw_grading(gradings(run))
    pictures = Drawn()
    for what, make in makers.items():
        pictures.add(folder / f"{what}.png", make)
    files = f"In {folder}: {', '.join(tables)} (.csv, census.h5), figures"
    lines = census_lines(census, drawn, where, sections)
    if not sections:
        low, high = _ends(run, census)
        lines.append(
            f"no passing is counted: x = 0 is not in the scene, which goes from {low:.8g} to "
            f"{high:.8g} m; say where with --section X"
        )
    return [*lines, files, *pictures.notes, *(f"warning: {text}" for text in pictures.remarks)]


def _sections(run: Run, census: Census) -> tuple[float, ...]:
    """Zero, unless nothing is there, as on a map."""
    low, high = _ends(run, census)
    return (0.0,) if low <= 0 <= high else ()


def _ends(run: Run, census: Census) -> tuple[float, float]:
    """Between which x anything was, m: particles at the start, and grains at any time."""
    x = np.concatenate([run[0]["position"][:, 0], census.table["position"][:, 0]])
    return float(x.min()), float(x.max())


def _outline(census: Census, known: Mapping[str, View]) -> np.ndarray | None:
    return deposit_outline(census, known[DEPOSIT]) if DEPOSIT in known else None


def grain_table(census: Census) -> dict[str, np.ndarray]:
    """One row for each grain and time, one column for each component."""
    table = census.table
    columns = {"time": table["time"], "grain": table["id"]}
    for name in ("position", "velocity"):
        letter = {"position": "", "velocity": "v"}[name]
        axes = "xyz"[: table[name].shape[1]]
        columns |= {f"{letter}{axis}": table[name][:, k] for k, axis in enumerate(axes)}
    columns |= {f"spin_{axis}": table["spin"][:, k] for k, axis in enumerate("xyz")}
    columns |= {name: table[name] for name in ("contacts", "diameter", "mass")}
    columns["class"] = np.array(CLASSES)[table["kind"]]
    return columns | {"origin": np.array(ORIGINS)[table["is_load"].astype(int)]}


def class_table(census: Census) -> dict[str, np.ndarray]:
    """Mass of each class, that off structures, position of the water front over time."""
    masses = {name: census.mass_of(kind) for kind, name in enumerate(CLASSES)}
    return {"time": census.times, "front": census.front} | masses | _off_structures(census)


def _off_structures(census: Census) -> dict[str, np.ndarray]:
    return {"off_structures": census.off_structures} if census.off_structures[-1] else {}


def speed_table(drawn: SpeedDraws) -> dict[str, np.ndarray]:
    """The histogram: all grains, and mean and quantiles of samples, per bin."""
    edges = {"from": drawn.edges[:-1], "to": drawn.edges[1:]}
    return edges | {"all": drawn.counts, "mean": drawn.mean, "low": drawn.low, "high": drawn.high}


def passed_table(census: Census, sections: Sequence[float]) -> dict[str, np.ndarray]:
    """Mass that has crossed each section, over time."""
    passed = {f"x = {section:.12g}": census.passed(section) for section in sections}
    for section in sections if census.off_structures[-1] else ():
        passed[f"x = {section:.12g} off structures"] = census.passed(section, load=False)
    return {"time": census.times} | passed


def write_tables(folder: Path, tables: Mapping[str, Mapping[str, np.ndarray]]) -> None:
    """Each table as NAME.csv, and all as groups of census.h5; raises ResourceError, UserError."""
    image = io.BytesIO()
    with h5py.File(image, "w") as file:
        for name, table in tables.items():
            group = file.create_group(name)
            for column, values in table.items():
                stored = values.astype("S") if values.dtype.kind == "U" else values
                group.create_dataset(
                    column, data=stored, compression="gzip" if len(values) else None
                )
            write_whole_text(folder / f"{name}.csv", _csv(table))
    write_whole(folder / "census.h5", lambda path: path.write_bytes(image.getbuffer()))


def _csv(table: Mapping[str, np.ndarray]) -> str:
    """All digits: seven are a metre on a map."""
    texts = [
        np.array([repr(float(value)) for value in values])
        if values.dtype.kind == "f"
        else values.astype(str)
        for values in table.values()
    ]
    lines = [",".join(table), *(",".join(row) for row in zip(*texts, strict=True))]
    return "\n".join(lines) + "\n"


def _makers(
    run: Run, census: Census, drawn: SpeedDraws, where: str, outline: np.ndarray | None
) -> dict[str, Callable[[], Figure]]:
    """What draws each figure that every census may have."""
    makers: dict[str, Callable[[], Figure]] = {
        "classes": partial(draw_classes, census),
        "speeds": partial(draw_speed_histogram, drawn, where),
    }
    if outline is not None and len(outline):
        makers["deposit"] = partial(draw_deposit, outline, run.scenario["dim"])
    return makers


def census_lines(
    census: Census, drawn: SpeedDraws, where: str, sections: Sequence[float]
) -> list[str]:
    """The census in a few lines."""
    lines = [f"{_counted(census)} at {len(census.times)} times", _most_at_once(census)]
    if census.off_structures[-1]:
        lines.append(_came_off(census))
    if len(drawn.speeds):
        lines.append(
            f"{where}: {len(drawn.speeds)} speeds, mean {drawn.speeds.mean():.3g} m/s; samples of "
            f"{drawn.size}: {drawn.sample_means.mean():.3g} +- {drawn.sample_means.std():.2g} m/s"
        )
    else:
        lines.append(f"{where}: no grain in this range of time")
    way = {-1: "towards -x", 0: "either way", 1: "towards +x"}[census.direction]
    for section in sections:
        told = _passed(census, section)
        lines.append(f"passed x = {section:.12g} m {way} at the end: {told}")
    return lines


def _most_at_once(census: Census) -> str:
    """The largest share of each class, if there is a load."""
    if not census.load_mass:
        return "no load: nothing was loose at the start, so classes have no shares"
    shares = census_shares(census)
    greatest = ", ".join(f"{name} {_percent(share.max())}" for name, share in shares.items())
    return f"most of the load at once: {greatest}"


def _came_off(census: Census) -> str:
    """What structures have lost."""
    there = int((census.last() & ~census.table["is_load"]).sum())
    return (
        f"{_mass(census, census.off_structures[-1])} came off structures and is not of the load: "
        f"{_parts(there)} at the last time"
    )


def _passed(census: Census, section: float) -> str:
    """How much has passed a section: of the load, and of what came off structures."""
    said = []
    if census.load_mass:
        count = census.passed_count(section)
        share = _percent(float(census.share(census.passed(section)[-1])))
        said.append(f"{count} grain{'' if count == 1 else 's'}, {share} of the load")
    if census.off_structures[-1]:
        count = census.passed_count(section, load=False)
        mass = _mass(census, census.passed(section, load=False)[-1])
        said.append(f"{_parts(count)} of structures, {mass}")
    return "; ".join(said)


def _mass(census: Census, mass: float) -> str:
    return f"{mass:.4g} {unit_in('kg', census.table['position'].shape[1])}"


def _parts(count: int) -> str:
    return f"{count} part{'' if count == 1 else 's'}"


def _counted(census: Census) -> str:
    """How many grains there are, at the first and at the last of several times."""
    first, last = (np.sum(census.table["time"] == time) for time in census.times[[0, -1]])
    if len(np.unique(census.table["id"])) == first == last:
        return f"{last} grain{'' if last == 1 else 's'}"
    return f"{first} grain{'' if first == 1 else 's'} at first and {last} at last,"


def _percent(share: float) -> str:
    """Three digits, so that 0 % is nothing at all."""
    return f"{100 * share:.3g} %"


def census_shares(census: Census) -> dict[str, np.ndarray]:
    """Share (T,) of the load in each class over time."""
    return {name: census.share(census.mass_of(kind)) for kind, name in enumerate(CLASSES)}
