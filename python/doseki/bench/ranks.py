"""`doseki bench --ranks`: how much faster, or larger, a run is on several ranks."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from math import log2
from typing import Any

from ..errors import ResourceError
from ..parallel.launch import mpiexec
from .report import machine, markdown_table

Row = dict[str, Any]
WEAK_SIZE, STRONG_SIZE = 200_000, 400_000  # particles: of each rank, and of all
PROJECTED = (1, 10, 100, 1_000, 10_000, 100_000)  # ranks
PASSES, REDUCTIONS = 2, 2  # of a step of ueta2022: exchanges, and sums or maxima over all ranks


def measured(ranks: int, dim: int, scheme: str, n: int, together: bool) -> Row:
    """One case on `ranks` ranks; raises ResourceError when it cannot be run."""
    worker = ["-m", "mpi4py", "-m", "doseki.bench.rank_worker"]
    arguments = [str(dim), scheme, str(n), "together" if together else "alone"]
    done = subprocess.run(
        [mpiexec(), "-n", str(ranks), sys.executable, *worker, *arguments],
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if done.returncode:
        raise ResourceError(f"the bench on {ranks} ranks ended with exit code {done.returncode}")
    return json.loads(done.stdout.splitlines()[-1])


def run_bench(counts: Sequence[int], dims: Sequence[int], scheme: str, n: int) -> Iterator[Row]:
    """Weak scaling with n particles a rank, strong scaling with 2 n in all.

    What it is compared with runs on as many ranks at the same time, each by itself, so that the
    cores are equally busy.
    """
    for dim in dims:
        for ranks in counts:
            alone = measured(ranks, dim, scheme, n, together=False)["seconds_per_step"]
            row = measured(ranks, dim, scheme, n * ranks, together=True)
            yield row | {"kind": "weak", "efficiency": alone / row["seconds_per_step"]}
            alone = measured(ranks, dim, scheme, 2 * n, together=False)["seconds_per_step"]
            row = measured(ranks, dim, scheme, 2 * n, together=True)
            speed = alone / row["seconds_per_step"]
            yield row | {"kind": "strong", "efficiency": speed / ranks}


COLUMNS = {
    "": lambda row: row["kind"],
    "dim": lambda row: str(row["dim"]),
    "ranks": lambda row: str(row["ranks"]),
    "particles": lambda row: f"{row['n']:.0e}".replace("e+0", "e"),
    "ms/step": lambda row: f"{1e3 * row['seconds_per_step']:.1f}",
    "efficiency": lambda row: f"{row['efficiency']:.2f}",
    "imbalance": lambda row: f"{row['imbalance']:.2f}",
    "balance %": lambda row: f"{100 * row['share_balance']:.1f}",
    "migrate %": lambda row: f"{100 * row['share_migrate']:.1f}",
    "halo %": lambda row: f"{100 * row['share_halo']:.1f}",
    "wait %": lambda row: f"{100 * row['share_wait']:.1f}",
    "messages": lambda row: f"{row['messages_sent']:.0f}",
    "kB sent": lambda row: f"{row['bytes_sent'] / 1e3:.0f}",
    "ghosts %": lambda row: f"{100 * row['ghosts']:.1f}",
}


def table(rows: Sequence[Row]) -> str:
    """One line a row; messages and kB are those of the busiest rank in a step."""
    return markdown_table(list(COLUMNS), [[text(row) for text in COLUMNS.values()] for row in rows])


def projected(row: Row, ranks: int) -> dict[str, float]:
    """Seconds of a step on many ranks with as many particles each as those of `row`, a weak case.

    Work as measured; the halo of a part that has neighbours on all sides; a message to each of
    them in each pass; reductions that take one message more for each doubling of the ranks; and,
    when lists are built, what each rank has to know of all others.
    """
    dim, each = row["dim"], row["n"] / row["ranks"]
    peers = min(3**dim, ranks) - 1
    # A cube's shell as thick as the support, against the one face of each of two halves.
    sides = 2 * dim if peers > 1 else 1
    face = row["bytes_sent"] / (row["n"] ** ((dim - 1) / dim)) * each ** ((dim - 1) / dim)
    sent = face * sides if ranks > 1 else 0.0
    work = row["seconds_per_step"] * (1 - row["share_wait"] - row["share_halo"])
    packing = row["seconds_per_step"] * row["share_halo"] / max(row["bytes_sent"], 1.0)
    boxes = 8 * (4 * dim + 1) * ranks * row["byte_seconds"] / row["steps_per_list"]
    return {
        "work": work,
        "messages": PASSES * peers * row["message_seconds"],
        "bytes": sent * (row["byte_seconds"] + packing),
        "reductions": REDUCTIONS * log2(ranks) * row["message_seconds"],
        "boxes": boxes,
    }


def projection(row: Row) -> str:
    """The table of projected steps and their efficiencies."""
    lines = []
    for ranks in PROJECTED:
        parts = projected(row, ranks)
        total = sum(parts.values())
        shares = [f"{1e3 * seconds:.3g}" for seconds in parts.values()]
        lines.append([f"{ranks:,}", *shares, f"{1e3 * total:.3g}", f"{parts['work'] / total:.2f}"])
    return markdown_table(
        ["ranks", *(f"{name} ms" for name in parts), "ms/step", "efficiency"], lines
    )


def bench_ranks(
    counts: Sequence[int], dims: Sequence[int], scheme: str, n: int | None, as_json: bool
) -> None:
    """`doseki bench --ranks`."""
    rows = []
    for row in run_bench(counts, dims, scheme, n or WEAK_SIZE):
        rows.append(row)
        print(f"doseki bench: {row['kind']}, {row['dim']}-D, {row['ranks']} ranks", file=sys.stderr)
    if as_json:
        print(json.dumps(rows))
        return
    print(f"{machine()}; scheme {scheme}, one thread a rank\n\n{table(rows)}")
    for row in rows:
        if row["kind"] == "weak" and row["ranks"] > 1:
            costs = [
                1e6 * row["message_seconds"],
                1e9 * row["byte_seconds"],
                1e6 * row["reduce_seconds"],
            ]
            print(
                f"\n{row['dim']}-D, {row['ranks']} ranks: a message {costs[0]:.1f} us, a byte"
                f" {costs[1]:.2f} ns, a reduction {costs[2]:.1f} us\n\n{projection(row)}"
            )
