"""Runs the scenario of a page and makes its pictures, its film and its numbers."""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from PIL import Image, ImageSequence

from doseki.assess.trust.report import trust_lines
from doseki.assess.trust.verdicts import BAD, DOUBTFUL
from doseki.figures.layout import chart_grid
from doseki.figures.movie import make_movie
from doseki.figures.plot import draw_run
from doseki.record.folder import RunFolder
from doseki.record.reader import Run, load
from doseki.running.provenance import read_provenance
from doseki.running.runner import RunOptions, run_scenario
from doseki.scenario.load import load_scenario

from .page import Chart, Page
from .sources import digest

# What a page may hold; all pages together stay within 6 MB.
PICTURE_BYTES, FILM_BYTES, THUMBNAIL_BYTES = 120_000, 330_000, 20_000
THUMBNAIL_WIDTH = 280  # pixels
# From good to small: width in pixels and number of colours; of a film its quality of 100, every how
# many frames, and size.
PICTURES = [(width, colours) for width in (1000, 850, 700) for colours in (64, 24)]
FILMS = [(40, 1, 1.0), (20, 2, 1.0), (20, 2, 0.75), (15, 3, 0.75)]
COST = "cost.json"  # in the folder of a run


class GalleryError(Exception):
    """A page that cannot be made, in one sentence."""


def recorded(page: Page, folder: Path, settings: Sequence[str] = ()) -> Run:
    """The run of a page in `folder`: the one that is there, if it was made of the same text.

    `settings` come after those of the page.
    """
    settings = (*page.settings, *settings)
    known = digest(page.scenario, settings)
    cost = folder / COST
    if cost.exists() and json.loads(cost.read_text(encoding="utf-8"))["digest"] == known:
        return load(folder)
    scenario = load_scenario(page.scenario, settings)
    load_before, busy = os.getloadavg()[0], time.process_time()
    summary = run_scenario(scenario, folder, RunOptions(threads=1, overwrite=True))
    entry = {
        "digest": known,
        "status": summary["status"],
        "processor_seconds": time.process_time() - busy,
        "wall_seconds": summary["wall_seconds"],
        "load": (load_before + os.getloadavg()[0]) / 2,
    }
    cost.write_text(json.dumps(entry, indent=1) + "\n", encoding="utf-8")
    return load(folder)


def entry_of(page: Page, run: Run) -> dict[str, Any]:
    """What is kept of a run for its page: where it comes from, what it cost, its numbers."""
    cost = json.loads((Path(run.directory) / COST).read_text(encoding="utf-8"))
    if cost["status"] != "done":
        raise GalleryError(f"{page.scenario}: the run has ended as {cost['status']!r}")
    made = read_provenance(RunFolder(Path(run.directory)))[0]
    numbers = page.numbers(run)
    bad = [each.what for each in numbers if not math.isfinite(each.value)]
    if bad:
        raise GalleryError(f"{page.scenario}: not a number: {', '.join(bad)}")
    return {
        "digest": cost["digest"],
        "settings": list(page.settings),
        "title": run.scenario["title"],
        "description": " ".join(run.scenario["description"].split()),
        "dim": run.scenario["dim"],
        "scheme": run.scenario["scheme"],
        "dp": run.scenario["dp"],
        "time": float(run.times[-1]),
        "particles": max(int(n) for n in run.history["n_particles"]),
        "steps": int(run.summary["step"]),
        "wall_seconds": round(cost["wall_seconds"], 1),
        "processor_seconds": round(cost["processor_seconds"], 1),
        "load": round(cost["load"], 1),
        "processor": made["processor"],
        "cores": made["cores"],
        "doubts": [line for line in trust_lines(run.trust) if line[0] in (BAD, DOUBTFUL)],
        "numbers": [vars(each) for each in numbers],
    }


