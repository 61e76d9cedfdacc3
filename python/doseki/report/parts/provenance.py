"""With what the run was made, so that it can be made again."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ...record.reader import Run
from ...running.provenance import commit, noted_files, provenance_now, read_provenance
from ...util.foreign import read_text
from ...util.input_file import digest_of
from ..markup import Content, Markup, section, table, tag, terms

MOST_FILES = 200
MOST_TEXT = 2**20  # bytes of a scenario that are shown
GIB = 2**30


def provenance(run: Run) -> Markup | None:
    """The section of versions, machine, command, inputs and scenario."""
    entries = read_provenance(run.folder)
    said: list[Content] = [terms(_rows(entry)) for entry in entries[-1:]]
    if not entries:
        said.append(tag("p", "The version and the machine of this run were not recorded."))
    if len(entries) > 1:
        said.append(tag("p", f"The run was resumed {len(entries) - 1} times; this is the last."))
    now = provenance_now()
    made = f"This report was made by doseki {now['doseki']}{_of(commit())} at {now['time']}."
    return section(
        "Provenance", said, tag("p", made, class_="small"), _inputs(run), _scenario(run),
        name="provenance",
    )  # fmt: skip


def _of(found: object) -> str:
    return f" ({found})" if found else ""


def _rows(entry: Mapping[str, Any]) -> Iterator[tuple[str, Content]]:
    """Of what an entry says, all that it says."""
    command, libraries = entry.get("command"), entry.get("libraries")
    if isinstance(command, list):
        yield "command", tag("code", shlex.join(map(str, command)))
    yield "doseki", f"{entry.get('doseki', '?')}, commit {entry.get('commit') or 'not known'}"
    yield (
        "core",
        f"{entry.get('core', '?')}, {entry.get('threads')} threads, {entry.get('ranks')} ranks",
    )
    if isinstance(libraries, dict):
        named = ", ".join(f"{name} {version}" for name, version in libraries.items())
        yield "libraries", f"Python {entry.get('python', '?')}, {named}"
    memory = entry.get("memory_bytes")
    size = f", {memory / GIB:.0f} GiB" if isinstance(memory, int | float) else ""
    yield "machine", f"{entry.get('processor', '?')}, {entry.get('cores')} cores{size}"
    yield "system", str(entry.get("system", "?"))
    yield "started", str(entry.get("time", "?"))


def _inputs(run: Run) -> Content:
    """The files that the scenario named, with digests, and whether the folder holds a copy."""
    files = sorted(run.folder.inputs.glob("*")) if run.folder.inputs.is_dir() else []
    copies = {digest_of(file): file for file in files[:MOST_FILES] if file.is_file()}
    named = noted_files(run.folder)
    rows = [(f["key"], f["file"], f["digest"], _copy_of(copies, f["digest"])) for f in named]
    told = {each["digest"] for each in named}
    others = [digest for digest in copies if digest not in told]
    rows += [("", "", digest, _copy_of(copies, digest)) for digest in others]
    if not rows:
        return tag("p", "The scenario reads no other files.", class_="small")
    more = max(len(rows) - MOST_FILES, 0) + max(len(files) - MOST_FILES, 0)
    note = tag("p", f"... and {more} more files") if more > 0 else None
    return [table(["for", "input file", "BLAKE2b (128 bit)", "copy"], rows[:MOST_FILES]), note]


def _copy_of(copies: Mapping[str, Path], digest: str) -> str:
    """The file of this content in the folder of the run, and its size; "" for none."""
    file = copies.get(digest)
    return "" if file is None else f"{file.name}, {file.stat().st_size} bytes"


def _scenario(run: Run) -> Content:
    """The effective scenario, folded away."""
    text = read_text(run.folder.scenario)
    shown = text if len(text) <= MOST_TEXT else text[:MOST_TEXT] + "\n# ... cut off here"
    return tag("details", tag("summary", "The scenario as it was run"), tag("pre", shown))
