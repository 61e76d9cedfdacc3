"""What was run and how it went."""

from __future__ import annotations

from ...assess.summary import key_rows, title_of
from ...record.reader import Run
from ..markup import Content, Markup, section, tag, terms

HOW = {
    "done": "ran to its end",
    "stopped": "was stopped before its end",
    "failed": "failed",
    "": "has not ended (it is going on, or was killed)",
}


def heading(run: Run) -> Markup:
    """Title, and in one line what kind of run it is and how it ended."""
    said = run.scenario
    status = str(run.summary.get("status", ""))
    times = run.times
    end = f"{times[-1]:.4g} s of {said['time_max']:.4g} s" if len(times) else "nothing recorded"
    kind = f"{said['dim']}-D, scheme {said.get('scheme', '')}"
    line = f"{kind}; simulated {end}; {HOW.get(status, status)}"
    return tag("header", tag("h1", str(title_of(run))), tag("p", line, class_="subtitle"))


def facts(run: Run) -> Markup | None:
    """The section of the summary."""
    about: Content = None
    if text := str(run.scenario.get("description", "")).strip():
        about = [tag("p", " ".join(part.split())) for part in text.split("\n\n")]
    return section("Summary", about, terms(key_rows(run)), name="summary")
