"""`doseki bench --flows`: flows under way."""

from __future__ import annotations

import json

import pytest

from doseki.bench import command as bench
from doseki.bench.flows import FLOWS, Flow
from doseki.cli.main import main
from doseki.scenario.load import load_scenario

SMALL = Flow("small", "dambreak", ("scheme=resolved", "dp== column_height/12"), 2e-3, 2e-3)
NO_OPTIONS = dict.fromkeys((*bench.OF_BLOCK, "--precision", "--threads", "--flows"))


def bench_ends(*options: str) -> int:
    """Code with which the command line ends."""
    with pytest.raises(SystemExit) as ended:
        main(["bench", *options])
    return int(ended.value.code or 0)


@pytest.fixture
def _small(monkeypatch):
    monkeypatch.setitem(FLOWS, SMALL.name, SMALL)


@pytest.mark.usefixtures("_small")
def test_rows_of_a_flow(capsys):
    assert (
        bench_ends("--flows", "small", "--threads", "1,2", "--precision", "double", "--json") == 0
    )
    alone, both = json.loads(capsys.readouterr().out)
    assert (alone["threads"], both["threads"]) == (1, 2)
    assert alone["efficiency"] == pytest.approx(1)
    rate = both["flow_seconds_per_second"] / alone["flow_seconds_per_second"]
    assert both["efficiency"] == pytest.approx(rate / 2)
    for row in (alone, both):
        assert row["updates_per_s"] > 0
        assert row["steps_per_rebuild"] >= 1
        assert 0 < row["timestep"] < SMALL.window
        assert sum(row["phases"].values()) == pytest.approx(1)


@pytest.mark.usefixtures("_small")
def test_precisions_take_turns(capsys):
    assert bench_ends("--flows", "small", "--threads", "1", "--json") == 0
    double, mixed = json.loads(capsys.readouterr().out)
    assert (double["precision"], mixed["precision"]) == ("double", "mixed")
    assert double["efficiency"] == mixed["efficiency"] == pytest.approx(1)
    assert mixed["bytes_per_particle"] < 0.9 * double["bytes_per_particle"]


@pytest.mark.usefixtures("_small")
def test_tables_of_a_flow(capsys):
    assert bench_ends("--flows", "small", "--threads", "1", "--precision", "mixed") == 0
    text = capsys.readouterr().out
    assert "| mixed |" in " ".join(text.split())
    assert "| flow s/s |" in text
    assert "list_build" in text
    assert "M pairs/s/core" not in text, "the block was not asked for"


@pytest.mark.parametrize("name", FLOWS)
def test_flows_are_scenarios_of_the_resolved_scheme(name):
    flow = FLOWS[name]
    scenario = load_scenario(flow.scenario, flow.settings)
    assert scenario.scheme == "resolved"
    assert flow.developed > 0
    assert flow.window > 0


def test_flows_follow_the_block_unless_something_is_chosen():
    assert list(bench.make_plan(NO_OPTIONS, quick=False).flows) == list(FLOWS)
    assert not bench.make_plan(NO_OPTIONS, quick=True).flows
    assert not bench.make_plan(NO_OPTIONS | {"--sizes": "1e4"}, quick=False).flows
    assert not bench.make_plan(NO_OPTIONS | {"--precision": "mixed"}, quick=False).flows
    plan = bench.make_plan(NO_OPTIONS | {"--flows": "flume,tumbler"}, quick=False)
    assert (list(plan.flows), plan.block) == (["flume", "tumbler"], False)
    assert list(bench.make_plan(NO_OPTIONS | {"--flows": "all"}, quick=False).flows) == list(FLOWS)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--flows", "river"], "river"),
        (["--flows", ""], "--flows"),
        (["--flows", "all", "--sizes", "1e4"], "--sizes"),
        (["--flows", "all", "--quick"], "--quick"),
        (["--flows", "all", "--ranks", "2"], "--ranks"),
    ],
)
def test_what_does_not_go_with_flows(options, named, capsys):
    assert bench_ends(*options) == 2
    assert named in capsys.readouterr().err
