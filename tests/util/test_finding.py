"""What is said alike of many copies is said once."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from doseki.util.finding import Finding, below, percent, sentences


@dataclass(frozen=True)
class Doubt(Finding):
    what: str

    def __str__(self) -> str:
        return f"{self.place}: {self.what}" if self.place else self.what


def test_copies_are_told_of_together():
    found = [Doubt(f"stone.{k}", "is small") for k in range(1, 13)]
    found += [Doubt("stone.3", "touches nothing"), Doubt("water", "is thin"), Doubt("", "is open")]
    found += [Doubt("rock.1", "is small"), Doubt("water", "is thin")]
    assert sentences(found) == [
        "stone.1 and 11 of its copies: is small",
        "stone.3: touches nothing",
        "water: is thin",
        "is open",
        "rock.1: is small",
    ]


@pytest.mark.parametrize(
    ("value", "said"), [(7.4, "7.4"), (7.99, "7.99"), (7.96, "7.96"), (7.9999995, "7.9999995")]
)
def test_what_is_below_a_limit_is_so_as_it_is_printed(value, said):
    assert below(value, 8) == said


@pytest.mark.parametrize(
    ("share", "said"), [(1.0, "100 %"), (0.997, "100 %"), (0.994, "99 %"), (0.0123, "1.2 %")]
)
def test_all_of_a_thing_is_100_per_cent(share, said):
    assert percent(share) == said
