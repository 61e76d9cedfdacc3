"""`doseki validate`: run cases, tell how they go, write the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from ..figures.saving import Drawn
from ..solver.build import load_core
from ..util.files import clear_errors
from .case import Case
from .judging import Result, validate_case
from .picture import draw_result
from .report import write_report
from .running import in_precision


def validate(
    cases: Sequence[Case],
    how: Mapping[str, str],
    directory: Path,
    threads: int | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> list[Result]:
    """Run the cases one after another; the report is whole after each of them.

    `how`: what is asked of all of them, the `tier` and, where it is not that of the scenarios, the
    `precision`.
    """
    with clear_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
    core = load_core()
    before = core.threads()
    core.set_threads(threads or before)
    results, drawn = [], Drawn()
    try:
        for case in cases:
            with in_precision(how.get("precision")):
                result = validate_case(case, how["tier"], tell)
            results.append(result)
            if result.outcomes:
                drawn.add(directory / f"{case.name}.png", partial(draw_result, result))
            write_report(directory, results, how, {file.stem: file.name for file in drawn.pictures})
    finally:
        core.set_threads(before)
    for remark in drawn.remarks:
        tell(f"warning: {remark}")
    return results