def make_pictures(page: Page, run: Run, folder: Path) -> list[str]:
    """Write the pictures, the film and the thumbnail of a page into `folder`; their names.

    Raises GalleryError where one is missing or larger than a page may hold.
    """
    folder.mkdir(parents=True, exist_ok=True)
    name = page.scenario
    drawn = {path.stem: path for path in Path(run.directory).glob("*/*.png")}
    if not set(page.figures) <= set(drawn):
        drawn = {path.stem: path for path in draw_run(run.directory).pictures}
    missing = [figure for figure in page.figures if figure not in drawn]
    if missing:
        raise GalleryError(f"{name}: the run has no figure {missing[0]!r}, it has {sorted(drawn)}")
    made = [folder / f"{name}-{figure}.png" for figure in page.figures]
    for path, figure in zip(made, page.figures, strict=True):
        _shrink(drawn[figure], path)
    if page.chart is not None:
        made.append(folder / f"{name}-chart.png")
        whole = folder / f"{name}-whole.png"
        draw_chart(page.chart(run)).savefig(whole)
        _shrink(whole, made[-1])
        whole.unlink()
    film, thumbnail = folder / f"{name}.webp", folder / f"{name}-small.webp"
    film.unlink(missing_ok=True)
    shown = page.film
    if shown is None:
        _thumbnail(made[0], thumbnail)
        return [path.name for path in made]
    make_movie(run, film, shown.colour, shown.window, shown.frames_per_second, shown.width)
    _fit_film(film, shown.frames_per_second)
    _thumbnail(film, thumbnail)
    return [path.name for path in made]


def draw_chart(chart: Chart) -> Figure:
    """A chart of curves, and dots for measurements."""
    figure, grid = chart_grid(1, 1, (6.0, 3.2), chart.title)
    axes = grid[0, 0]
    for line in chart.lines:
        style = "ko" if line.points else "-"
        axes.plot(line.x, line.y, style, label=line.label, markersize=3, linewidth=1.4)
    axes.set(xlabel=chart.axes[0], ylabel=chart.axes[1])
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small", frameon=False)
    return figure


def _shrink(source: Path, target: Path) -> None:
    """A picture as a page shows it: as wide and of as many colours as it may."""
    with Image.open(source) as whole:
        picture = whole.convert("RGB")
    for width, colours in PICTURES:
        size = (width, round(picture.height * width / picture.width))
        small = picture if width > picture.width else picture.resize(size, Image.Resampling.LANCZOS)
        small.quantize(colours, dither=Image.Dither.NONE).save(target, optimize=True)
        if target.stat().st_size <= PICTURE_BYTES:
            return
    _bounded(target, PICTURE_BYTES)


def _fit_film(film: Path, frames_per_second: int) -> None:
    """Write a film again that is too large for a page: of lower quality, then with fewer frames."""
    with Image.open(film) as source:
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(source)]
    for quality, every, scale in FILMS:
        if film.stat().st_size <= FILM_BYTES:
            return
        size = (round(scale * frames[0].width), round(scale * frames[0].height))
        shown = [frame.resize(size, Image.Resampling.LANCZOS) for frame in frames[::every]]
        shown[0].save(
            film, format="WEBP", save_all=True, append_images=shown[1:], loop=0,
            quality=quality, duration=round(1000 * every / frames_per_second), method=2,
        )  # fmt: skip
    _bounded(film, FILM_BYTES)


def _thumbnail(shown: Path, target: Path) -> None:
    """A picture, or of a film the frame two fifths into it."""
    with Image.open(shown) as frames:
        frames.seek(2 * getattr(frames, "n_frames", 1) // 5)
        picture = frames.convert("RGB")
    height = round(picture.height * THUMBNAIL_WIDTH / picture.width)
    small = picture.resize((THUMBNAIL_WIDTH, height), Image.Resampling.LANCZOS)
    small.save(target, quality=70)
    _bounded(target, THUMBNAIL_BYTES)


def _bounded(path: Path, limit: int) -> None:
    if path.stat().st_size > limit:
        size = path.stat().st_size
        raise GalleryError(f"{path.name}: {size} bytes, at most {limit}: show less, or smaller")
