"""What continuous integration runs: the default tier, then the others while an hour has not passed.

The others come in an order drawn from the commit's hash, so that over a few commits each of them is
run whole. `.ci/run` sets up the machine and starts this by `python -m tests.ci SECONDS`, with the
seconds that this has taken.
"""

from __future__ import annotations

import hashlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field

from .tiers import APART, RESULTS, ROOT

BUDGET = 3600.0  # s; DOSEKI_CI_SECONDS sets another
GRACE = 60.0  # s that a tier which is told to stop may take
START = 0.05  # of the time: a tier is not started when less is left
# What pytest says: how many tests there are, which fail, the counts of its last line. Results in
# the JUnit file are no help: tests that were interrupted have passed there.
COLLECTED = re.compile(r"^\d+ workers? \[(\d+) items?\]")
FAILURE = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$")
CLOSING = re.compile(r"^=+ (.*) in [\d.]+s\b")
COUNT = re.compile(r"(\d+) (passed|failed|error|skipped)")
NO_TESTS = 5  # exit code of pytest
COUNTS = ("passed", "failed", "skipped")
# Tests by tier: the words of `./doseki test`. What "full" has beyond the others is marked so.
WORDS = {name: [name] for name in ("fuzz", *APART)} | {"default": [], "full": ["-m", "full"]}


def order(commit: str) -> list[str]:
    """The tiers in the order for a commit."""
    others = [name for name in WORDS if name != "default"]
    drawn = sorted(others, key=lambda name: hashlib.sha256(f"{commit} {name}".encode()).digest())
    return ["default", *drawn]


@dataclass
class Outcome:
    """What became of a tier."""

    passed: int = 0
    failed: int = 0
    skipped: int = 0
    failures: list[str] = field(default_factory=list)
    collected: int = 0
    closed: bool = False  # the session came to its last line
    stopped: bool = False  # time was up

    @property
    def left_out(self) -> int:
        """Tests that were not finished."""
        return self.collected - self.passed - self.failed - self.skipped

    def hear(self, line: str) -> None:
        """Take in a line that pytest prints."""
        if found := COLLECTED.match(line):
            self.collected = int(found[1])
        elif found := FAILURE.match(line):
            self.failures.append(found[1])
        elif found := CLOSING.match(line):
            self.closed = True
            for number, word in COUNT.findall(found[1]):
                name = "failed" if word == "error" else word
                setattr(self, name, getattr(self, name) + int(number))


class Session:
    """A session of pytest whose output is passed on."""

    def __init__(self, words: list[str]) -> None:
        self.outcome = Outcome()
        self._process = subprocess.Popen(
            ["./doseki", "test", *words],
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
            # Ignored where this was started in the background.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        self._echo = threading.Thread(target=self._pass_on, daemon=True)
        self._echo.start()

    def _pass_on(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            print(line, end="", flush=True)
            self.outcome.hear(line)

    def finish(self, seconds: float) -> int | None:
        """The exit code; None if the session was stopped because it was not done in time."""
        try:
            return self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            self._process.send_signal(signal.SIGINT)  # pytest then writes its results
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(GRACE)
            return None
        finally:
            with suppress(ProcessLookupError):  # what is left of it
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
            self._echo.join(5)  # its pipe may still be open elsewhere


def run_tier(name: str, seconds: float) -> Outcome:
    """Run a tier for so long at most."""
    session = Session([*WORDS[name], f"--junitxml={RESULTS / f'ci-{name}.xml'}"])
    code = session.finish(seconds)
    outcome = session.outcome
    outcome.stopped = code is None
    whole = code in (0, NO_TESTS)
    stopped = outcome.stopped and (outcome.closed or not outcome.collected)
    if not whole and not stopped and not outcome.failed:
        outcome.failed = 1
        outcome.failures.append(f"the tier {name} ended with code {code}")
    return outcome


def run_tiers(
    names: list[str], run: Callable[[str, float], Outcome], seconds_left: Callable[[], float]
) -> dict[str, Outcome | None]:
    """The outcomes of tiers; None for one that was not started for want of time."""
    least = START * seconds_left()
    outcomes: dict[str, Outcome | None] = {}
    for name in names:
        left = seconds_left()
        outcomes[name] = run(name, left) if left > least else None
    return outcomes


def report(outcomes: dict[str, Outcome | None], seconds: float) -> tuple[list[str], bool]:
    """What is said in the end, the last line as pytest does; and whether all is well: something
    has passed and nothing failed.
    """
    done = [outcome for outcome in outcomes.values() if outcome is not None]
    lines = [f"FAILED {failure}" for outcome in done for failure in outcome.failures]
    for name, outcome in outcomes.items():
        if outcome is None:
            lines.append(f"left out: the tier {name}")
        elif outcome.stopped:
            some = f"{outcome.left_out} of {outcome.collected}" if outcome.collected else "all"
            lines.append(f"left out: {some} tests of the tier {name}")
    sums = [f"{sum(getattr(each, word) for each in done)} {word}" for word in COUNTS]
    lines.append(f"{', '.join(sums)} in {seconds:.2f}s")
    passed = any(outcome.passed for outcome in done)
    return lines, passed and not any(outcome.failed for outcome in done)


def main() -> None:
    """Runs the tiers; code 1 if a test failed or none was run."""
    started = time.monotonic() - float(sys.argv[1])
    budget = float(os.environ.get("DOSEKI_CI_SECONDS", BUDGET))
    git = ["git", "rev-parse", "HEAD"]
    commit = subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=False).stdout
    names = order(commit.strip())
    print(f"ci: tiers in this order: {', '.join(names)}", flush=True)
    outcomes = run_tiers(names, run_tier, lambda: started + budget - GRACE - time.monotonic())
    lines, good = report(outcomes, time.monotonic() - started)
    print("\n".join(lines))
    sys.exit(not good)


if __name__ == "__main__":
    main()
