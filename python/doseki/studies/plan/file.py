"""Reading a study file: TOML, checked table by table, and against the scenario that it runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from ...errors import UserError
from ...scenario.checks.references import check_name
from ...scenario.load import load_scenario
from ...scenario.model import Scenario
from ...scenario.reading.messages import to_user_error
from ...scenario.reading.resolve import CHOICES
from ...scenario.reading.units import unit_of
from ...scenario.table import Table
from ...scenario.values.toml_source import KeyPath, TomlSource, Where, dotted, read_toml
from ...scenario.values.units import Unit, quantity
from ...util.spelling import suggestion
from ..reading.bands import BANDS, Band
from ..reading.kinds import Refuse, objection_of
from ..reading.observations import OBSERVATIONS, Observation
from ..reading.results import RESULTS, Result
from .axes import Axis, written
from .sampling import Point, grid_size, points, remarks
from .tables import MOST_RUNS, Calibrate, Cluster, Sample, StudyTable, Vary

T = TypeVar("T", bound=Table)
KINDS: dict[str, Mapping[str, type[Table]]] = {
    "result": RESULTS,
    "observation": OBSERVATIONS,
    "bands": BANDS,
}


@dataclass(frozen=True)
class Plan:
    """A study that has been read and checked.

    Attributes:
        text: of its file.
        folder: to which names of files in it are relative.
        top: its top level.
        scenario_name: as `load_scenario` takes it.
        settings: KEY=VALUE that all runs have.
        axes: what differs.
        sample, calibrate, cluster: tables of these names; None where there are none.
        results, observations, bands: tables by name.
        scenario: that of a run in the middle of all ranges.
        remarks: what is to be said of it beforehand.

    """

    text: str
    folder: Path
    top: StudyTable
    scenario_name: str
    settings: list[str]
    axes: list[Axis]
    sample: Sample | None
    calibrate: Calibrate | None
    cluster: Cluster | None
    results: dict[str, Result]
    observations: dict[str, Observation]
    bands: dict[str, Band]
    scenario: Scenario
    remarks: list[str]

    def settings_of(self, point: Point) -> list[str]:
        """KEY=VALUE of the run at a point."""
        own = [axis.setting(value) for axis, value in zip(self.axes, point, strict=True)]
        return [*self.settings, *own]

    def points(self) -> list[Point]:
        """Those of the sample; none without one."""
        return [] if self.sample is None else points(self.axes, self.sample)

    def units(self) -> dict[str, str]:
        """The unit of each result."""
        return {name: result.unit(self.scenario) for name, result in self.results.items()}


def read_plan(path: Path, folder: Path | None = None) -> Plan:
    """Read and check a study file; raises UserError with one clear sentence.

    `folder` is that to which it is relative, where it is not its own.
    """
    source = read_toml(path)
    reader = _Reader(source, Where([source]))
    top = reader.top()
    sample = reader.single("sample", Sample)
    calibrate = reader.single("calibrate", Calibrate)
    cluster = reader.single("cluster", Cluster)
    axes = reader.axes()
    parts = {name: reader.parts(name) for name in KINDS}
    reader.check_together(sample, calibrate, parts)
    home = path.parent if folder is None else folder
    named = top.scenario
    is_file = "/" in named or named.endswith(".toml")
    scenario_name = str(home / named) if is_file else named
    given = reader.settings(top)
    settings = [f"{name}={written(value)}" for name, value in given.items()]
    reader.check_settings(given, axes)
    scenario = _middle(scenario_name, settings, axes, reader.where)
    axes = [replace(axis, key_unit=_unit_of_key(axis.name, scenario)) for axis in axes]
    warnings = _checked_parts(parts, scenario, home, reader)
    return Plan(
        source.text, home.resolve(), top, scenario_name, settings, axes, sample,
        calibrate, cluster, parts["result"], parts["observation"],
        parts["bands"], scenario,
        warnings + ([] if sample is None else remarks(sample)),
    )  # fmt: skip


def _unit_of_key(name: str, scenario: Scenario) -> str:
    """The unit of numbers at a key: that which a parameter declares, or that of all scenarios."""
    parameter = name.removeprefix("parameters.").removesuffix(".value")
    if parameter in scenario.parameters:
        return scenario.parameters[parameter].unit
    return unit_of(name, scenario.dim)


class _Reader:
    """Turns the tables of one file into objects, and says where in it something is wrong."""

    def __init__(self, source: TomlSource, where: Where) -> None:
        self._source, self._table, self.where = source, source.table, where

    def top(self) -> StudyTable:
        return self._validated(StudyTable, self._table, ())

    def single(self, name: str, kind: type[T]) -> T | None:
        given = self._table.get(name)
        return (
            None
            if given is None
            else self._validated(kind, self._as_table(given, (name,)), (name,))
        )

    def parts(self, section: str) -> dict[str, Any]:
        """The tables of a section whose kind is told by a word."""
        found = {}
        for name, given in self._table.get(section, {}).items():
            keys = (section, name)
            check_name(section, name, self.where)
            table = self._as_table(given, keys)
            found[name] = self._validated(self._kind(table, keys), table, keys)
            if objection := objection_of(found[name]):
                raise self.refuse(keys)(*objection)
        return found

    def axes(self) -> list[Axis]:
        """What differs between runs; a path may stand in quotes or not."""
        fields = set(Vary.model_fields)
        given = _flat(self._table.get("vary", {}), lambda _, table: bool(fields & set(table)))
        return [self._axis(name, table) for name, table in given.items()]

    def settings(self, top: StudyTable) -> dict[str, Any]:
        """What all runs have, by paths as --set takes them; a table { ... } is one value."""
        return _flat(top.set, lambda path, _: self._source.assigns(("set", path)))

    def refuse(self, keys: KeyPath) -> Refuse:
        """What makes an error about a key of the table at `keys`."""
        return lambda key, reason: self.where.error(
            (*keys, key), f"{dotted((*keys, key))}: {reason}"
        )

    def check_together(
        self, sample: Sample | None, calibrate: Calibrate | None, parts: Mapping[str, Any]
    ) -> None:
        """Raise where tables do not go together."""
        axes = self.axes()
        if not axes:
            raise self.where.error(
                ("vary",), "nothing differs between runs: give a table [vary.KEY]"
            )
        if sample is None and calibrate is None:
            raise self.where.error(("sample",), "give a table [sample], or [calibrate]")
        if not (parts["result"] or parts["observation"] or parts["bands"]):
            raise self.where.error(("result",), "nothing is read of the runs: give a [result.NAME]")
        if sample is not None:
            self._check_sample(sample, axes)
        if calibrate is not None:
            self._check_calibrate(calibrate, axes, parts)
        for name, band in parts["bands"].items():
            if band.max_score is not None and not parts["observation"]:
                raise self.refuse(("bands", name))("max_score", "there is no [observation]")

    def check_settings(self, given: Mapping[str, Any], axes: list[Axis]) -> None:
        """Raise where what varies has a value of its own."""
        for axis in axes:
            if axis.name in given:
                raise self.where.error(("set", axis.name), f"set.{axis.name}: it varies, too")

    def _check_sample(self, sample: Sample, axes: list[Axis]) -> None:
        refuse = self.refuse(("sample",))
        if sample.kind != "grid":
            if sample.count is None:
                raise refuse("count", f'is missing: kind = "{sample.kind}" needs a number of runs')
            for axis in axes:
                if axis.count is not None:
                    raise self.refuse(("vary", axis.name))("count", "goes with a grid")
            return
        for key in ("count", "seed"):
            if getattr(sample, key) is not None:
                raise refuse(key, "does not go with a grid, whose axes say how many runs there are")
        for axis in axes:
            if not axis.choices and axis.count is None:
                raise self.refuse(("vary", axis.name))(
                    "count", "is missing: a grid needs a number of points, or a list of values"
                )
        if grid_size(axes) > MOST_RUNS:
            raise refuse("kind", f"{grid_size(axes):.3g} runs; at most {MOST_RUNS}")

    def _check_calibrate(
        self, calibrate: Calibrate, axes: list[Axis], parts: Mapping[str, Any]
    ) -> None:
        refuse = self.refuse(("calibrate",))
        if not parts["observation"]:
            raise refuse("method", "there is no [observation] to be near to")
        for axis in axes:
            if axis.choices:
                raise self.refuse(("vary", axis.name))(
                    "values", "a calibration needs a range, min and max"
                )
        for key in ("population", "tolerance"):
            if calibrate.method != "differential_evolution" and getattr(calibrate, key) is not None:
                raise refuse(key, 'goes with method = "differential_evolution"')
        if calibrate.method == "shgo" and calibrate.seed is not None:
            raise refuse("seed", 'method = "shgo" takes no random numbers')

    def _axis(self, name: str, given: Any) -> Axis:
        keys = ("vary", name)
        table = self._validated(Vary, self._as_table(given, keys), keys)
        refuse = self.refuse(keys)
        if table.values is not None:
            for key in ("min", "max", "count"):
                if getattr(table, key) is not None:
                    raise refuse(key, "does not go with values")
            if table.scale != "linear":
                raise refuse("scale", "does not go with values")
            axis = Axis(name, choices=tuple(dict.fromkeys(table.values)))
            if same := axis.twice():
                raise refuse("values", f"{same[0]!r} and {same[1]!r} are one value; leave one out")
            return axis
        low, unit = _number(table.min, "min", refuse)
        high, other = _number(table.max, "max", refuse)
        if unit is not other:
            raise refuse("max", "must have the same kind of unit as min")
        if not low < high:
            raise refuse("max", f"must be greater than min: {high:g} is not greater than {low:g}")
        if table.scale == "log" and low <= 0:
            raise refuse("min", f'must be greater than 0 with scale = "log", not {low:g}')
        word = unit.own if unit is not None else ""
        return Axis(name, word, (), low, high, table.scale == "log", table.count)

    def _kind(self, table: dict[str, Any], keys: KeyPath) -> type[Table]:
        kinds, word = KINDS[str(keys[0])], table.get("kind")
        if word is None:
            known = ", ".join(kinds)
            raise self.where.error(keys, f"{dotted(keys)}.kind is missing; choose one of {known}")
        if not isinstance(word, str) or word not in kinds:
            near = suggestion(str(word), kinds)
            raise self.refuse(keys)("kind", f'"{word}" is not a kind of {keys[0]}{near}')
        return kinds[word]

    def _as_table(self, given: Any, keys: KeyPath) -> dict[str, Any]:
        if not isinstance(given, dict):
            raise self.where.error(keys, f"{dotted(keys)} must be a table")
        return given

    def _validated(self, kind: type[T], table: dict[str, Any], keys: KeyPath) -> T:
        try:
            return kind.model_validate(table)
        except ValidationError as error:
            raise to_user_error(
                error, table, self.where, keys, lambda at, _: kind if at == keys else None
            ) from None


def _number(given: Any, key: str, refuse: Refuse) -> tuple[float, Unit | None]:
    """An end of a range, in the own unit of what it measures where it names one."""
    if given is None:
        raise refuse(key, "is missing: give min and max, or values")
    if not isinstance(given, str):
        return float(given), None
    found = quantity(given)
    if found is None:
        raise refuse(key, f'= "{given}" is neither a number nor one with a unit such as "3 L/s"')
    return found


def _flat(
    table: dict[str, Any], is_value: Callable[[str, dict[str, Any]], bool], above: str = ""
) -> dict[str, Any]:
    """Tables inside tables as one, by dotted paths, as far down as they are no values.

    Values are choices such as { d2 = 1, d3 = 2 }, and tables that `is_value` says are, by path.
    """
    found: dict[str, Any] = {}
    for name, value in table.items():
        path = f"{above}{name}"
        inner = isinstance(value, dict) and value and not is_value(path, value)
        if not inner or any(set(value) <= keys for keys in CHOICES.values()):
            found[path] = value
        else:
            found |= _flat(value, is_value, f"{path}.")
    return found


def _middle(name: str, settings: list[str], axes: list[Axis], where: Where) -> Scenario:
    """The scenario in the middle of all ranges; every end of each is tried, too."""
    middle = {axis.name: axis.setting(axis.at(0.5)) for axis in axes}
    try:
        scenario = load_scenario(name, [*settings, *middle.values()])
    except UserError as error:
        keys = _culprit(name, settings, middle)
        raise where.error(keys, f"{dotted(keys)}: {error}") from None
    for axis in axes:
        others = [setting for key, setting in middle.items() if key != axis.name]
        for value in dict.fromkeys(axis.ends()):
            tried = [*settings, *others, axis.setting(value)]
            _loaded(name, tried, ("vary", axis.name), where)
    return scenario


def _culprit(name: str, settings: list[str], middle: Mapping[str, str]) -> KeyPath:
    """The key of the study file for which the scenario cannot be read."""
    if _is_refused(name, settings):
        return ("scenario",) if _is_refused(name, []) else ("set",)
    for key, setting in middle.items():
        if _is_refused(name, [*settings, setting]):
            return ("vary", key)
    return ("vary",)


def _is_refused(name: str, settings: list[str]) -> bool:
    try:
        load_scenario(name, settings)
    except UserError:
        return True
    return False


def _loaded(name: str, settings: list[str], keys: KeyPath, where: Where) -> Scenario:
    try:
        return load_scenario(name, settings)
    except UserError as error:
        raise where.error(keys, f"{dotted(keys)}: {error}") from None


def _checked_parts(
    parts: Mapping[str, Mapping[str, Any]], scenario: Scenario, home: Path, reader: _Reader
) -> list[str]:
    """Raise where the scenario has not what is to be read of its runs; returns warnings."""
    for section in ("result", "bands"):
        for name, part in parts[section].items():
            part.check(scenario, reader.refuse((section, name)))
    warnings: list[str] = []
    for name, each in parts["observation"].items():
        keys = ("observation", name)
        try:
            warnings += each.check(scenario, parts["result"], home, reader.refuse(keys))
        except UserError as error:
            text = str(error)
            if dotted(keys) in text:
                raise
            raise reader.where.error(keys, f"{dotted(keys)}: {text}") from None
    return warnings
