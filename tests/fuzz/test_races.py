"""Processes that meet in one folder at random moments: one wins, no record is scrambled."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.run.channel import (
    assert_same_record,
    channel_text,
    command,
    doseki_command,
    environment,
    run_channel,
)

from doseki.errors import UserError
from doseki.record.reader import load

from .examples import examples

SHORT = "time_max=0.006"
OPTIONS = ("--threads", 1, "--no-figures")
DEEDS = ("run", "overwrite", "resume", "plot", "export", "kill")


@pytest.fixture(scope="module")
def channel(tmp_path_factory):
    """The scenario file, and beside it a run from beginning to end."""
    file = tmp_path_factory.mktemp("races") / "channel.toml"
    file.write_text(channel_text())
    run_channel(file, file.parent / "straight", SHORT)
    return file


def words_of(deed, file, folder):
    """The command line of what one of the processes does."""
    run = ("run", file, "-o", folder, *OPTIONS, "--set", SHORT, "--checkpoint-every", 0.001)
    return {
        "run": run,
        "overwrite": (*run, "--overwrite"),
        "resume": ("resume", folder, *OPTIONS),
        "plot": ("plot", folder),
        "export": ("export", folder, "--vtu"),
    }.get(deed)


@given(
    deeds=st.lists(st.sampled_from(DEEDS), min_size=1, max_size=4),
    moments=st.lists(st.floats(0, 2.5), min_size=4, max_size=4),
    begins_with=st.sampled_from(["nothing", "a run", "half a run"]),
)
@examples(2, 100)
def test_one_wins(channel, deeds, moments, begins_with):
    base = channel.parent / f"case{random.SystemRandom().getrandbits(48):x}"
    base.mkdir()
    try:
        race(channel, base / "run", deeds, moments, begins_with)
    finally:
        shutil.rmtree(base)


def race(file, folder, deeds, moments, begins_with):
    """Processes one after the other at these moments, s; then what is there goes on to its end."""
    if begins_with == "a run":
        shutil.copytree(file.parent / "straight", folder)
    elif begins_with == "half a run":
        run_channel(file, folder, SHORT, progress=lambda *_: (folder / "STOP").touch())
    started = []
    for wait, deed in sorted(zip(moments, ["overwrite", *deeds], strict=False)):
        time.sleep(wait / 4)
        if deed == "kill":
            for process in started[-1:]:
                process.send_signal(signal.SIGKILL)
            continue
        options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
        words = command(*words_of(deed, file, folder))
        started.append(subprocess.Popen(words, env=environment(), **options))
    for process in started:
        said = process.communicate()[1]
        assert process.returncode in (0, 2, -signal.SIGKILL), said
        assert "Traceback" not in said
        assert process.returncode != 2 or said.count("doseki: ") >= 1
    finish(file, folder)
    assert_same_record(folder, file.parent / "straight")


def finish(file, folder):
    """The run that is there goes on to its end, where it has not come there."""
    try:
        is_done = load(folder).summary.get("status") == "done"
    except UserError:
        is_done = False
    if is_done:
        return
    words = words_of("resume" if folder.exists() else "run", file, folder)
    done = doseki_command(*words)
    assert done.returncode == 0 or "has reached time_max" in done.stderr, done.stderr
