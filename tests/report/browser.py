"""Pages in a browser without a window: what they draw, and what they say of themselves."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
SIZE = 900, 1400  # pixels of the window
# Milliseconds of the page's own clock, which runs ahead while nothing happens.
OPTIONS = (
    "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", f"--window-size={SIZE[0]},{SIZE[1]}", "--virtual-time-budget=20000",
)  # fmt: skip


def _browse(page: Path, asked: str, *options: str, profile: Path) -> str:
    assert CHROMIUM
    command = [
        CHROMIUM,
        *OPTIONS,
        f"--user-data-dir={profile}",
        *options,
        f"{page.as_uri()}#{asked}",
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def state_of(page: Path, asked: str, profile: Path) -> dict[str, Any]:
    """What the view says of itself, when it was asked for something by the address."""
    return _data(page, asked, "state", profile)


def told(page: Path, asked: str, profile: Path) -> list[dict[str, Any]]:
    """What a script of a test has put down in the page."""
    return _data(page, asked, "said", profile)


def _data(page: Path, asked: str, name: str, profile: Path) -> Any:
    text = _browse(page, asked, "--dump-dom", profile=profile)
    found = re.search(f'data-{name}="([^"]*)"', text)
    assert found, f"the page has no data-{name}"
    return json.loads(html.unescape(found[1]))


def picture_of(page: Path, asked: str, profile: Path) -> np.ndarray:
    """The page as pixels (height, width, 3)."""
    path = profile.with_suffix(".png")
    _browse(page, asked, f"--screenshot={path}", profile=profile)
    return np.asarray(Image.open(path).convert("RGB")).astype(int)
