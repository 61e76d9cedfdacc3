"""The text that a page is made from: a scenario file, and how it is changed on the command line."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence

from doseki.scenario.load import load_scenario
from doseki.scenario.reading.files import find_scenario
from doseki.util.input_file import digest_of


def digest(scenario: str, settings: Sequence[str] = ()) -> str:
    """BLAKE2b of the scenario file, the files that it names and the settings, hexadecimal.

    A page whose digest is another one shows what an earlier text gave.
    """
    path = find_scenario(scenario)
    loaded = load_scenario(scenario, settings)
    files = sorted(each.digest for each in loaded.inputs)
    parts = [digest_of(path), *files, *settings]
    return hashlib.blake2b("\n".join(parts).encode(), digest_size=16).hexdigest()
