"""The site builds without a warning, holds every page, and needs no network."""

from __future__ import annotations

import re

import pytest
from docs.site.__main__ import build
from docs.site.menu import MENU, arranged
from docs.site.staging import pages_of

from .markdown import ROOT

pytestmark = [
    pytest.mark.minutes,
    # Of Sphinx's own extensions, which use what its next version but one will not have.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::PendingDeprecationWarning"),
]
LOADED = re.compile(r'<(?:script|link|img|iframe|source)\b[^>]*?\b(?:src|href)="([^"]+)"')
IN_STYLE = re.compile(r"url\(\s*['\"]?([^'\")]+)")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the built site; a warning of Sphinx (links, anchors, menu) fails."""
    folder = tmp_path_factory.mktemp("site")
    assert build(folder / "html", folder / "work") == 0
    return folder / "html"


def test_every_page_is_there(site):
    for place in pages_of(ROOT):
        assert (site / place).with_suffix(".html").is_file()
    for place in ("keys/top", "keys/body", "commands", "fields", "python-api", "equation-index"):
        assert (site / "reference" / f"{place}.html").is_file()


def test_nothing_is_fetched_from_elsewhere(site):
    for page in site.rglob("*.html"):
        for target in LOADED.findall(page.read_text(encoding="utf-8")):
            assert "//" not in target, f"{page.name}: {target}"
            if not target.startswith(("data:", "#")):
                assert (page.parent / target.partition("?")[0].partition("#")[0]).exists(), target
    for style in site.rglob("*.css"):
        for target in IN_STYLE.findall(style.read_text(encoding="utf-8")):
            assert "//" not in target or target.startswith("data:"), f"{style.name}: {target}"


def test_formulas_are_drawn_by_the_browser(site):
    text = (site / "equations.html").read_text(encoding="utf-8")
    assert text.count("<math") > 300
    assert 'id="eq-30"' in text
    assert "\\vec" not in text


def test_numbers_of_equations_are_links(site):
    text = (site / "how-to" / "own-grains.html").read_text(encoding="utf-8")
    assert 'href="../equations.html#eq-42"' in text


def test_new_pages_find_their_place():
    placed = arranged(["getting-started", "how-to/new", "gallery/flume", "index", "stray"])
    assert placed == {
        "Start here": ["getting-started"],
        "How to": ["how-to/new"],
        "Gallery": ["gallery/flume"],
        "Project": ["stray"],
    }
    assert len({heading.title for heading in MENU}) == len(MENU)


def test_a_broken_link_fails(tmp_path, monkeypatch):
    pages = tmp_path / "pages"

    def stage_one(root, target):
        target.mkdir(parents=True)
        (target / "index.md").write_text("# One\n\n[gone](gone.md)\n")

    monkeypatch.setattr("docs.site.__main__.stage", stage_one)
    assert build(tmp_path / "html", pages) != 0
