"""Where a run is worked out: on the processor, or on a graphics card."""

from __future__ import annotations

from collections.abc import Callable

from ..compiled import card_here, load_core, module_is_chosen, use_device
from ..driver.ranks import OneRank
from ..driver.start.first_state import with_checkpoint
from ..record.reader import Run
from ..scenario.model import Scenario
from ..scene.build import build_bodies

# Particles below which a card is left alone: one of 132 multiprocessors needs tens of thousands of
# threads to hide the time that memory takes.  Not measured on a card.
FEWEST = 50_000


def choose_device(
    name: str, count: Callable[[], int], ranks: OneRank, say: Callable[[str], None]
) -> None:
    """Let the core of a device work on what follows: "cpu", "host", "cuda" or "auto".

    "auto" takes a card where there is one, the core was built for it and `count` particles are
    enough for it, and says so.  Each rank of a machine takes a card of its own while there are
    enough.  Raises UserError where the core was not built for the device, and ResourceError where
    there is no card.
    """
    if name == "auto":
        name = ranks.on_root(lambda: _chosen(count, say))
    use_device(name)
    if name == "cuda":
        load_core().use_card(ranks.rank_on_machine)


def _chosen(count: Callable[[], int], say: Callable[[str], None]) -> str:
    card = None if module_is_chosen() else card_here()
    if card is None:
        return "cpu"
    particles = count()
    if particles < FEWEST:
        say(
            f"on the processor: {particles:,} particles are too few for the {card.name}"
            f" (fewer than {FEWEST:,}); --device cuda takes it all the same"
        )
        return "cpu"
    say(f"on the {card.name}; --device cpu leaves it alone")
    return "cuda"


def rehearsed(name: str, say: Callable[[str], None]) -> str:
    """The device on which to try what is to run on the device of this name elsewhere."""
    if name != "cuda" or card_here() is not None:
        return name
    say(
        "warning: there is no graphics card here: its code runs on the processor, whose wall time"
        " this is; that of a card is the updates over its rate (doseki bench --isa cuda)"
    )
    return "host"


def count_of_scene(scenario: Scenario) -> int:
    """The particles that a run begins with, without those of terrain."""
    if (earlier := with_checkpoint(scenario)) is not None:
        return len(earlier.snapshot["id"])
    return len(build_bodies(scenario)[0])


def count_of_record(run: Run) -> int:
    """The particles of the last snapshot of a run; none before the first one."""
    return len(run[-1]["id"]) if len(run) else 0


def card_doubts(memory: float) -> list[str]:
    """What is to be said of a run that takes so many bytes on the card of this process."""
    card = card_here()
    if load_core().__name__ != "doseki._core_cuda" or card is None or memory <= card.memory:
        return []
    return [
        f"the run takes {memory / 1e9:.3g} GB and the {card.name} has {card.memory / 1e9:.3g} GB:"
        " what does not fit is fetched from the machine's memory again and again; take a larger"
        ' dp, precision = "mixed", or several ranks with a card each'
    ]
