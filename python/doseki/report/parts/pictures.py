"""Pictures inside the page: those of the run, maps, and whatever else lies in its folder."""

from __future__ import annotations

import base64
import io
import warnings
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from PIL import Image

from ...errors import UserError, one_line
from ...util.foreign import read_bytes
from ..markup import Content, Markup, section, tag
from .captions import Captions, words

WIDE = 1150  # pixels: a picture that is wider takes the whole width of the page
WIDTHS = (2000, 1200, 700)  # pixels: none is wider than the first; of others, the first with room
MOST_PIXELS = 60_000_000  # of a picture that is opened at all
MOST_BYTES = 40 * 2**20  # of a file
MOST = 60  # pictures of a folder


@dataclass
class Album:
    """Pictures that go into a page while there is room: `room` bytes are left."""

    room: float
    notes: list[str] = field(default_factory=list)  # what was left out, and why

    def picture(self, data: bytes, name: str) -> Markup | None:
        """A PNG as an element; None, and a note, where it is none or there is no room for it."""
        try:
            text, (width, height) = self._fitting(data)
        except (OSError, ValueError, Image.DecompressionBombError, Image.DecompressionBombWarning):
            self.notes.append(f"{name} is left out: it is not a PNG that can be shown.")
            return None
        if len(text) > self.room:
            self.notes.append(f"{name} is left out: no room for its {len(text) / 1e6:.2g} MB.")
            return None
        self.room -= len(text)
        source = f"data:image/png;base64,{text}"
        size = {"width": str(width), "height": str(height)}
        return tag("img", src=source, alt=name, class_="wide" if width > WIDE else None, **size)

    def _fitting(self, data: bytes) -> tuple[str, tuple[int, int]]:
        """Base64 and size of the widest form that there is room for, or of the smallest."""
        for widest in WIDTHS:
            content, size = _made_small(data, widest)
            text = base64.b64encode(content).decode("ascii")
            if len(text) <= self.room:
                break
        return text, size

    def folder(self, path: Path, captions: Captions | None = None) -> list[Markup]:
        """The PNG files of a folder as figures: an overview first, then by name.

        Those that have no caption are called as their files are.
        """
        found = path.glob("*.png") if path.is_dir() else []
        files = sorted(found, key=lambda file: (file.stem != "overview", file.name))
        if len(files) > MOST:
            self.notes.append(
                f"{len(files) - MOST} of {len(files)} pictures in {path.name}/ are left out."
            )
        named = {file: (captions or {}).get(file.stem) or words(file.stem) for file in files[:MOST]}
        made = (self._file(file, caption) for file, caption in named.items())
        return [figure for figure in made if figure is not None]

    def _file(self, file: Path, caption: str) -> Markup | None:
        try:
            data = read_bytes(file, MOST_BYTES)
        except UserError as error:
            self.notes.append(one_line(f"{file.name} is left out: {error}."))
            return None
        picture = self.picture(data, file.name)
        return None if picture is None else captioned(picture, caption)


def captioned(content: Content, caption: str) -> Markup:
    """A figure with its caption."""
    return tag("figure", content, tag("figcaption", caption))


def gallery(title: str, figures: Iterable[Markup], name: str) -> Markup | None:
    """The section of some figures; None without any."""
    found = list(figures)
    return section(title, tag("div", found, class_="gallery"), name=name) if found else None


def _made_small(data: bytes, widest: int) -> tuple[bytes, tuple[int, int]]:
    """A PNG of at most so many pixels a row, and its size; raises ValueError or OSError for others.

    Raises also Pillow's complaints about pictures that unpack to too much.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            if image.width * image.height > MOST_PIXELS:
                raise ValueError("too many pixels")
            image.load()
            if image.width <= widest:
                return data, image.size
            size = widest, max(1, round(image.height * widest / image.width))
            made = image.convert("RGBA" if "transparency" in image.info else "RGB").resize(size)
    file = io.BytesIO()
    made.save(file, "PNG", optimize=True)
    return file.getvalue(), size
