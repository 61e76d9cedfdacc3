"""The menu of the site: which pages stand under which heading, and in what order.

A page of a folder that is not named here follows those that are, so that a new one needs no line;
a page named here that is not there is left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Heading:
    """A heading of the menu: `pages` first, then what else is in `folder`."""

    title: str
    pages: tuple[str, ...] = ()
    folder: str | None = None


MENU = (
    Heading("Start here", ("getting-started",)),
    Heading(
        "How to",
        (
            "how-to/dam-force",
            "how-to/own-grains",
            "how-to/breaking",
            "how-to/hydrographs",
            "how-to/read-results",
            "how-to/python",
            "how-to/paraview",
            "how-to/restart",
            "how-to/ranks",
            "how-to/graphics-card",
            "how-to/studies",
        ),
        "how-to",
    ),
    Heading("Gallery", ("gallery/index",), "gallery"),
    Heading(
        "Explanation",
        (
            "explanation/sph",
            "explanation/two-schemes",
            "explanation/sound-speed",
            "explanation/resolution",
            "trust",
            "weaknesses",
            "compare",
            "validation",
        ),
        "explanation",
    ),
    Heading(
        "Reference",
        (
            "scenarios",
            "reference/keys/index",
            "terrain",
            "maps",
            "reference/commands",
            "output",
            "reference/fields",
            "census",
            "reference/python-api",
            "equations",
            "reference/equation-index",
            "notation",
        ),
        "reference",
    ),
    Heading(
        "Project",
        (
            "tour",
            "performance",
            "scaling",
            "decisions/index",
            "contributing",
            "changelog",
        ),
        "",  # whatever else lies in docs itself
    ),
)
# What the menu calls pages whose own titles are long.
SHORT = {
    "scenarios": "Scenarios",
    "terrain": "Terrain",
    "maps": "Maps",
    "trust": "What a run promises",
    "output": "Output",
    "tour": "One step through the code",
    "reference/keys/index": "Keys",
    "reference/commands": "Commands",
    "reference/fields": "Fields",
    "reference/python-api": "Python interface",
    "weaknesses": "Weaknesses of the printed scheme",
    "compare": "Both schemes and the experiment",
}
NESTED = ("decisions/", "reference/keys/")  # pages that an index of their own lists


def arranged(names: Iterable[str]) -> dict[str, list[str]]:
    """The pages of each heading, of all page `names` (paths without .md); none is empty."""
    left = {name for name in names if name != "index" and not _is_nested(name)}
    placed: dict[str, list[str]] = {}
    for heading in MENU:
        placed[heading.title] = [page for page in heading.pages if page in left]
        left -= set(heading.pages)
    for heading in MENU:
        if heading.folder is not None:
            others = sorted(n for n in left if n.rpartition("/")[0] == heading.folder)
            placed[heading.title] += others
            left -= set(others)
    placed["Project"] += sorted(left)
    return {title: pages for title, pages in placed.items() if pages}


def _is_nested(name: str) -> bool:
    return name.startswith(NESTED) and not name.endswith("/index")


def toctrees(names: Iterable[str]) -> str:
    """The menu as Sphinx reads it, to stand at the end of the first page."""
    trees = []
    for title, pages in arranged(names).items():
        options = [f":caption: {title}", ":hidden:", ":maxdepth: 2"]
        lines = [f"{SHORT[page]} <{page}>" if page in SHORT else page for page in pages]
        trees.append("\n".join(["```{toctree}", *options, "", *lines, "```"]))
    return "\n\n".join(trees)
