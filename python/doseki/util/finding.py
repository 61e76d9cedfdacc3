"""What is doubtful about a scenario."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass


@dataclass(frozen=True)
class Finding(ABC):
    """Something doubtful: the fields hold the facts, str() is the sentence made from them."""

    place: str  # the body, or the key, that it is about; "" for all of the scenario

    @abstractmethod
    def __str__(self) -> str:
        """One sentence, with the remedy where there is one."""
