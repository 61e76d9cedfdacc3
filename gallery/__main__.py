"""`python -m gallery NAME...`: runs scenarios and makes their pages in docs/gallery."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from doseki.errors import DosekiError

from .making import GalleryError, entry_of, make_pictures, recorded
from .pages import PAGES
from .writing import read_kept, write_kept, write_pages

ROOT = Path(__file__).resolve().parents[1]
DOCS, RUNS = ROOT / "docs" / "gallery", ROOT / "runs" / "gallery"


def main(arguments: Sequence[str] | None = None) -> int:
    """Make the pages that are named; returns the exit code."""
    parser = argparse.ArgumentParser(prog="gallery", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PAGES)}")
    parser.add_argument("--runs", type=Path, default=RUNS, help="where runs are kept (%(default)s)")
    parser.add_argument("--out", type=Path, default=DOCS, help="where pages go (%(default)s)")
    parser.add_argument("--numbers", action="store_true", help="leave the pictures as they are")
    parser.add_argument("--text", action="store_true", help="the Markdown alone, of numbers kept")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.names if name not in PAGES]
    if unknown or not (given.names or given.text):
        parser.error(f"no page named {unknown[0]}" if unknown else "name a page, or give --text")
    try:
        for name in given.names:
            make(name, given.runs / name, given.out, pictures=not given.numbers)
    except (DosekiError, GalleryError) as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 2
    write_pages(given.out, PAGES, read_kept(given.out))
    return 0


def make(name: str, run_folder: Path, out: Path, pictures: bool) -> None:
    """Run a scenario, unless its run is there, and keep its numbers in `out`, and its pictures."""
    run_folder.parent.mkdir(parents=True, exist_ok=True)
    page = PAGES[name]
    run = recorded(page, run_folder)
    made = make_pictures(page, run, out) if pictures else ["numbers"]
    entries = read_kept(out) | {name: entry_of(page, run)}
    write_kept(out, {each: entries[each] for each in PAGES if each in entries})
    print(f"{name}: {', '.join(made)}")


if __name__ == "__main__":
    sys.exit(main())
