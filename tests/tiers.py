"""The tiers of the tests: `./doseki test [TIER] [options of pytest]`.

A test that has the marker of a tier is run by that tier only; a test that has none belongs to the
default tier, which protects the main paths and takes some eight minutes on two cores. Markers are
declared in pyproject.toml.
"""

from __future__ import annotations

import difflib
import os
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# JUnit results of the last session of each tier, for whoever wants times or a page of results.
RESULTS = ROOT / "build" / "tests"


@dataclass(frozen=True)
class Tier:
    """What a tier is for, and how pytest selects its tests."""

    about: str
    options: tuple[str, ...]


# Markers of tests that the default tier leaves out.
APART = ("validate", "sanitize", "ranks", "isa", "full")
# Random inputs: other ones in each session, thousands of them.
FREE = "--hypothesis-profile=free"

TIERS = {
    "default": Tier(
        "what protects the main paths; eight minutes on two cores",
        ("-m", f"not ({' or '.join(APART)})"),
    ),
    "fast": Tier(
        "the default tier without what takes more than a few seconds",
        ("-m", f"not ({' or '.join(('minutes', *APART))})"),
    ),
    "validate": Tier("the validation cases, each at its coarsest resolution", ("-m", "validate")),
    "fuzz": Tier("thousands of random inputs", (FREE, "tests/fuzz")),
    "sanitize": Tier("the core under the compiler's sanitisers", ("-m", "sanitize")),
    "ranks": Tier("more ranks, and more runs on ranks", ("-m", "ranks")),
    "isa": Tier("the core for the instruction sets that this machine can run", ("-m", "isa")),
    "full": Tier("everything", (FREE, "-m", "")),
}


class UnknownTierError(Exception):
    """A word that is neither a tier, nor an option, nor a file."""


def nearest(word: str) -> str:
    """What a mistyped tier is told."""
    names = [name for name in TIERS if name != "default"]
    (close,) = difflib.get_close_matches(word, names, 1, 0.0)
    return f'no tier of tests "{word}"; did you mean {close}? Tiers are {", ".join(names)}'


def pytest_arguments(words: list[str]) -> list[str]:
    """The arguments of pytest for those of `./doseki test`.

    Raises:
        UnknownTierError: the first word is no tier, no option and no file of tests.

    """
    name, rest = "default", words
    if words and not words[0].startswith("-"):
        if words[0] in TIERS:
            name, rest = words[0], words[1:]
        elif not Path(words[0].partition("::")[0]).exists():
            raise UnknownTierError(nearest(words[0]))
    # In a group: what conftest.py wants to be run by one process.
    spread = ["-n", "auto", "--dist", "loadgroup"]
    results = ["--durations=25", f"--junitxml={RESULTS / name}.xml"]
    return [*spread, *results, *TIERS[name].options, *rest]


def main() -> None:
    """Becomes pytest; code 2 for an unknown tier."""
    try:
        arguments = pytest_arguments(sys.argv[1:])
    except UnknownTierError as error:
        print(f"doseki: {error}", file=sys.stderr)
        sys.exit(2)
    os.environ["OMP_NUM_THREADS"] = "1"
    # Hundreds of tests start a process, and each would compile all its imports.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.execv(sys.executable, [sys.executable, "-m", "pytest", *arguments])


if __name__ == "__main__":
    main()
