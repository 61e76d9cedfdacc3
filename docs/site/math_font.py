"""The font of formulas, cut down to the signs that formulas have and put into the site.

Browsers need a font with a table of mathematics to place accents and to stretch brackets, and few
machines have one.
"""

from __future__ import annotations

from importlib.resources import as_file, files
from pathlib import Path

from fontTools import subset
from sphinx.application import Sphinx

NAME = "formulas.woff"
# Latin, Greek, signs of mathematics, and the letters of formulas.
RANGES = (
    (0x20, 0x7E), (0xA0, 0xFF), (0x2C6, 0x2DD), (0x300, 0x338), (0x370, 0x3FF), (0x2000, 0x206F),
    (0x20D0, 0x20EF), (0x2100, 0x214F), (0x2190, 0x22FF), (0x2308, 0x230B), (0x23B4, 0x23E1),
    (0x27E6, 0x27EF), (0x1D400, 0x1D7FF),
)  # fmt: skip


def write_font(target: Path) -> None:
    """Write the cut-down STIX Two Math as a WOFF file."""
    options = subset.Options(flavor="woff", layout_features=["*"], hinting=False)
    with as_file(files("ziamath.fonts") / "STIXTwoMath-Regular.ttf") as path:
        font = subset.load_font(str(path), options)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[code for low, high in RANGES for code in range(low, high + 1)])
    subsetter.subset(font)
    target.parent.mkdir(parents=True, exist_ok=True)
    subset.save_font(font, str(target), options)


def _add(app: Sphinx) -> None:
    target = Path(app.doctreedir).parent / "static" / NAME
    if not target.is_file():
        write_font(target)
    app.config.html_static_path.append(str(target.parent))


def setup(app: Sphinx) -> dict[str, bool]:
    """Called by Sphinx."""
    app.connect("builder-inited", _add)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
