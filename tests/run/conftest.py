"""A small run, uninterrupted, to compare with."""

from __future__ import annotations

from pathlib import Path

import pytest

from .channel import channel_text, run_channel


@pytest.fixture(scope="session")
def channel_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scenario file of the 2-D channel."""
    file = tmp_path_factory.mktemp("channel") / "channel.toml"
    file.write_text(channel_text())
    return file


@pytest.fixture(scope="session")
def uninterrupted(channel_file: Path) -> Path:
    """The folder of a run of the channel from beginning to end."""
    run_channel(channel_file, channel_file.parent / "straight")
    return channel_file.parent / "straight"
