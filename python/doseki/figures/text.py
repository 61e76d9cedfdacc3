"""Words in pictures: as they are written, in a font that has their characters."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import matplotlib as mpl
from matplotlib import font_manager
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.font_manager import FontProperties

# Fonts of Chinese, Japanese and Korean, in order of preference; matplotlib reads the first that has
# a character.
CJK = (
    "Noto Sans CJK JP", "Noto Sans JP", "Source Han Sans JP", "IPAexGothic", "IPAGothic",
    "TakaoGothic", "VL Gothic", "Noto Sans CJK SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei",
    "Droid Sans Fallback", "Noto Sans CJK KR", "NanumGothic", "Unifont",
)  # fmt: skip
MISSING = re.compile(r"Glyph (\d+) .*missing from")
REMEDY = "install a font that has them, such as Debian's fonts-noto-cjk; they are drawn as boxes"
TITLE = "medium"  # size of the titles of figures


@contextmanager
def plain_text() -> Iterator[list[str]]:
    """Draw text as it is: `$` and backslashes begin no formula.

    The list gets the characters that no font here has, when drawing is done.
    """
    here = {font.name for font in font_manager.fontManager.ttflist}
    families = [*mpl.rcParams["font.family"], *(name for name in CJK if name in here)]
    missing: list[str] = []
    with (
        mpl.rc_context({"text.parse_math": False, "font.family": families}),
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always")
        yield missing
    codes = [found[1] for each in said if (found := MISSING.match(str(each.message)))]
    missing += [chr(int(code)) for code in dict.fromkeys(codes)]


def missing_text(characters: Iterable[str]) -> list[str]:
    """A sentence about characters that no font has; none where there are none."""
    found = "".join(dict.fromkeys(characters))
    return [f"no font has the characters {found}: {REMEDY}"] if found else []


def wrapped(text: str, width: float, size: str = TITLE) -> str:
    """A text in lines no longer than `width`, inches, as they are drawn; long words are cut.

    Matplotlib's own `wrap` breaks lines between words alone, and keeps no room for them.
    """
    lines: list[str] = []
    for word in text.split():
        if lines and _is_within(f"{lines[-1]} {word}", width, size):
            lines[-1] += f" {word}"
        else:
            lines += _pieces(word, width, size)
    return "\n".join(lines)


def _pieces(word: str, width: float, size: str) -> list[str]:
    """A word in pieces that fit, of one letter at least."""
    pieces = [""]
    for letter in word:
        if pieces[-1] and not _is_within(pieces[-1] + letter, width, size):
            pieces.append("")
        pieces[-1] += letter
    return pieces


def _is_within(text: str, width: float, size: str) -> bool:
    font = FontProperties(size=size)
    return _RULER.get_text_width_height_descent(text, font, False)[0] <= width * _RULER.dpi


_RULER = RendererAgg(1, 1, 72)
