"""What the gauges read, as curves; those that a figure of the run shows are there already."""

from __future__ import annotations

import io
from collections.abc import Iterator

from ...errors import DosekiError, one_line
from ...figures.kinds.gauge import draw_gauge
from ...figures.text import plain_text
from ...measure.views import tables
from ...record.reader import Run
from ...scenario.gauges.gauge import Gauge
from ...scenario.gauges.loads.load import Load
from ...scenario.tables.figure import Figure, GaugeFigure, LoadFigure
from ..markup import Markup, section, tag
from .captions import words
from .pictures import Album, captioned

MOST = 24  # gauges that are drawn
DPI = 110


def gauges(run: Run, album: Album) -> Markup | None:
    """The section of the gauges."""
    drawn = tables(run, "figure", Figure).values()
    shown = {each.gauge for each in drawn if isinstance(each, GaugeFigure | LoadFigure)}
    wanted = [name for name in run.gauges if name not in shown and _has_rows(run, name, album)]
    if len(wanted) > MOST:
        album.notes.append(f"{len(wanted) - MOST} of {len(wanted)} gauges are left out.")
    figures = list(_figures(run, wanted[:MOST], album))
    return (
        section("Gauges", tag("div", figures, class_="gallery"), name="gauges") if figures else None
    )


def _has_rows(run: Run, name: str, album: Album) -> bool:
    try:
        return len(run.gauges[name]["time"]) > 0
    except DosekiError as error:
        album.notes.append(one_line(f"gauge {name} is left out: {error}."))
        return False


def _drawn(run: Run, name: str) -> bytes:
    """The curves of a gauge as a PNG."""
    file = io.BytesIO()
    with plain_text():
        figure = draw_gauge(run, name, GaugeFigure(kind="gauge", gauge=name))
        figure.savefig(file, format="png", dpi=DPI)
    return file.getvalue()


def _figures(run: Run, names: list[str], album: Album) -> Iterator[Markup]:
    kinds = tables(run, "gauge", Gauge)
    for name in names:
        try:
            if name not in album.drawn:
                album.drawn[name] = _drawn(run, name)
        except DosekiError as error:
            album.notes.append(one_line(f"gauge {name} is left out: {error}."))
            continue
        is_load = isinstance(kinds[name], Load)
        if picture := album.picture(album.drawn[name], f"gauge {name}", is_load):
            kind = words(kinds[name].kind)
            yield captioned(picture, f"{name}: {kind}, {len(run.gauges[name]['time'])} rows")
