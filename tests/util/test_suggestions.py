"""What is said of a name that is not known."""

from __future__ import annotations

import pytest

from doseki.util.spelling import MAX_LISTED, suggestion


@pytest.mark.parametrize("name", ["DP", "Dp", "dp "])
def test_capitals_do_not_matter(name):
    assert suggestion(name, ["dp", "eta", "Q"]) == "; did you mean dp?"
    assert suggestion("q", ["dp", "eta", "Q"]) == "; did you mean Q?"


def test_what_is_listed_is_in_order():
    assert suggestion("?", ["zeta", "eta", "dp"]) == "; known: dp, eta, zeta"


def test_of_much_only_what_is_alike_is_listed():
    """Names that have nothing in common with it help nobody."""
    names = [f"{letter}{k}" for letter in "nmo" for k in range(9)]
    assert len(names) > MAX_LISTED
    assert suggestion("mist", names) == ""
    assert suggestion("mist", [*names, "mixture"]) == "; nearest: mixture"
