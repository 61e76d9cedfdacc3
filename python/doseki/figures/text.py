"""Words in pictures: as they are written, in a font that has their characters."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import matplotlib as mpl
from matplotlib import font_manager

# Fonts of Chinese, Japanese and Korean, in order of preference; matplotlib reads the first that has
# a character.
CJK = (
    "Noto Sans CJK JP", "Noto Sans JP", "Source Han Sans JP", "IPAexGothic", "IPAGothic",
    "TakaoGothic", "VL Gothic", "Noto Sans CJK SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei",
    "Droid Sans Fallback", "Noto Sans CJK KR", "NanumGothic", "Unifont",
)  # fmt: skip
MISSING = re.compile(r"Glyph (\d+) .*missing from")
REMEDY = "install a font that has them, such as Debian's fonts-noto-cjk; they are drawn as boxes"


@contextmanager
def plain_text() -> Iterator[list[str]]:
    """Draw text as it is: `$` and backslashes begin no formula.

    The list gets a sentence about characters that no font here has, when drawing is done.
    """
    here = {font.name for font in font_manager.fontManager.ttflist}
    families = [*mpl.rcParams["font.family"], *(name for name in CJK if name in here)]
    complaints: list[str] = []
    with (
        mpl.rc_context({"text.parse_math": False, "font.family": families}),
        warnings.catch_warnings(record=True) as said,
    ):
        warnings.simplefilter("always")
        yield complaints
    missing = [found[1] for each in said if (found := MISSING.match(str(each.message)))]
    if missing:
        characters = "".join(chr(int(code)) for code in dict.fromkeys(missing))
        complaints.append(f"no font has the characters {characters}: {REMEDY}")
