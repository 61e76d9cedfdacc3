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


def _figures(run: Run, names: list[str], album: Album) -> Iterator[Markup]:
    kinds = tables(run, "gauge", Gauge)
    for name in names:
        try:
            table = GaugeFigure(kind="gauge", gauge=name)
            with plain_text():
                figure = draw_gauge(run, name, table)
                file = io.BytesIO()
                figure.savefig(file, format="png", dpi=DPI)
        except DosekiError as error:
            album.notes.append(one_line(f"gauge {name} is left out: {error}."))
            continue
        if picture := album.picture(file.getvalue(), f"gauge {name}"):
            kind = words(kinds[name].kind)
            yield captioned(picture, f"{name}: {kind}, {len(run.gauges[name]['time'])} rows")
