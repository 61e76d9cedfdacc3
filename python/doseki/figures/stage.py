"""What stands still in a movie: axes, scale bar, key and title, drawn once around all frames."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from PIL import Image, ImageDraw, ImageFont

from ..measure.views import View
from ..record.reader import Run
from .colouring import Colouring
from .layout import BAR_SHARE, Extent, name_axes, nice_length

WIDTH = 1100  # pixels of the particles
DPI = 100
LEFT, RIGHT, BELOW, ABOVE = 90, 30, 60, 90  # pixels around them
TITLE, KEY, BAR = 26, 62, 62  # pixels from the top to the title, the key, the scale bar
NARROW = 800  # pixels of the particles; with fewer there is no room for key and bar side by side


class Stage:
    """The frame around the particles of a movie; everything is placed in pixels."""

    def __init__(
        self,
        run: Run,
        view: View,
        extent: Extent,
        colours: Colouring,
        pixels: int,
        numbers: bool = True,
    ) -> None:
        """`extent` is what the frames show, m, `pixels` how wide; axes may have `numbers`."""
        left, right, bottom, top = extent
        self._width = pixels
        self._height = max(1, round((top - bottom) / (right - left) * pixels))
        width, height = LEFT + pixels + RIGHT, ABOVE + self._height + BELOW
        self._size = width, height + height % 2  # MP4 wants even sizes
        self.figure = Figure(figsize=(self._size[0] / DPI, self._size[1] / DPI), dpi=DPI)
        canvas = FigureCanvasAgg(self.figure)
        axes = self._axes(extent)
        if numbers:
            name_axes(axes, run.scenario["dim"], view.rotate)
        else:
            axes.set(xticks=[], yticks=[])
        title = view.title or run.scenario.get("title", "")
        size = 8.5 if self._is_narrow else 11
        self.figure.text(LEFT / self._size[0], self._up(TITLE), title, fontsize=size)
        self._draw_key(colours)
        self._draw_bar(right - left)
        canvas.draw()
        self._still = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())

    def frame(self, pixels: np.ndarray, time: str) -> Image.Image:
        """A picture with the particles as pixels (rows, `pixels`, 3) uint8, and their time."""
        frame = self._still.copy()
        frame.paste(Image.fromarray(pixels[1:-1, 1:-1]), (LEFT + 1, ABOVE + 1))
        font = ImageFont.load_default(size=18)
        ImageDraw.Draw(frame).text((LEFT, ABOVE - 42), time, "black", font)
        return frame

    @property
    def _is_narrow(self) -> bool:
        return self._width < NARROW

    def _up(self, pixels: float) -> float:
        """Pixels from the top as a share of the height from below."""
        return 1 - pixels / self._size[1]

    def _axes(self, extent: Extent) -> Axes:
        width, height = self._size
        below = height - ABOVE - self._height
        box = (LEFT / width, below / height, self._width / width, self._height / height)
        axes = self.figure.add_axes(box)
        axes.set(xlim=extent[:2], ylim=extent[2:])
        axes.yaxis.set_major_locator(MaxNLocator(max(2, self._height // 60)))
        return axes

    def _draw_key(self, colours: Colouring) -> None:
        entries = colours.legend_entries()
        handles = [Patch(color=colour, label=label) for label, colour in entries]
        heading = [Patch(alpha=0.0, label=colours.heading)] if colours.heading else []
        start, size, gap = (95, 8, 0.7) if self._is_narrow else (140, 9, 1.2)
        self.figure.legend(
            handles=[*heading, *handles], ncols=len(handles) + len(heading), frameon=False,
            loc="center left", bbox_to_anchor=((LEFT + start) / self._size[0], self._up(KEY - 6)),
            fontsize=size, handlelength=1.0, handletextpad=0.5, columnspacing=gap, borderpad=0.0,
        )  # fmt: skip

    def _draw_bar(self, metres: float) -> None:
        length = nice_length(BAR_SHARE * metres)
        end = LEFT + self._width
        ends = (end - length / metres * self._width) / self._size[0], end / self._size[0]
        top = self._size[1] - 28 if self._is_narrow else BAR
        level = self._up(top + 16)
        bar = Line2D(ends, (level, level), color="black", linewidth=3, solid_capstyle="butt")
        bar.set_gid("scale bar")
        self.figure.add_artist(bar)
        self.figure.text(ends[1], self._up(top + 8), f"{length:g} m", fontsize=9, ha="right")
