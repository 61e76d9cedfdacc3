"""The page: one file that asks nothing of the network."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from .markup import Content, Markup, tag
from .view.scene import Scene

BROWSER = Path(__file__).resolve().parent / "browser"
SCRIPTS = (
    "unpack", "algebra", "camera", "shaders", "shapes", "painter", "controls", "legend", "panel",
    "viewer",
)  # fmt: skip
GENERATOR = "doseki report"
TURN = "Drag to turn, with shift or two fingers to move"
MOVE = "Drag to move"
KEYS = "The particles of the run. Arrow keys {}, + and - zoom, space plays."
HINT = "; pinch to zoom, or use the wheel after a click; double-click to go back."


def page(title: str, content: Sequence[Content], scene: Scene | None) -> str:
    """The HTML of a report; the script is there only where a scene is."""
    style, script = _style(), _script() if scene is not None else ""
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", http_equiv="Content-Security-Policy", content=_policy(style, script)),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="generator", content=GENERATOR),
        tag("meta", name="referrer", content="no-referrer"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        Markup(f"<style>{style}</style>"),
    )
    data = None if scene is None else _data(scene)
    code = Markup(f"<script>{script}</script>") if scene is not None else None
    body = tag("body", tag("main", content), data, code)
    return f'<!DOCTYPE html>\n<html lang="en">{head}{body}</html>\n'


def viewer(scene: Scene) -> Markup:
    """The interactive view; browser/viewer.js fills it, and shows it where it can."""
    part, is_flat = _part, scene.table["dim"] == 2
    overlay = [
        part("div", "legend", class_="legend"),
        part("div", "bar", class_="bar"),
        part("svg", "axes", class_="axes", viewBox="0 0 80 80", aria_hidden="true"),
    ]
    picture = part(
        "canvas", "picture", tabindex="0", role="img",
        aria_label=KEYS.format("move" if is_flat else "turn"),
    )  # fmt: skip
    times = [
        part("button", "play", "▶ Play", type="button"),
        part("input", "time", type="range", min="0", max="0", value="0", aria_label="Time"),
        part("output", "clock", ""),
    ]
    views = [
        part("button", name, text, type="button")
        for name, text in (
            ("top", "Top"), ("front", "Front"), ("side", "Side"), ("home", "Reset"),
            ("whole", "Full screen"),
        )
    ]  # fmt: skip
    colour = tag("label", "Colour ", part("select", "field"))
    hints = [
        tag("p", MOVE if is_flat else TURN, HINT, class_="hint"),
        tag("p", " ".join(scene.notes)) if scene.notes else None,
    ]
    return tag(
        "section",
        tag("h2", "The flow"),
        tag(
            "div",
            tag("div", picture, part("canvas", "paper"), overlay, class_="stage"),
            tag("div", times, class_="times"),
            tag(
                "div",
                colour,
                part("span", "layers", class_="layers"),
                tag("span", views),
                class_="tools",
            ),
            tag("div", hints, class_="hints small"),
            id="viewer",
            class_="flat" if is_flat else None,
            hidden=True,
        ),
        tag("noscript", tag("p", "The interactive view needs JavaScript; the figures do not.")),
        id="view",
    )


def _part(name: str, part: str, /, *content: Content, **attributes: str | None) -> Markup:
    """An element that the script finds by the name `part`."""
    return tag(name, *content, data_part=part, **attributes)


def _data(scene: Scene) -> Markup:
    """The scene as blocks that are no scripts."""
    table = f'<script type="application/json" id="scene">{scene.table_text()}</script>'
    blocks = (
        f'<script type="text/plain" id="{name}">{text}</script>'
        for name, text in scene.blocks.items()
    )
    return Markup(table + "\n".join(blocks))


def _policy(style: str, script: str) -> str:
    """Nothing is fetched; only this style and this script count."""
    return (
        f"default-src 'none'; img-src data:; style-src '{_digest(style)}'; "
        f"script-src {_quoted(script)}; base-uri 'none'; form-action 'none'"
    )


def _quoted(script: str) -> str:
    return f"'{_digest(script)}'" if script else "'none'"


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode()


@cache
def _style() -> str:
    return (BROWSER / "page.css").read_text(encoding="utf-8")


@cache
def _script() -> str:
    """All files of the viewer as one, strict, and without a name in common with anything else."""
    files = [(BROWSER / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS]
    return '(() => {\n"use strict";\n' + "\n".join(files) + "})();\n"
