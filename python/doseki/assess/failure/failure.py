"""Why a run failed: which particle, what acted on it, what to change."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...driver.active_run import ActiveRun
from ...errors import DosekiError, UserError
from ...record.folder import RunFolder
from ...record.lock import holder_of
from ...record.reader import load
from ...record.writer import jsonable
from ...solver.protocol import ForceTerms
from ...util.files import write_whole_text
from ...util.finding import place_text
from ...util.foreign import REMEDY, read_json_table
from .neighbours import neighbours_of
from .remedy import remedy

EXHAUSTED = "exhausted"  # memory or disk: no failure of the core
NEIGHBOURS = 6  # listed, nearest first
PARTICLE_FIELDS = (
    "position",
    "velocity",
    "density",
    "pressure",
    "mass",
    "smoothing_length",
    "sound_speed",
)

# What each kind of failure of the core means.
KINDS = {
    "density": "its density left the range from 0.1 to 10 times that at rest",
    "speed": "its speed is over ten times the largest sound speed",
    "timestep": "it lets the timestep collapse below 1e-4 of that of matter at rest",
    "outside": "it is far outside the domain",
    "not_finite": "its state, acceleration or density rate is not a finite number",
    "empty": "no particle is left in the domain",
    "unresolved": "too few particles lie beside one of a body that deforms",
}


@dataclass
class Failure:
    """A failure as the core saw it, and what it comes to."""

    kind: str
    particle: int  # id, or -1
    position: Sequence[float]  # of the particle, m; empty without one
    message: str
    state: dict[str, np.ndarray]  # when it was noticed, in the middle of a step
    time: float
    steps: int  # whole ones before it
    rewound: bool = False  # whether the simulation is back at the step before it
    advice: str = ""


def explain_failure(run: ActiveRun, failure: Failure) -> dict[str, Any]:
    """Examine the last good state, which the simulation of `run` holds; write failure.json."""
    scenario, good = run.scenario, run.simulation.state()
    terms = run.simulation.force_terms(failure.particle) if failure.rewound else None
    if not run.ranks.is_root:
        return {}
    report: dict[str, Any] = {
        "kind": failure.kind,
        "meaning": KINDS.get(failure.kind, failure.kind),
        "message": failure.message,
        "time": run.simulation.time if failure.rewound else failure.time,
        "step": run.simulation.steps if failure.rewound else failure.steps,
        "initial_speed": _initial_speed(run.folder),
        "good_state": _newest(run) if failure.rewound else None,
    }
    index = np.flatnonzero(good["id"] == failure.particle)
    after = np.flatnonzero(failure.state["id"] == failure.particle)
    if len(index) and len(after):
        names = scenario.material_names, run.body_names
        report["particle"] = _particle(good, int(index[0]), *names)
        report["became"] = _particle(failure.state, int(after[0]), *names)
        report["neighbours"] = _neighbours(run, good, int(index[0]))
        report |= _forces(terms, run.simulation.timestep) if terms else {}
    failure.advice = report["advice"] = remedy(report, scenario, run.warnings)
    write_whole_text(run.folder.failure, json.dumps(jsonable(report), indent=1) + "\n")
    return report


def _initial_speed(folder: RunFolder) -> float:
    """The largest speed in the first snapshot, m/s."""
    return float(np.linalg.norm(load(folder.path)[0]["velocity"], axis=1).max(initial=0.0))


def _newest(run: ActiveRun) -> str | None:
    files = run.checkpoints.files()
    return files[-1].name if files else None


def _particle(
    state: dict[str, np.ndarray], k: int, materials: list[str], bodies: list[str]
) -> dict[str, Any]:
    known = {field: state[field][k].tolist() for field in PARTICLE_FIELDS}
    return {
        "id": int(state["id"][k]),
        "body": bodies[state["body"][k]],
        "material": materials[state["material"][k]],
        "motion": ("free", "fixed", "driven", "bound")[state["motion"][k]],
        "speed": float(np.linalg.norm(state["velocity"][k])),
        **known,
    }


def _forces(terms: ForceTerms, taken: float) -> dict[str, Any]:
    """What acted on the particle, and what limited its timestep; `taken`: that of the step, s."""
    sizes = {name: float(np.linalg.norm(a)) for name, a in terms["acceleration"].items()}
    limits = terms["timestep"]
    if not sizes:  # nothing acts on a particle that does not move freely
        return {}
    return {
        "acceleration": sizes,
        "largest_term": max(sizes, key=lambda name: sizes[name]),
        "timestep": limits | {"taken": taken},
        "limited_by": min(limits, key=lambda name: limits[name]),
    }


def _neighbours(run: ActiveRun, state: dict[str, np.ndarray], k: int) -> list[dict[str, Any]]:
    """The nearest particles."""
    near, distances = neighbours_of(run.scenario, state, k)
    return [
        {
            "id": int(state["id"][j]),
            "body": run.body_names[state["body"][j]],
            "material": run.scenario.material_names[state["material"][j]],
            "distance": float(distance),
            "relative_speed": float(np.linalg.norm(state["velocity"][j] - state["velocity"][k])),
        }
        for j, distance in zip(near[:NEIGHBOURS], distances[:NEIGHBOURS], strict=True)
    ]


def note_exhausted(run: ActiveRun, message: str) -> None:
    """Keep what ran out and ended a run, if there is room for that; of ranks these tell it."""
    if run.ranks.count > 1:
        return
    report = {
        "kind": EXHAUSTED,
        "message": message,
        "advice": f"Make room, then doseki resume {run.folder.path} goes on.",
        "time": run.simulation.time,
        "step": run.simulation.steps,
    }
    with suppress(DosekiError):
        write_whole_text(run.folder.failure, json.dumps(jsonable(report), indent=1) + "\n")


def explanation(folder: RunFolder) -> str:
    """Why a recorded run failed, or ended early, as one paragraph; raises UserError if neither."""
    if not folder.failure.is_file():
        return _without_failure(folder)
    report = read_json_table(folder.failure)
    try:
        return paragraph(report)
    except (ValueError, LookupError, TypeError, AttributeError):
        raise UserError(f"{folder.failure}: no report of a failure by doseki; {REMEDY}") from None


def _without_failure(folder: RunFolder) -> str:
    """Why a run that did not fail ended early; raises UserError if it did not."""
    summary = load(folder.path).summary
    status = summary.get("status")
    if status == "done":
        raise UserError(f"{folder.path}: this run has not failed: it came to its end")
    if holder := holder_of(folder.path):
        raise UserError(f"{folder.path}: this run has not failed: it is going on, in {holder}")
    if status is None:
        how = "ended before it could say why: it was killed, or memory or disk ran out"
    else:
        by = summary.get("stopped_by")
        how = f"has not failed: it was {status}{f' by {by}' if by else ''}"
    return f"The run {how}. doseki resume {folder.path} goes on."


def paragraph(report: dict[str, Any]) -> str:
    """A report in words."""
    if report["kind"] == EXHAUSTED:
        when = f"after step {report['step']}, at t = {report['time']:.6g} s"
        return f"The run was stopped {when}: {report['message']}. {report['advice']}"
    if report["kind"] == "rank":
        return f"{report['who']} failed: {report['message']}. {report['advice']}"
    said = [f"The run failed after step {report['step']}, at t = {report['time']:.6g} s."]
    if particle := report.get("particle"):
        said.append(_particle_sentence(report, particle, report["became"]))
    if neighbours := report.get("neighbours"):
        nearest = neighbours[0]
        said.append(
            f"Its nearest neighbour is particle {nearest['id']} ({nearest['material']}, body"
            f" {nearest['body']}), {nearest['distance']:.3g} m away, at a relative speed of"
            f" {nearest['relative_speed']:.3g} m/s."
        )
    if largest := report.get("largest_term"):
        strength = _text(report["acceleration"][largest])
        said.append(
            f"The largest term of its acceleration was {largest.replace('_', ' ')}, {strength}"
            f" m/s2; its timestep was limited by {report['limited_by']},"
            f" {_text(report['timestep'][report['limited_by']])} s."
        )
    said.append(report["advice"])
    if report.get("good_state"):
        said.append(
            f"The state of the step before is checkpoints/{report['good_state']}; doseki resume"
            " goes on from it, or with --from SECONDS from an earlier one."
        )
    return " ".join(said)


def _particle_sentence(report: dict[str, Any], good: dict[str, Any], bad: dict[str, Any]) -> str:
    place = place_text(good["position"])
    return (
        f"Particle {good['id']} ({good['material']}, body {good['body']}) at ({place}) m:"
        f" {report['meaning']}. Its speed went from {_text(good['speed'])} to"
        f" {_text(bad['speed'])} m/s and its density from {_text(good['density'])} to"
        f" {_text(bad['density'])} kg/m3."
    )


def _text(value: float | None) -> str:
    """JSON has no NaN; it was stored as null."""
    return "nan" if value is None else f"{value:.4g}"
