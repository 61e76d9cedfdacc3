"""Pages whose code is run: what their blocks do, in a folder of its own."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import typer

from doseki.cli.app import app

from .markdown import ROOT, Block, blocks_of

START = "getting-started.md"
BASE = "my-channel.toml"  # the scenario of that page, which others go on from
# The pages, with the scenario to which tables are added that are not a file of their own.
PAGES = {
    START: BASE,
    "how-to/dam-force.md": "dam.toml",
    "how-to/own-grains.md": "grains.toml",
    "how-to/breaking.md": "stone.toml",
    "how-to/hydrographs.md": "flood.toml",
    "how-to/read-results.md": BASE,
    "how-to/python.md": BASE,
    "how-to/restart.md": BASE,
    "how-to/ranks.md": BASE,
    "explanation/resolution.md": BASE,
    "explanation/sound-speed.md": BASE,
    "explanation/two-schemes.md": BASE,
}
LONG = ("-o fine",)  # runs whose results no page reads on: they are cut short
SHORT_TIME = "time_max=0.02"
SCRIPTS = Path(sysconfig.get_path("scripts"))


@dataclass
class Page:
    """A page that is worked through in a folder."""

    name: str
    folder: Path

    @property
    def blocks(self) -> list[Block]:
        """Its blocks of code, in order."""
        return blocks_of((ROOT / "docs" / self.name).read_text(encoding="utf-8"))

    @property
    def commands(self) -> Iterator[list[str]]:
        """The words of each of its commands."""
        for block in self.blocks:
            if block.language == "console":
                yield from (shlex.split(line, comments=True) for line in block.text.splitlines())

    def write_scenarios(self) -> Iterator[tuple[Path, list[str]]]:
        """Write what its TOML says: after each block the file that changed, and settings.

        A block that begins with `# NAME.toml` is that file, one of text with `# NAME.csv` that;
        others of TOML are added to the scenario of the page, keys of the top level as by --set.
        """
        own = self.folder / PAGES[self.name]
        if self.name != START:
            (self.folder / BASE).write_text(base_scenario())
            if own.name != BASE and not own.exists():
                shutil.copy(self.folder / BASE, own)
        for block in self.blocks:
            first, _, rest = block.text.partition("\n")
            if block.language == "text" and first.startswith("# ") and first.endswith(".csv"):
                (self.folder / first[2:]).write_text(block.text)
            if block.language != "toml":
                continue
            if first.startswith("# ") and first.endswith(".toml"):
                (self.folder / first[2:]).write_text(rest)
                yield self.folder / first[2:], []
            elif block.text.startswith("["):
                own.write_text(f"{own.read_text()}\n{block.text}")
                yield own, []
            else:
                yield own, [line.replace('"', "") for line in block.text.splitlines()]

    def run(self) -> None:
        """Do all that the page says, in its order."""
        for _ in self.write_scenarios():
            pass
        for block in self.blocks:
            if block.language == "console":
                for line in block.text.splitlines():
                    self.run_command(line)
        script = "\n".join(block.text for block in self.blocks if block.language == "python")
        if script:
            self._run([sys.executable, "-c", script])

    def begin_with(self, first: Path) -> None:
        """Bring the run of the first page, where this page reads one and makes none of its own."""
        made = [words for words in self.commands if words[1] == "run" and "out" in words]
        if not made:
            shutil.copytree(first / "out", self.folder / "out")

    def run_command(self, line: str) -> None:
        """Run a line of a block."""
        program, *words = shlex.split(line, comments=True)
        assert program == "./doseki", f"{self.name}: {line}"
        if any(mark in line for mark in LONG):
            words += ["--set", SHORT_TIME]
        self._run([str(SCRIPTS / "doseki"), *words])

    def _run(self, command: list[str]) -> None:
        environment = os.environ | {"MPLBACKEND": "agg"}
        ended = subprocess.run(
            command, cwd=self.folder, env=environment, capture_output=True, text=True, check=False
        )
        said = ended.stdout[-2000:] + ended.stderr[-2000:]
        assert ended.returncode == 0, f"{self.name}: {command[:6]}: {said}"


def base_scenario() -> str:
    """The scenario that the first page writes."""
    text = (ROOT / "docs" / START).read_text(encoding="utf-8")
    (block,) = (b for b in blocks_of(text) if b.language == "toml")
    return block.text


def unknown_options(words: list[str]) -> list[str]:
    """What a command line names that doseki does not have: a command, or options."""
    program, name, *rest = words
    assert program == "./doseki"
    commands = typer.main.get_command(app).commands  # type: ignore[attr-defined]
    if name not in commands:
        return [name]
    known = {"--help"} | {opt for p in commands[name].params for opt in p.opts + p.secondary_opts}
    return [word for word in rest if word.startswith("-") and word not in known]
