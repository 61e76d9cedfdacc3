"""The pages of the gallery: made from the scenarios as they are, and from numbers that are kept."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

pytest.importorskip("gallery", reason="the gallery is in the clone alone")

from gallery.making import entry_of, recorded
from gallery.page import Number
from gallery.pages import PAGES
from gallery.sources import digest
from gallery.writing import index_text, page_text, read_kept, rounded

from ..shipped import NAMES

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs" / "gallery"
KEPT = read_kept(DOCS)
MOST_BYTES = 6e6  # of all pictures and films
COARSE = ["dp=0.005", "time_max=0.5"]

pages = pytest.mark.parametrize("name", PAGES)


def test_there_are_twelve_pages_of_shipped_scenarios():
    assert len(PAGES) == 12
    assert set(PAGES) <= set(NAMES)
    assert set(KEPT) == set(PAGES)


@pages
def test_a_page_is_made_from_the_scenario_as_it_is(name):
    now = digest(name, PAGES[name].settings)
    assert KEPT[name]["digest"] == now, (
        f"docs/gallery/{name}.md shows what an earlier text gave:"
        f" .venv/bin/python -m gallery {name}"
    )
    assert KEPT[name]["settings"] == list(PAGES[name].settings)


@pages
def test_the_text_of_a_page_is_that_of_its_numbers(name):
    """So that nothing is typed in; `python -m gallery --text` writes it again."""
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    assert text == page_text(PAGES[name], KEPT[name])
    assert f"<!-- made from text {KEPT[name]['digest']} -->" in text


def test_the_index_names_all_pages():
    text = (DOCS / "index.md").read_text(encoding="utf-8")
    assert text == index_text(PAGES, KEPT)
    assert all(f"({name}.md)" in text for name in PAGES)


@pages
def test_what_a_page_links_to_is_there(name):
    text = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert (f"{name}.webp" in links) is (PAGES[name].film is not None)
    for link in links:
        assert (DOCS / link).resolve().is_file(), link


def test_pictures_and_films_are_small():
    files = [path for path in DOCS.iterdir() if path.suffix in (".png", ".webp")]
    assert sum(path.stat().st_size for path in files) < MOST_BYTES
    shown = " ".join(path.read_text(encoding="utf-8") for path in DOCS.glob("*.md"))
    assert [path.name for path in files if path.name not in shown] == []


def test_a_changed_text_has_another_digest(tmp_path):
    path = tmp_path / "case.toml"
    source = ROOT / "scenarios" / "drip.toml"
    path.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    same = digest(str(path))
    assert same == digest("drip")
    assert digest(str(path), ["fall=0.1"]) != same
    path.write_text(path.read_text(encoding="utf-8") + "\n# another\n", encoding="utf-8")
    assert digest(str(path)) != same


def test_numbers_can_be_computed_again(tmp_path):
    """A coarse, short run of the cheapest page: free fall and the water of one drop come out."""
    page = PAGES["drip"]
    entry = entry_of(page, recorded(page, tmp_path / "drip", COARSE))
    assert [each["unit"] for each in entry["numbers"]] == [
        each["unit"] for each in KEPT["drip"]["numbers"]
    ]
    fall, water, *_ = entry["numbers"]
    # Five particles across the drop; water that hangs on the tap as it shuts is 6 % slower.
    assert fall["value"] == pytest.approx(fall["beside"], rel=0.05)
    assert fall["value"] == pytest.approx(KEPT["drip"]["numbers"][0]["value"], rel=0.03)
    # By then two of the three drops have been let go of.
    assert water["value"] == pytest.approx(2 / 3 * water["beside"], rel=0.05)
    assert all(math.isfinite(each["value"]) for each in entry["numbers"])


def test_a_run_of_another_text_is_not_taken_for_this_one(tmp_path):
    page = PAGES["drip"]
    short = ["dp=0.005", "time_max=0.2"]
    first = recorded(page, tmp_path / "drip", short)
    assert recorded(page, tmp_path / "drip", short).times[-1] == first.times[-1]
    again = recorded(page, tmp_path / "drip", [*short, "time_max=0.22"])
    assert again.times[-1] == pytest.approx(0.22)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0, "0"), (0.4264, "0.426"), (1234.5, "1234"), (99_999, "99999"), (2.1e-12, "2.1e-12")],
)
def test_numbers_are_written_plainly(value, text):
    assert rounded(Number("", value).value) == text
