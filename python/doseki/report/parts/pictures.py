"""Pictures inside the page: those of the run, maps, and whatever else lies in its folder."""

from __future__ import annotations

import base64
import io
import warnings
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from PIL import Image

from ...errors import UserError, one_line
from ...util.foreign import read_bytes
from ..markup import Content, Markup, section, tag
from .captions import Captions, words

WIDE = 1150  # pixels: a picture that is wider takes the whole width of the page
# Pixels: no picture is wider than the first; where room is short, than the first with room for all.
WIDTHS = (2000, 1200, 700, 450)
COLOURS = 256  # of a picture that was made smaller, which takes a third of the bytes then
MOST_PIXELS = 60_000_000  # of a picture that is opened at all
MOST_BYTES = 40 * 2**20  # of a file
MOST = 60  # pictures of a folder


@dataclass
class Album:
    """Pictures that go into a page, none of them wider than `widest` pixels.

    Those in `left_out`, by their numbers, do not: there is no room for them.
    """

    widest: int = WIDTHS[0]
    left_out: frozenset[int] = frozenset()
    drawn: dict[str, bytes] = field(default_factory=dict)  # pictures that were made for the page
    notes: list[str] = field(default_factory=list)  # what was left out, and why
    sizes: list[int] = field(default_factory=list)  # bytes of each picture, shown or not
    matters: list[bool] = field(default_factory=list)  # of each: it is a map, or a load
    shrunk: int = 0  # pictures that have fewer pixels than their files

    @property
    def size(self) -> int:
        """Bytes of all pictures that are shown."""
        return sum(size for k, size in enumerate(self.sizes) if k not in self.left_out)

    def without(self, room: float) -> frozenset[int]:
        """The pictures to leave out so that the others fit into so many bytes.

        Maps and loads stay as long as they can; of these, as of the others, small ones do.
        """
        order = sorted(range(len(self.sizes)), key=lambda k: (not self.matters[k], self.sizes[k]))
        left_out, used = set(), 0
        for k in order:
            if used + self.sizes[k] > room:
                left_out.add(k)
            else:
                used += self.sizes[k]
        return frozenset(left_out)

    def picture(self, data: bytes, name: str, matters: bool = False) -> Markup | None:
        """A PNG as an element; None, and a note, where it is none or there is no room for it."""
        try:
            content, (width, height), is_smaller = _made_small(data, self.widest)
        except (OSError, ValueError, Image.DecompressionBombError, Image.DecompressionBombWarning):
            self.notes.append(f"{name} is left out: it is not a PNG that can be shown.")
            return None
        text = base64.b64encode(content).decode("ascii")
        self.sizes.append(len(text))
        self.matters.append(matters)
        if len(self.sizes) - 1 in self.left_out:
            self.notes.append(f"{name} is left out: no room for its {len(text) / 1e6:.2g} MB.")
            return None
        self.shrunk += is_smaller
        source = f"data:image/png;base64,{text}"
        size = {"width": str(width), "height": str(height)}
        return tag("img", src=source, alt=name, class_="wide" if width > WIDE else None, **size)

    def folder(
        self, path: Path, captions: Captions | None = None, matter: Collection[str] | None = None
    ) -> list[Markup]:
        """The PNG files of a folder as figures: an overview first, then by name.

        Those that have no caption are called as their files are.  `matter` are the names of those
        that stay longest where room is short; all of them, where it is None.
        """
        found = path.glob("*.png") if path.is_dir() else []
        files = sorted(found, key=lambda file: (file.stem != "overview", file.name))
        if len(files) > MOST:
            self.notes.append(
                f"{len(files) - MOST} of {len(files)} pictures in {path.name}/ are left out."
            )
        named = {file: (captions or {}).get(file.stem) or words(file.stem) for file in files[:MOST]}
        made = (
            self._file(file, caption, matter is None or file.stem in matter)
            for file, caption in named.items()
        )
        return [figure for figure in made if figure is not None]

    def _file(self, file: Path, caption: str, matters: bool) -> Markup | None:
        try:
            data = read_bytes(file, MOST_BYTES)
        except UserError as error:
            self.notes.append(one_line(f"{file.name} is left out: {error}."))
            return None
        picture = self.picture(data, file.name, matters)
        return None if picture is None else captioned(picture, caption)


def captioned(content: Content, caption: str) -> Markup:
    """A figure with its caption."""
    return tag("figure", content, tag("figcaption", caption))


def gallery(title: str, figures: Iterable[Markup], name: str) -> Markup | None:
    """The section of some figures; None without any."""
    found = list(figures)
    return section(title, tag("div", found, class_="gallery"), name=name) if found else None


def _made_small(data: bytes, widest: int) -> tuple[bytes, tuple[int, int], bool]:
    """A PNG of at most so many pixels a row, its size, and whether it has fewer than it had.

    Raises ValueError or OSError for what is none, and Pillow's complaints about pictures that
    unpack to too much.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error", Image.DecompressionBombWarning)
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            if image.width * image.height > MOST_PIXELS:
                raise ValueError("too many pixels")
            image.load()
            if image.width <= widest:
                return data, image.size, False
            size = widest, max(1, round(image.height * widest / image.width))
            made = _on_white(image).resize(size, Image.Resampling.LANCZOS)
    file = io.BytesIO()
    made.quantize(COLOURS, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
    return file.getvalue(), size, True


def _on_white(image: Image.Image) -> Image.Image:
    """What is seen of a picture on paper."""
    if "transparency" not in image.info and "A" not in image.getbands():
        return image.convert("RGB")
    paper = Image.new("RGBA", image.size, "white")
    return Image.alpha_composite(paper, image.convert("RGBA")).convert("RGB")
