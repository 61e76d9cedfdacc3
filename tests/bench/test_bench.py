"""`doseki bench`: its rows, its tables, its targets."""

from __future__ import annotations

import json

import numpy as np
import pytest

from doseki.bench import command as bench
from doseki.bench import report as bench_report
from doseki.bench.case import DP, ETA, Case, block, make_simulation
from doseki.bench.roofline import share_of_roof
from doseki.cli.main import main
from doseki.compiled import Peaks, available_instruction_sets, load_core
from doseki.errors import ResourceError

KEYS = {
    "dim", "precision", "scheme", "n", "threads", "isa", "updates_per_s", "pairs_per_s",
    "bytes_per_particle", "phases",
}  # fmt: skip
TINY = ["bench", "--quick", "--sizes", "1000", "--threads", "1"]


@pytest.fixture(autouse=True)
def short_rounds(monkeypatch):
    """Measures next to nothing, fast."""
    monkeypatch.setattr(bench, "ROUND_SECONDS", 0.0)
    monkeypatch.setattr(bench, "QUICK_ROUNDS", 1)
    monkeypatch.setattr(bench, "BARE_SECONDS", 0.0)


def test_json_is_a_list_of_rows(capsys):
    main_ends([*TINY, "--dims", "2", "--json"])
    rows = json.loads(capsys.readouterr().out)
    assert {(row["precision"], row["n"]) for row in rows} == {("double", 1000), ("mixed", 1000)}
    for row in rows:
        assert row.keys() >= KEYS
        assert sum(row["phases"].values()) == pytest.approx(1)
        assert min(row["phases"].values()) >= 0
        assert row["pairs_per_s"] == pytest.approx(row["updates_per_s"] * row["pairs_per_particle"])


def test_report_has_tables_and_targets(capsys):
    main_ends([*TINY, "--dims", "3", "--precision", "double"])
    text = capsys.readouterr().out
    assert "| M updates/s |" in text
    assert "list_build" in text


def test_history_gains_one_line_a_run(tmp_path):
    file = tmp_path / "new" / "history.jsonl"
    for _ in range(2):
        main_ends([*TINY, "--dims", "2", "--precision", "double", "--append", str(file)])
    records = [json.loads(line) for line in file.read_text().splitlines()]
    assert len(records) == 2
    assert records[0].keys() == {"date", "version", "machine", "rows"}


@pytest.mark.parametrize(
    "options",
    [["--sizes", "many"], ["--sizes", "10"], ["--dims", "4"], ["--isa", "v9"], ["--threads", "0"]],
)
def test_options_that_cannot_be_run(options):
    with pytest.raises(SystemExit) as ended:
        main(["bench", *options])
    assert ended.value.code == 2


def main_ends(arguments):
    """Runs the command line, which ends the interpreter even when all went well."""
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert not ended.value.code


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("precision", ["double", "mixed"])
def test_pairs_are_those_within_support(dim, precision):
    isa = available_instruction_sets()[0]
    simulation = make_simulation(Case(dim, 1000, precision, 1, isa))
    position = block(dim, 1000)
    distance = np.linalg.norm(position[:, None] - position[None], axis=-1)
    within = np.count_nonzero(distance < 2.5 * ETA * DP) - len(position)
    assert simulation.interacting_pairs() == pytest.approx(
        within, rel=1e-12 if precision == "double" else 1e-3
    )


@pytest.mark.parametrize("n", [1000, 1001, 4096])
def test_block_has_exactly_the_particles_asked_for(n):
    for dim in (2, 3):
        assert block(dim, n).shape == (n, dim)


def made_up_row(**changes):
    """A row with the numbers of a machine on which nothing is remarkable."""
    row = {"dim": 3, "precision": "double", "n": 10**6, "threads": 1, "isa": "v4",
           "scheme": "ueta2022",
           "updates_per_s": 1e6, "bytes_per_particle": 400.0, "bare_fraction": 0.6}  # fmt: skip
    row |= changes
    return row | {"seconds_per_step": row["n"] / row["updates_per_s"]}


def test_linear_growth_has_exponent_one():
    rows = [made_up_row(n=n) for n in (10**4, 10**5, 10**6)]
    assert [exponent for _name, exponent in bench_report.growth(rows)] == [pytest.approx(1)]


def test_memory_over_its_limit_is_an_error(monkeypatch, capsys):
    rows = [made_up_row(bytes_per_particle=bench_report.MEMORY_LIMIT + 1.0)]
    monkeypatch.setattr(bench, "run_bench", lambda _plan: iter([rows]))
    with pytest.raises(ResourceError, match="memory"):
        bench.bench_command(bench.Plan(), as_json=True, history=None)
    assert json.loads(capsys.readouterr().out) == rows


def test_memory_is_not_judged_on_small_cases():
    assert bench_report.memory_check([made_up_row(n=10**5, bytes_per_particle=900.0)]) is None


def test_targets_compare_rows_that_differ_in_one_thing():
    rows = [
        made_up_row(n=10**5),
        made_up_row(n=10**5, isa="scalar", updates_per_s=2.5e5),
        made_up_row(n=10**5, precision="mixed", updates_per_s=2e6),
        made_up_row(n=10**5, threads=2, updates_per_s=1.5e6),
    ]
    values = {check.name.split(",")[0]: check.value for check in bench_report.checks(rows)}
    assert values["v4 over scalar"] == pytest.approx(4)
    assert values["mixed over double"] == pytest.approx(2)
    assert values["2 threads over 1"] == pytest.approx(1.5)


@pytest.mark.skipif("device" not in available_instruction_sets(), reason="not built")
def test_work_of_pairs_on_a_device(capsys, monkeypatch):
    """What is printed is what the core counts, times the pairs that were summed."""
    monkeypatch.setenv("DOSEKI_ISA", "")
    main_ends([*TINY, "--dims", "2", "--precision", "double", "--device", "host", "--json"])
    row = json.loads(capsys.readouterr().out)[0]
    assert row["isa"] == "device"
    counted = load_core("device").pair_work("ueta2022", 2, "double", False)
    assert [work["sum"] for work in row["work"]] == [work["sum"] for work in counted]
    for shown, own in zip(row["work"], counted, strict=True):
        operations = own["sums"] + own["products"] + own["quotients"] + own["roots"]
        assert shown["operations_per_pair"] == operations
        assert shown["bytes_per_pair"] == own["bytes"]
        pairs = shown["operations_per_s"] / operations * row["phases"][own["sum"]]
        listed = row["list_to_pair"] * row["pairs_per_particle"]
        assert pairs == pytest.approx(row["updates_per_s"] * listed)
    main_ends([*TINY, "--dims", "2", "--precision", "double", "--device", "host"])
    assert "operations/pair" in capsys.readouterr().out


def test_share_of_a_roof():
    """The lower of two roofs counts: of arithmetic in the precision of the pairs, or of memory."""
    peaks = Peaks(in_double=10.0, in_float=100.0, bandwidth=50.0)
    work = {"operations_per_s": 5.0, "bytes_per_s": 10.0}
    assert share_of_roof(work, peaks, "double") == pytest.approx(0.5)
    assert share_of_roof(work, peaks, "mixed") == pytest.approx(0.2)


def test_a_device_and_instruction_sets_exclude_each_other(capsys):
    with pytest.raises(SystemExit) as end:
        main([*TINY, "--device", "host", "--isa", available_instruction_sets()[0]])
    assert end.value.code == 2
    assert "--isa: not with --device" in capsys.readouterr().err
