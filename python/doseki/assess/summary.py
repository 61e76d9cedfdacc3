"""A run on one screen of text."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..measure.flow import Flow, WindowFlow, measure_flow
from ..measure.hydrographs import Passage, passage
from ..measure.maps.grid import MapSettings
from ..measure.maps.runout import Runout, runout_lines
from ..measure.numbers import speed
from ..measure.views import with_flow
from ..record.reader import Run
from ..record.units import unit_in
from ..scenario.gauges.section import DRY
from ..util.files import write_whole_text
from .estimates import solid_steps_text
from .ground.leaving import left_text
from .ground.volumes import volume_lines
from .loads import load_lines, loads_of
from .trust.report import trust_lines

WIDTH = 18  # of the column of names
Row = tuple[str, str]


def summary_text(run: Run) -> str:
    """What was run, how it went and the key results: about 20 lines."""
    rows = [*key_rows(run), *_warnings(run), *_trust(run)]
    return "\n".join([title_of(run), "", *(f"{name:<{WIDTH}}{text}" for name, text in rows)])


def write_summary(run: Run) -> None:
    """Write that text into the folder of the run."""
    write_whole_text(run.folder.summary_text, summary_text(run) + "\n")


def title_of(run: Run) -> str:
    """The title of the scenario, or the folder."""
    return run.scenario.get("title") or str(run.directory)


def key_rows(run: Run) -> Iterator[Row]:
    """How a run went and its key results: (name, text); an empty name goes on with the last one."""
    for part in (
        _status,
        _computed,
        _state,
        _released,
        _ledger,
        _results,
        _sections,
        _runout,
        _loads,
    ):
        yield from part(run)


def _line(name: str, text: str) -> Row:
    return name, text


def _status(run: Run) -> Iterator[Row]:
    if status := run.summary.get("status"):
        yield _line("status", status)
    if failure := run.summary.get("failure"):
        yield _line("failure", failure)


def _computed(run: Run) -> Iterator[Row]:
    """How much was computed: particles, time, steps, wall time, memory."""
    said = run.summary
    scheme, dim = run.scenario.get("scheme", ""), run.scenario["dim"]
    dp = run.scenario["dp"]
    spacing = f"{dp:.4g} m" if dp >= 1 else f"{1e3 * dp:.4g} mm"
    yield _line(
        "scheme", f"{scheme}, {dim}-D, dp = {spacing}, xi = {run.scenario.get('xi', 1.0):.4g}"
    )
    if len(run.history) and len(run.history["time"]):
        last = {column: values[-1] for column, values in run.history.items()}
        yield _line("time", f"{last['time']:.6g} s of {run.scenario['time_max']:.6g} s")
        yield _line("steps", f"{last['step']:,.0f}, the last one {last['dt']:.3g} s")
        yield from _solid_steps(run)
    if "wall_seconds" in said:
        rate = said.get("particle_updates_per_second", math.nan)
        yield _line("wall time", f"{duration_text(said['wall_seconds'])}, {rate:.3g} updates/s")
    if "bytes_per_particle" in said:
        yield _line("memory", f"{said['bytes_per_particle']:.0f} bytes per particle")


def _solid_steps(run: Run) -> Iterator[Row]:
    """Those of bodies that deform, where they are shorter than those of the run."""
    time, step = (run.history[column] for column in ("time", "step"))
    duration, steps = time[-1] - time[0], step[-1] - step[0]
    solid = run.summary.get("solid_timestep")
    if solid is not None and solid * steps < duration:
        yield _line("", solid_steps_text(solid, duration))


def duration_text(seconds: float) -> str:
    """Seconds, minutes and seconds, or hours and minutes."""
    if seconds >= 3600:
        hours, over = divmod(round(seconds / 60), 60)
        return f"{hours} h {over} min"
    minutes, rest = divmod(seconds, 60)
    return f"{minutes:.0f} min {rest:.0f} s" if minutes else f"{rest:.1f} s"


def _state(run: Run) -> Iterator[Row]:
    """Particles and speeds at the end, by material."""
    if not len(run):
        return
    last = run[-1]
    fixed = last["fixed"]
    yield _line("particles", f"{len(fixed):,}, {np.count_nonzero(fixed):,} of them fixed")
    for name in last.material_names:
        of_it = (last["material"] == name) & ~fixed
        if np.any(of_it):
            speeds = speed(last["velocity"][of_it])
            mean, highest = speeds.mean(), speeds.max()
            text = f"{len(speeds):,} free, speed {mean:.3g} m/s mean, {highest:.3g} m/s highest"
            yield _line(f"  {name}", text)


def _ledger(run: Run) -> Iterator[Row]:
    """Mass: initial + entered = inside + left."""
    said = run.summary
    names = ("mass_initial", "mass_entered", "mass_left", "mass_inside")
    if not all(name in said for name in names):
        return
    initial, entered, left, inside = (said[name] for name in names)
    unit = unit_in("kg", run.scenario["dim"])
    residual = initial + entered - left - inside
    yield _line("mass", f"{initial:.6g} {unit} initial + {entered:.6g} entered")
    yield _line("", f"= {inside:.6g} inside + {left:.6g} left, residual {residual:.2g}")
    if text := left_text(said.get("left") or {}, run.scenario["dim"]):
        yield _line("", text)
    if through := said.get("mass_through_ground", 0.0):
        yield _line("", f"{through:.3g} {unit} of that went through the ground")


def _released(run: Run) -> Iterator[Row]:
    """What lay on a terrain at the start."""
    yield from volume_lines(run.summary, run.scenario["dim"]).items()


def _results(run: Run) -> Iterator[Row]:
    """The front and the windows, where a fluid flows."""
    flow = measure_flow(run)
    if flow is None:
        return
    front = flow.front[-1]
    place = f"x = {_place(front)} m" if flow.along_x else f"{front:.4g} m from where it began"
    said = place if math.isfinite(front) else "no fluid is left"
    yield _line("front", f"{said} at {flow.times[-1]:.4g} s")
    for name, entry in flow.windows.items():
        yield _line(f"window {name}", _window(run, flow, entry))


def _place(coordinate: float) -> str:
    """A coordinate in m; one of a map to a decimetre."""
    return f"{coordinate:.4g}" if abs(coordinate) < 1e4 else f"{coordinate:.1f}"


def _window(run: Run, flow: Flow, entry: WindowFlow) -> str:
    arrival = entry.arrival(flow.times)
    k = with_flow(run, entry.view)
    if math.isnan(arrival):
        text = "no fluid yet"
    else:
        mean = f"{entry.fluid_velocity[k]:.3g} m/s at {flow.times[k]:.3g} s"
        text = f"fluid from {arrival:.3g} s on, mean v_x {mean}"
    if entry.grain_count[k]:
        text += f"; {entry.grain_count[k]} grains, mean speed {entry.grain_speed[k]:.3g} m/s"
    return text


def _sections(run: Run) -> Iterator[Row]:
    """What passed the sections."""
    for name, table in run.scenario.get("gauge", {}).items():
        record = run.gauges.get(name)
        if table.get("kind") != "section" or record is None or not len(record["time"]):
            continue
        yield _line(f"section {name}", _passed(passage(record), DRY * run.scenario["dp"]))


def _passed(found: Passage, film: float) -> str:
    """What passed a section, of which strips less deep than `film`, m, count as dry."""
    if not found.peak:
        return "nothing yet"
    passed = f"peak {found.peak:.3g} m3/s at {found.peak_time:.3g} s, {found.volume:.3g} m3 passed"
    if found.peak < 0 and found.volume < 0:
        passed += " (against its direction: swap left and right)"
    if found.arrival is None:
        return f"{passed}, nowhere as deep as half a particle ({film:.3g} m)"
    return (
        f"flow from {found.arrival:.3g} s on, {passed}, depth up to {found.depth:.3g} m, "
        f"speed up to {found.speed:.3g} m/s"
    )


def _runout(run: Run) -> Iterator[Row]:
    """How far the flow went, where the run kept maps."""
    said = run.summary.get("runout")
    if said:
        settings = MapSettings.of(run.scenario.get("maps"), run.scenario["dp"])
        for k, line in enumerate(runout_lines(Runout(**said), settings)):
            yield _line("" if k else "maps", line)


def _loads(run: Run) -> Iterator[Row]:
    """Peaks, means and impulses on structures."""
    for name, text in load_lines(loads_of(run)):
        yield _line(name, text)


def _warnings(run: Run) -> Iterator[Row]:
    for warning in run.summary.get("warnings", ()):
        yield _line("warning", warning)


def _trust(run: Run) -> Iterator[Row]:
    """The verdicts on the run, worst first."""
    for k, (word, text) in enumerate(trust_lines(run.trust) if run.trust else ()):
        yield _line("" if k else "trust", f"{word}: {text}")
