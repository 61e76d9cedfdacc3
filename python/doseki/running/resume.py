"""Goes on with a run from its last checkpoint."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import Any, TypeAlias

from ..driver.active_run import ActiveRun
from ..driver.checkpoint import Checkpoint, CheckpointFolder
from ..driver.identity import CHANGEABLE, identity_of
from ..driver.ranks import OneRank
from ..errors import UserError
from ..record.folder import RunFolder, read_history
from ..record.history import history_columns
from ..record.reader import load
from ..record.writer import Recorder
from ..scenario.load import load_scenario
from ..scenario.model import Scenario
from ..scenario.values.toml_source import Change
from ..scene.build import body_names
from ..util.files import write_whole_text
from ..util.sealed import check_seal, sealed
from ..util.toml_writer import to_toml
from .provenance import core_name, noted_files, read_provenance
from .runner import RunOptions, carry_out, run_scenario, write_reports

Overrides: TypeAlias = Sequence[str | Change]
NOTHING_YET = "no checkpoint was written yet; the run began anew"


def resume_run(
    directory: str | Path,
    overrides: Overrides = (),
    options: RunOptions | None = None,
    until: float = math.inf,
) -> tuple[dict[str, Any], list[str]]:
    """Goes on to the end; returns the summary, and sentences about damaged checkpoints.

    With the same threads or others, and no `overrides`, the record becomes that of a run that was
    never interrupted, bit for bit.  It goes on from the newest checkpoint at a time of at most
    `until`, s.  `overrides` are KEY=VALUE, or changes, for keys in CHANGEABLE.  Raises as
    run_scenario does, and UserError when there is nothing to go on from.
    """
    options = options or RunOptions()
    folder = load(directory).folder
    with options.ranks.holding(directory):
        is_sealed = options.ranks.on_root(lambda: check_seal(folder.scenario))
        checkpoints = CheckpointFolder(folder.checkpoints)
        has_begun = bool(checkpoints.files()) or folder.summary.is_file()
        if not options.ranks.agree(has_begun):
            return _begun_anew(folder, overrides, options), [f"{directory}: {NOTHING_YET}"]
        checkpoint, notes = checkpoints.read_last(until)
        if math.isfinite(until) and until > (reached := _reached(folder, checkpoint)):
            notes.append(
                f"--from {until:g}: the run has come to {reached:g} s; it goes on from its last "
                f"checkpoint, at {checkpoint.time:g} s"
            )
        if is_sealed:
            options.ranks.on_root(lambda: _check_identity(folder, checkpoint))
        scenario = _scenario(folder.scenario, overrides)
        if checkpoint.time >= scenario.time_max and folder.summary.is_file():
            options.ranks.on_root(lambda: _check_unfinished(folder, scenario.time_max))
            return _told(folder, options.ranks), notes
        options.ranks.on_root(lambda: _check_columns(folder.history, scenario))
        run = _restored(directory, scenario, checkpoint, notes, options.ranks)
        if overrides:
            # The last snapshot may have been made early, at the time_max of then.
            run.position.outputs = run.outputs.passed(checkpoint.time) + 1
            text = sealed(scenario.effective_toml(stored=True))
            options.ranks.on_root(lambda: write_whole_text(folder.scenario, text))
            run.identity = options.ranks.on_root(lambda: identity_of(folder.scenario))
        options.resumed()
        return carry_out(run, options, fresh=False), notes


def _reached(folder: RunFolder, checkpoint: Checkpoint) -> float:
    """The time that the run has come to, as far as its record tells, s."""
    return max([checkpoint.time, *load(folder.path).times])


def _check_unfinished(folder: RunFolder, time_max: float) -> None:
    """Raise UserError for a run that has come to its end and has told all of it."""
    if folder.trust.is_file() and folder.summary_text.is_file():
        raise UserError(
            f"{folder.path}: the run has reached time_max = {time_max:g} s; go further with "
            f"--set time_max=..., or draw its figures with doseki plot {folder.path}"
        )


def _told(folder: RunFolder, ranks: OneRank) -> dict[str, Any]:
    """The summary of a run that ended before it could write its reports, which are written."""
    remark = ranks.on_root(lambda: write_reports(folder.path))
    summary = dict(load(folder.path).summary)
    if remark:
        summary["warnings"] = [*summary.get("warnings", ()), remark]
    return summary


def _check_identity(folder: RunFolder, checkpoint: Checkpoint) -> None:
    """Raise UserError for a checkpoint of another run; one that does not say is taken as it is."""
    if checkpoint.scenario not in (None, identity_of(folder.scenario)):
        raise UserError(
            f"{folder.checkpoints / f'{checkpoint.step:012d}.h5'}: is a checkpoint of another run: "
            f"its scenario is not {folder.scenario}; bring back what belongs together"
        )


def _check_columns(history: Path, scenario: Scenario) -> None:
    """Raise UserError for a history whose header is not that of the rows to come."""
    found = read_history(history)[0]
    expected = history_columns(scenario.dim, scenario.material_names)
    if not found or found == expected:
        return
    for column, other in zip_longest(expected, found):
        if column != other:
            here = "it ends" if other is None else f"{other[:40]!r} stands"
            wanted = "nothing" if column is None else f"the column {column!r}"
            raise UserError(
                f"{history}, line 1: {here} where a run of this version has {wanted}; bring the "
                "file back as the run wrote it"
            )


def _begun_anew(folder: RunFolder, overrides: Overrides, options: RunOptions) -> dict[str, Any]:
    """The run again from its scenario: it was ended before it could write a checkpoint."""
    scenario = _scenario(folder.scenario, overrides)
    files: list[dict[str, str]] = []
    with suppress(UserError):
        files = options.ranks.on_root(lambda: noted_files(folder))
    return run_scenario(scenario, folder.path, replace(options, overwrite=True, files=files))


def _scenario(path: Path, overrides: Overrides) -> Scenario:
    """The scenario of the run, with overrides that do not contradict the state."""
    before, after = load_scenario(path), load_scenario(path, overrides)
    tables = before.model_dump(by_alias=True), after.model_dump(by_alias=True)
    changed = [key for key in tables[0] if _text(tables[0][key]) != _text(tables[1][key])]
    follows = {"time_history"} - after.model_fields_set  # from time_max
    if wrong := sorted(set(changed) - CHANGEABLE - follows):
        raise UserError(
            f"{wrong[0]} cannot change when a run is resumed; these can:"
            f" {', '.join(sorted(CHANGEABLE))}"
        )
    return after


def _text(value: Any) -> str:
    return to_toml({"value": value}) if value is not None else ""


def _is_core_of(directory: str | Path) -> bool:
    """Whether the run in a folder went on with this build of the core last, as far as is known."""
    try:
        entries = read_provenance(RunFolder(Path(directory)))
    except UserError:
        return True
    return not entries or entries[-1].get("core") in (None, core_name())


def _restored(
    directory: str | Path,
    scenario: Scenario,
    checkpoint: Checkpoint,
    notes: list[str],
    ranks: OneRank,
) -> ActiveRun:
    if scenario.material_names != checkpoint.material_names:
        raise UserError(f"{directory}: the scenario's materials are not those of its checkpoint")
    if body_names(scenario) != checkpoint.body_names:
        raise UserError(f"{directory}: the scenario's bodies are not those of its checkpoint")
    try:
        simulation, same_bits = ranks.restored_simulation(
            scenario, checkpoint.body_names, checkpoint.state
        )
    except ValueError as error:
        raise UserError(f"{directory}: {error}") from None
    if ranks.count > 1 or checkpoint.is_of_many_ranks:
        notes.append("the run is, or was, spread over ranks: results agree to rounding only")
    elif not (same_bits and _is_core_of(directory)):
        notes.append(
            "the checkpoint was written with another instruction set: results agree to rounding"
            f" only (DOSEKI_ISA chooses one; now {core_name()})"
        )
    position = checkpoint.position
    written = position.snapshots, position.rows, position.gauge_rows
    recorder = ranks.recorder(directory, lambda: Recorder.reopen(directory, *written))
    run = ActiveRun(scenario, simulation, recorder, checkpoint.body_names, ranks)
    try:
        run.go_on_from(checkpoint)
    except ValueError as error:
        raise UserError(f"{directory}: {error}") from None
    ranks.on_root(lambda: run.checkpoints.drop_later(checkpoint.step))
    return run
