"""The report on a run: DIR/report.html."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from ..assess.summary import title_of
from ..errors import DosekiError, UserError, one_line
from ..figures.plot import draw_run
from ..geodata.ground import Profile, ground_files
from ..measure.views import tables
from ..record.reader import Run, load
from ..scenario.tables.figure import Figure, LoadFigure
from ..util.files import write_whole_text
from ..util.foreign import REMEDY, open_regular
from .markup import Content, Markup, section, tag
from .page import GENERATOR, page, viewer
from .parts.captions import of_figures, of_maps
from .parts.facts import facts, heading
from .parts.findings import findings
from .parts.gauges import gauges
from .parts.ledger import ledgers
from .parts.pictures import WIDTHS, Album, gallery
from .parts.provenance import provenance
from .parts.tables import tables_of
from .view.scene import Scene, make_scene
from .view.terrain import Grid, grid_below, grid_of

MB = 1e6
DEFAULT_MB = 20.0
# Of the size, kept for the view: pictures take no more than the rest. It is less rather than that
# pictures are left out.
LEAST_VIEW, SHORT_VIEW = 0.4, 0.2
SPARE = 12_000  # bytes of what stands around the view, and of notes
HEAD_BYTES = 4096  # of a report, in which it says that it is one

# What the sections are made of.
FILES = {
    "title": "summary.json",
    "summary": "summary.json, history.csv",
    "trust": "trust.json, summary.json, failure.json",
    "ledgers": "summary.json, history.csv",
    "provenance": "provenance.json, inputs",
    "figures": "scenario.toml, snapshots",
    "maps": "maps",
    "loads": "loads.json",
    "sections": "sections.json",
    "gauges": "scenario.toml, gauges",
    "view": "snapshots, scenario.toml",
}

Maker = Callable[[], Content]  # of a section


@dataclass
class Report:
    """The file that was written, its bytes, and what was left out of it."""

    path: Path
    size: int
    notes: list[str] = field(default_factory=list)


def write_report(
    directory: str | Path, size_mb: float = DEFAULT_MB, output: Path | None = None
) -> Report:
    """Write the report on the run in `directory` into DIR/report.html, or `output`.

    It is at most about `size_mb` 10^6 bytes: pictures are made smaller, then particles and
    snapshots of the view left out, then pictures, those of maps and loads last. Raises UserError
    where there is no run, or a file of it is damaged, and ResourceError where the disk is full.
    """
    run = load(directory)
    path = output or run.folder.report
    _check_free(path)
    before, texts = _before(run), _texts(run)  # first: what is damaged is told at once
    notes = _draw_missing(run)
    terrain = _terrain(run, notes)
    room = size_mb * MB - len(page("", [before, texts], Scene({})).encode("utf-8")) - SPARE
    pictures, album = _pictures(run, room)
    notes += album.notes
    if album.shrunk and album.widest < WIDTHS[0]:
        some = "1 picture is" if album.shrunk == 1 else f"{album.shrunk} pictures are"
        notes.append(f"{some} shown {album.widest} pixels wide.")
    after = [*texts[:2], *pictures, *texts[2:]]
    rest = len(page("", [before, after], Scene({})).encode("utf-8"))
    scene, note = _scene(run, size_mb * MB - rest - SPARE, terrain)
    shown: Content = viewer(scene) if scene else section("The flow", tag("p", note), name="view")
    text = page(str(title_of(run)), [*before, shown, *after, _end(notes)], scene)
    write_whole_text(path, text)
    told = [*(scene.notes if scene else [note]), *notes]
    return Report(path, len(text.encode("utf-8")), told)


def _check_free(path: Path) -> None:
    """Raise UserError where something is that is no report: it is not overwritten."""
    if path.is_symlink():
        raise UserError(f"{path}: is a symbolic link; nothing is written through it")
    if path.exists():
        with open_regular(path) as (file, _):
            if GENERATOR.encode() not in file.read(HEAD_BYTES):
                raise UserError(f"{path}: exists and is no report of doseki; not overwritten")


def _made(run: Run, makers: Mapping[str, Maker]) -> list[Content]:
    """Sections by their names; raises UserError where a file is not what it should be."""
    made = []
    for name, make in makers.items():
        with _of_section(run, name):
            made.append(make())
    return made


@contextmanager
def _of_section(run: Run, name: str) -> Iterator[None]:
    """Raise UserError for whatever a damaged file leads to, with the files that may be it."""
    try:
        yield
    except (DosekiError, MemoryError):
        raise
    except Exception as error:
        raise UserError(
            f"{run.folder.path}: the section {name} of its report cannot be made, as what is in "
            f"{FILES[name]} is not what a run writes; {REMEDY}"
        ) from error


def _before(run: Run) -> list[Content]:
    """What comes before the view."""
    return _made(run, {"title": lambda: heading(run), "summary": lambda: facts(run)})


def _texts(run: Run) -> list[Content]:
    """What comes after it without pictures: two sections before those with pictures, one after."""
    return _made(
        run,
        {
            "trust": lambda: findings(run),
            "ledgers": lambda: ledgers(run),
            "provenance": lambda: provenance(run),
        },
    )


def _pictures(run: Run, room: float) -> tuple[list[Content], Album]:
    """The sections with pictures, as large as there is room for them and for a view, bytes."""
    album = Album()
    for widest in WIDTHS:
        album = Album(widest, drawn=album.drawn)
        made = _with_pictures(run, album)
        if album.size <= (1 - LEAST_VIEW) * room:
            return made, album
    left_out = album.without((1 - SHORT_VIEW) * room)
    album = Album(WIDTHS[-1], left_out, album.drawn)
    return _with_pictures(run, album), album


def _with_pictures(run: Run, album: Album) -> list[Content]:
    folder = run.folder.path
    makers: dict[str, Maker] = {
        "figures": lambda: _figures(run, album),
        "maps": lambda: gallery("Maps", album.folder(run.folder.maps, of_maps()), "maps"),
        "loads": lambda: tables_of(folder, "loads", "Loads", album),
        "sections": lambda: tables_of(folder, "sections", "Sections", album),
        "gauges": lambda: gauges(run, album),
    }
    return _made(run, makers)


def _figures(run: Run, album: Album) -> Markup | None:
    of_loads = [
        name for name, each in tables(run, "figure", Figure).items() if isinstance(each, LoadFigure)
    ]
    figures = album.folder(run.folder.figures, of_figures(run), of_loads)
    return gallery("Figures", figures, "figures")


def _draw_missing(run: Run) -> list[str]:
    """Draw the figures of a run that has none yet; says which could not be drawn."""
    if not len(run) or any(run.folder.figures.glob("*.png")):
        return []
    with _of_section(run, "figures"):
        return [one_line(f"{text}.") for text in draw_run(run.folder.path).failures]


def _terrain(run: Run, notes: list[str]) -> Grid | None:
    """The terrain of a run as it was used; what cannot be read is left out, with a note."""
    try:
        ground = run.ground
    except UserError as error:
        name = ground_files(run.folder.path)[0].name
        notes.append(one_line(f"{name} is left out: {error}."))
        return None
    if isinstance(ground, Profile):
        return grid_below(ground.x, ground.z)
    return None if ground is None else grid_of(ground)


def _scene(run: Run, room: float, terrain: Grid | None) -> tuple[Scene | None, str]:
    """The view, or why there is none."""
    if not len(run):
        return None, "The run has no snapshot yet."
    with _of_section(run, "view"):
        return make_scene(run, room, terrain), ""


def _end(notes: list[str]) -> Content:
    """What was left out."""
    if not notes:
        return None
    return tag("footer", tag("h2", "Left out"), tag("ul", [tag("li", n) for n in notes]))
