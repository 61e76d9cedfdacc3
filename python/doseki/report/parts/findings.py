"""How far the run can be trusted, what was doubtful about it, and why it failed."""

from __future__ import annotations

from typing import Any

from ...assess.failure.failure import explanation
from ...assess.trust.report import trust_lines
from ...assess.trust.verdicts import BAD, DOUBTFUL, GOOD
from ...errors import UserError
from ...record.reader import Run
from ...util.sealed import changed_by_hand
from ..markup import Content, Markup, section, tag

CLASSES = {GOOD: "good", DOUBTFUL: "doubtful", BAD: "bad"}


def findings(run: Run) -> Markup | None:
    """The section of the verdicts, the warnings and the failure."""
    changed = changed_by_hand(run.folder.scenario)
    told = [*([changed] if changed else []), *_list(run.summary.get("warnings"))]
    warnings = [tag("li", str(text)) for text in told]
    return section(
        "How far to trust it",
        _failure(run),
        _verdicts(run),
        [tag("h3", "Warnings"), tag("ul", warnings)] if warnings else None,
        name="trust",
    )


def _failure(run: Run) -> Content:
    if not run.folder.failure.is_file():
        return None
    return [tag("h3", "Why it failed"), tag("pre", explanation(run.folder))]


def _verdicts(run: Run) -> Content:
    if not run.trust:
        return tag("p", "There is no trust report: a run is judged when it has come to its end.")
    try:
        lines = list(trust_lines(run.trust))
    except (KeyError, TypeError, ValueError, IndexError):
        raise UserError(f"{run.folder.trust}: is not a trust report of doseki") from None
    rows = []
    for word, text in lines:
        badge = tag("span", word, class_=f"badge {CLASSES.get(word, '')}".strip())
        rows.append(tag("li", badge, " ", text))
    return tag("ul", rows, class_="verdicts")


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
