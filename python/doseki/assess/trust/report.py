"""The report on a run, trust.json; docs/trust.md says what is counted."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from ...record.reader import Run
from ...record.writer import jsonable
from ...scenario.schemes import UETA2022
from ...util.files import write_whole_text
from ..sound_speed import sound_speed_from
from .balances import contact_energy_check, energy_check, momentum_check
from .checks import (
    contact_check,
    density_check,
    depth_check,
    mach_check,
    overlap_check,
)
from .deformable import deformable_checks
from .faces import faces_check
from .ground import ground_check
from .inflows import inflows_check
from .ledger import ledger_of
from .snapshots import is_resolved, look
from .tension import tension_check
from .verdicts import BAD, DOUBTFUL, GOOD, NOT_AVAILABLE, Check, overall


def trust_checks(run: Run) -> list[Check]:
    """Every check of a recorded run."""
    seen, scenario = look(run), run.scenario
    given, tension = sound_speed_from(run), scenario.get("tension", "clamp_fluid")
    scheme = scenario.get("scheme", UETA2022)
    return [
        mach_check(seen, *given),
        density_check(seen, tension, *given, scheme),
        energy_check(run, seen),
        *(ledger.numerical_checks() if (ledger := ledger_of(run)) is not None else []),
        momentum_check(run, seen),
        depth_check(run, seen),
        *ground_check(run),
        *inflows_check(run),
        contact_check(seen, *given),
        *deformable_checks(run, seen),
        *contact_energy_check(run, seen),
        *([tension_check(seen.tension)] if is_resolved(scenario) else []),
        *(faces_check(run) if is_resolved(scenario) else []),
        *([overlap_check(run, seen)] if seen.bodies_move else []),
    ]


def write_trust(run: Run) -> list[Check]:
    """Judge a run and put the report into DIR/trust.json."""
    checks = trust_checks(run)
    report = {"verdict": overall(checks), "checks": [asdict(check) for check in checks]}
    text = json.dumps(jsonable(report), indent=2, allow_nan=False) + "\n"
    write_whole_text(run.folder.trust, text)
    return checks


def trust_lines(report: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """(verdict, text) of a report as read from trust.json; good checks share a line."""
    checks = report["checks"]
    for word in (BAD, DOUBTFUL):
        for check in checks:
            if check["verdict"] == word:
                limit = check["limits"][0]
                said = f"{_said(check)}, good is {limit:.3g}: {check['remedy']}"
                yield word, said
    good = [_said(check) for check in checks if check["verdict"] == GOOD]
    unknown = [check["name"] for check in checks if check["verdict"] == NOT_AVAILABLE]
    yield from (
        (word, "; ".join(of)) for word, of in ((GOOD, good), (NOT_AVAILABLE, unknown)) if of
    )


def _said(check: Mapping[str, Any]) -> str:
    value = check["value"]
    return f"{check['name']} {'not finite' if value is None else format(value, '.2g')}"
