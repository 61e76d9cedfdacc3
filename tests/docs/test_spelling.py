"""Pages are spelt right.

Words in lower case must be in a dictionary of English or in docs/words.txt, where words of the
field and British spellings stand; names are not checked. Known misspellings are found everywhere.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator

import pytest
from spellchecker import SpellChecker

from .markdown import ROOT, markdown_files, prose_of

OWN_WORDS = ROOT / "docs" / "words.txt"
WORD = re.compile(r"(?<![\w.])[A-Za-z][A-Za-z']*(?!\w)")


@pytest.fixture(scope="module")
def known():
    """All words that may stand in a page."""
    own = OWN_WORDS.read_text(encoding="utf-8").split()
    return {*SpellChecker(language="en").word_frequency.dictionary, *own}


def unknown_words(text: str, known: set[str]) -> Iterator[str]:
    """Words in lower case that are not known."""
    for prose in prose_of(text):
        for word in WORD.findall(prose):
            plain = word.strip("'").removesuffix("'s")
            if len(plain) > 2 and plain.islower() and plain not in known:
                yield plain


def test_words_are_known(known):
    found = {
        f"{path.relative_to(ROOT)}: {word}"
        for path in markdown_files()
        for word in unknown_words(path.read_text(encoding="utf-8"), known)
    }
    assert not found, f"misspelt, or to be added to docs/words.txt: {sorted(found)}"


def test_a_misspelt_word_is_found(known):
    text = "# The chanel\n\nA rouhg bed, `not_codde`, $\\frok$ and Keulegan's neighbour.\n"
    assert list(unknown_words(text, known)) == ["rouhg"]


def test_own_words_are_sorted():
    words = OWN_WORDS.read_text(encoding="utf-8").split()
    assert words == sorted(set(words))


@pytest.mark.parametrize("text", [None, "It is seperate.\n"])
def test_known_misspellings(tmp_path, text):
    paths = [str(path) for path in markdown_files()]
    if text is not None:
        (tmp_path / "page.md").write_text(text)
        paths = [str(tmp_path / "page.md")]
    command = [sys.executable, "-m", "codespell_lib", "-I", str(OWN_WORDS), *paths]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode == 0) == (text is None), ended.stdout
