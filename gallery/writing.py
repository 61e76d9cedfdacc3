"""The pages of the gallery as Markdown: text of the page, numbers that were kept of its run."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from doseki.util.files import write_whole_text

from .page import Page

KEPT = "numbers.json"  # in the folder of the pages
Entry = Mapping[str, Any]  # see making.entry_of


def read_kept(folder: Path) -> dict[str, Any]:
    """The entries of all pages by scenario; none where no page has been made."""
    path = folder / KEPT
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def write_kept(folder: Path, entries: Mapping[str, Entry]) -> None:
    """Keep the entries of pages."""
    text = json.dumps(entries, indent=1, ensure_ascii=False) + "\n"
    write_whole_text(folder / KEPT, text)


def command_of(page: Page) -> str:
    """The command line that runs the scenario of a page."""
    settings = "".join(f" --set {each}" for each in page.settings)
    return f"./doseki run {page.scenario}{settings}"


def page_text(page: Page, entry: Entry) -> str:
    """A page of the gallery."""
    name = page.scenario
    pictures = [f"{name}-{figure}.png" for figure in page.figures]
    pictures += [f"{name}-chart.png"] * (page.chart is not None)
    parts = [
        f"# {entry['title']}",
        entry["description"],
        *([f"![film of the run]({name}.webp)"] * (page.film is not None)),
        f"    {command_of(page)}",
        "## What it teaches",
        " ".join(page.teaches.split()),
        "## Key numbers",
        numbers_table(entry["numbers"]),
        *(f"![{_alternative(name, picture)}]({picture})" for picture in pictures),
        "## What it cost",
        cost_text(entry),
        "## Try next",
        "\n".join(f"- `{command}`: {text}" for command, text in page.then),
        f"The scenario: [scenarios/{name}.toml](../../scenarios/{name}.toml). All pages:"
        f" [gallery](index.md).\n\n<!-- made from text {entry['digest']} -->",
    ]
    return "\n\n".join(parts) + "\n"


def _alternative(name: str, picture: str) -> str:
    """What stands in the place of a picture that cannot be seen."""
    return Path(picture).stem.removeprefix(f"{name}-")


def numbers_table(numbers: Sequence[Entry]) -> str:
    """A row for each number; the last columns hold what it is compared with."""
    rows = ["| what | the run | to compare | of |", "|---|---|---|---|"]
    for each in numbers:
        beside = "" if each["beside"] is None else _with_unit(each["beside"], each["unit"])
        value = _with_unit(each["value"], each["unit"])
        rows.append(f"| {each['what']} | {value} | {beside} | {each['source']} |")
    return "\n".join(rows)


def _with_unit(value: float, unit: str) -> str:
    space = "" if unit in ("", "°") else " "
    return f"{rounded(value)}{space}{unit}"


def rounded(value: float) -> str:
    """Three digits that count, in plain notation where it is readable."""
    if value == 0 or 1e-3 <= abs(value) < 1e5:
        return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
    return f"{value:.1e}"


def cost_text(entry: Entry) -> str:
    """How large the run was, and what it took."""
    said = (
        f"{entry['particles']:,} particles (dp = {1e3 * entry['dp']:.3g} mm, {entry['dim']}-D,"
        f" scheme `{entry['scheme']}`), {entry['steps']:,} steps to {entry['time']:g} s:"
        f" {duration(entry['processor_seconds'])} of one core of an {entry['processor']}"
    )
    busy = (
        f", in {duration(entry['wall_seconds'])} on a machine that others used (a load of"
        f" {entry['load']:.0f} on {entry['cores']} cores)"
    )
    shared = entry["load"] > 1.5 and entry["wall_seconds"] > 1.2 * entry["processor_seconds"]
    doubts = "".join(f"\n- {word}: {text}" for word, text in entry["doubts"])
    judged = (
        f"What the run's own checks doubt ([what they mean](../trust.md)):\n{doubts}"
        if doubts
        else "The run's own checks ([what they mean](../trust.md)) are all good."
    )
    return f"{said}{busy if shared else ''}.\n\n{judged}"


def duration(seconds: float) -> str:
    """In seconds, or in minutes from two on."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.1f} min"


def index_text(pages: Mapping[str, Page], entries: Mapping[str, Entry]) -> str:
    """The index: a thumbnail, a title and the cost of each page that has been made."""
    rows = ["| | scenario | particles | one core |", "|---|---|---|---|"]
    for name in pages:
        if name not in entries:
            continue
        entry = entries[name]
        link = f"[![{name}]({name}-small.webp)]({name}.md)"
        what = f"[**{entry['title']}**]({name}.md)"
        cost = duration(entry["processor_seconds"])
        rows.append(f"| {link} | {what} | {entry['particles']:,} | {cost} |")
    parts = [
        "# Gallery",
        "Scenarios that come with doseki, each with a film, key numbers beside a formula or a"
        " measurement where there is one, what it cost and what to try next. Every number is read"
        " from the record of the run by code (`gallery/pages/`). They are coarse enough for a"
        " minute of one core, so that the checks that every run makes of itself are often not"
        " content; pages say so.",
        "\n".join(rows),
        "A page is made by running it:",
        "    .venv/bin/python -m gallery drip     # runs it and writes docs/gallery/drip.md\n"
        "    .venv/bin/python -m gallery --text   # the Markdown again, from the numbers kept",
        "Tests say when a scenario has changed since its page was made.",
    ]
    return "\n\n".join(parts) + "\n"


def write_pages(folder: Path, pages: Mapping[str, Page], entries: Mapping[str, Entry]) -> None:
    """Write the Markdown of all pages that have numbers, and the index."""
    for name, page in pages.items():
        if name in entries:
            write_whole_text(folder / f"{name}.md", page_text(page, entries[name]))
    write_whole_text(folder / "index.md", index_text(pages, entries))
