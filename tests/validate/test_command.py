"""`doseki validate`: reports, pictures, exit codes."""

import json
import math

import pytest

from doseki.cli.main import main
from doseki.validate import catalogue, report
from doseki.validate.case import Outcome, Value
from doseki.validate.judging import Row, validate_case

from .conftest import made_up


@pytest.fixture
def only(monkeypatch):
    """Let these be the only cases there are."""

    def these(*cases):
        monkeypatch.setattr(catalogue, "all_cases", lambda: {case.name: case for case in cases})

    return these


def exit_code(*arguments):
    with pytest.raises(SystemExit) as caught:
        main(["validate", *arguments])
    return caught.value.code


def test_report_and_picture(only, make_case, tmp_path, capsys):
    only(make_case())
    assert exit_code("--tier", "full", "-o", str(tmp_path / "v")) == 0
    printed = capsys.readouterr()
    assert "| made-up" in printed.out
    assert "2.00" in printed.out
    assert "made-up: L/dp = 40" in printed.err
    assert (tmp_path / "v" / "made-up.png").stat().st_size > 1000
    page = (tmp_path / "v" / "validation.md").read_text()
    assert "made up" in page
    assert "![made-up](made-up.png)" in page
    table = json.loads((tmp_path / "v" / "validation.json").read_text())
    assert table["passed"]
    assert [row["order"] for row in table["cases"][0]["rows"]][2] == pytest.approx(2)


def test_exit_code_1_when_a_case_fails(only, make_case, tmp_path, capsys):
    only(make_case(tolerance=1e-9, name="bad"), make_case(name="good"))
    assert exit_code("-o", str(tmp_path), "--json") == 1
    table = json.loads(capsys.readouterr().out)
    assert [case["verdict"] for case in table["cases"]] == ["FAIL", "pass"]
    assert not table["passed"]


def test_only_the_named_cases_run(only, make_case, tmp_path, capsys):
    only(make_case(name="one"), make_case(name="two"))
    assert exit_code("two", "-o", str(tmp_path)) == 0
    assert "1 cases: 1 pass" in capsys.readouterr().out


def test_exit_code_2_for_a_wrong_name(capsys):
    assert exit_code("hydrostatik") == 2
    assert "did you mean hydrostatic?" in capsys.readouterr().err


def test_exit_code_2_for_a_wrong_tier():
    assert exit_code("--tier", "fine") == 2


def test_a_number_that_is_none_fails_and_is_null(only, make_case, tmp_path, capsys):
    only(make_case(run=lambda _: Outcome({"value": Value(math.nan, 2.0)})))
    assert exit_code("--tier", "full", "-o", str(tmp_path), "--json") == 1
    assert json.loads(capsys.readouterr().out)["cases"][0]["rows"][0]["value"] is None


def test_table_is_aligned_and_notes_are_tame(make_case):
    result = validate_case(make_case(), "full", lambda _: None)
    result.rows.append(Row("made-up", "value", 10, "FAIL", made_up(10).values["value"], note="a|b"))
    lines = report.table_text([result]).splitlines()
    assert len({len(line) for line in lines}) == 1
    assert len({line.count("|") for line in lines}) == 1


def test_the_report_is_written_after_each_case(only, make_case, tmp_path):
    def stop(_resolution):
        raise KeyboardInterrupt

    only(make_case(name="first"), make_case(name="second", run=stop))
    assert exit_code("-o", str(tmp_path)) == 130
    table = json.loads((tmp_path / "validation.json").read_text())
    assert [case["name"] for case in table["cases"]] == ["first"]
