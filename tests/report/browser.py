"""Pages in a browser without a window: what they draw, and what they say of themselves."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
import zlib
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


def told(page: Path, asked: str, script: str, profile: Path, *options: str) -> list[Any]:
    """What a script in the page tells, once the view is drawn; the page is changed.

    The script may wait: `rest(ms)`, look up parts of the view: `part(name)`, and tell: `tell(any)`.
    """
    text = page.read_text(encoding="utf-8")
    changed = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text)
    assert changed != text
    changed = changed.replace("</body>", f"{SCRIPT.replace('SCRIPT', script)}</body>")
    page.write_text(changed, encoding="utf-8")
    said: list[Any] = _data(page, asked, "said", profile, *options)
    return said


SCRIPT = """
<script>
HTMLElement.prototype.setPointerCapture = () => {};
const rest = (ms) => new Promise((done) => setTimeout(done, ms));
const part = (name) => document.querySelector(`[data-part=${name}]`);
const said = [], tell = (what) => said.push(what);
(async () => {
  while (!window.doseki?.state().extent) await rest(50);
  SCRIPT
  document.body.dataset.said = JSON.stringify(said);
})();
</script>
"""


def text_of(page: Path, profile: Path, *options: str) -> str:
    """The HTML of the page as the browser has it in the end."""
    return _browse(page, "", "--dump-dom", *options, profile=profile)


def _data(page: Path, asked: str, name: str, profile: Path, *options: str) -> Any:
    text = _browse(page, asked, "--dump-dom", *options, profile=profile)
    found = re.search(f'data-{name}="([^"]*)"', text)
    assert found, f"the page has no data-{name}"
    return json.loads(html.unescape(found[1]))


def picture_of(page: Path, asked: str, profile: Path) -> np.ndarray:
    """The page as pixels (height, width, 3)."""
    path = profile.with_suffix(".png")
    _browse(page, asked, f"--screenshot={path}", profile=profile)
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def printed(page: Path, profile: Path, *options: str) -> list[np.ndarray]:
    """The pictures of the page on paper, as pixels (height, width, 3)."""
    path = profile.with_suffix(".pdf")
    _browse(page, "", f"--print-to-pdf={path}", *options, profile=profile)
    data = path.read_bytes()
    head = rb"/Width (\d+)\n/Height (\d+)\n[^>]*/Filter /FlateDecode\n/Length (\d+)>>\s*stream\r?\n"
    pictures = []
    for found in re.finditer(head, data):
        width, height, length = map(int, found.groups())
        pixels = zlib.decompress(data[found.end() : found.end() + length])
        pictures.append(np.frombuffer(pixels, np.uint8).reshape(height, width, -1).astype(int))
    return pictures
