"""The report on a run: DIR/report.html."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ..assess.summary import title_of
from ..errors import UserError, one_line
from ..figures.plot import draw_run
from ..geodata.raster import read_raster
from ..record.beginning import refuse_links
from ..record.reader import Run, load
from ..util.files import write_whole_text
from ..util.foreign import open_regular, readable
from .markup import Content, Markup, section, tag
from .page import GENERATOR, page, viewer
from .parts.captions import of_figures, of_maps
from .parts.facts import facts, heading
from .parts.findings import findings
from .parts.gauges import gauges
from .parts.ledger import ledgers
from .parts.pictures import Album, gallery
from .parts.provenance import provenance
from .parts.tables import tables_of
from .view.scene import Scene, make_scene
from .view.terrain import Grid, grid_of

MB = 1e6
DEFAULT_MB = 20.0
LEAST_VIEW = 0.4  # of the size, kept for the view: pictures take no more than the rest
SPARE = 12_000  # bytes of what stands around the view, and of notes
HEAD_BYTES = 4096  # of a report, in which it says that it is one

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

    It is at most about `size_mb` 10^6 bytes: particles, then snapshots, of the view are left out
    so that it is. Raises UserError where there is no run, or a file of it is damaged, and
    ResourceError where the disk is full.
    """
    run = _checked(load(directory))
    path = output or run.folder.report
    _check_free(path)
    album = Album((1 - LEAST_VIEW) * size_mb * MB)
    terrain = _terrain(run, album)
    before, after = _before(run), _after(run, album)
    rest = len(page("", [before, after], Scene({})).encode("utf-8"))
    scene, note = _scene(run, size_mb * MB - rest - SPARE, terrain)
    notes = [*(scene.notes if scene else [note]), *album.notes]
    shown: Content = viewer(scene) if scene else section("The flow", tag("p", note), name="view")
    text = page(str(title_of(run)), [*before, shown, *after, _end(album)], scene)
    write_whole_text(path, text)
    return Report(path, len(text.encode("utf-8")), notes)


def _check_free(path: Path) -> None:
    """Raise UserError where something is that is no report: it is not overwritten."""
    if path.is_symlink():
        raise UserError(f"{path}: is a symbolic link; nothing is written through it")
    if path.exists():
        with open_regular(path) as (file, _):
            if GENERATOR.encode() not in file.read(HEAD_BYTES):
                raise UserError(f"{path}: exists and is no report of doseki; not overwritten")


def _checked(run: Run) -> Run:
    """A run whose plain files are what they should be; raises UserError for others."""
    for name, found in (("summary", run.summary), ("trust", run.trust)):
        if not isinstance(found, dict):
            raise UserError(f"{getattr(run.folder, name)}: holds no table")
    return run


def _made(run: Run, makers: Mapping[str, Maker]) -> list[Content]:
    """Sections by their names; raises UserError where a file is not what it should be."""
    made = []
    for name, make in makers.items():
        with readable(run.folder.path, f" for the section {name} of its report"):
            made.append(make())
    return made


def _before(run: Run) -> list[Content]:
    """What comes before the view."""
    return _made(run, {"title": lambda: heading(run), "summary": lambda: facts(run)})


def _after(run: Run, album: Album) -> list[Content]:
    """What comes after it."""
    folder = run.folder.path
    makers: dict[str, Maker] = {
        "trust": lambda: findings(run),
        "ledgers": lambda: ledgers(run),
        "figures": lambda: _figures(run, album),
        "maps": lambda: gallery("Maps", album.folder(run.folder.maps, of_maps()), "maps"),
        "loads": lambda: tables_of(folder, "loads", "Loads", album),
        "sections": lambda: tables_of(folder, "sections", "Sections", album),
        "gauges": lambda: gauges(run, album),
        "provenance": lambda: provenance(run),
    }
    return _made(run, makers)


def _figures(run: Run, album: Album) -> Markup | None:
    """The figures of the run; where there are none yet, they are drawn."""
    if len(run) and not any(run.folder.figures.glob("*.png")):
        refuse_links(run.folder)
        drawn = draw_run(run.folder.path)
        album.notes += [one_line(f"{text}.") for text in drawn.failures]
    return gallery("Figures", album.folder(run.folder.figures, of_figures(run)), "figures")


def _terrain(run: Run, album: Album) -> Grid | None:
    """The terrain of a 3-D run as it was used; what cannot be read is left out, with a note."""
    file = run.folder.terrain
    if file is None or run.scenario["dim"] != 3:
        return None
    try:
        return grid_of(read_raster(file))
    except UserError as error:
        album.notes.append(one_line(f"{file.name} is left out: {error}."))
        return None


def _scene(run: Run, room: float, terrain: Grid | None) -> tuple[Scene | None, str]:
    """The view, or why there is none."""
    if not len(run):
        return None, "The run has no snapshot yet."
    with readable(run.folder.snapshots, " for the view of its report"):
        return make_scene(run, room, terrain), ""


def _end(album: Album) -> Content:
    """What was left out."""
    if not album.notes:
        return None
    return tag("footer", tag("h2", "Left out"), tag("ul", [tag("li", n) for n in album.notes]))
