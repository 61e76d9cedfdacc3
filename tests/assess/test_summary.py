"""The summary fits on one screen and says what matters."""

from __future__ import annotations

from doseki.assess.summary import duration_text, summary_text
from doseki.record.reader import load

from ..synthetic_runs import flow_state


def test_a_front_of_no_fluid_is_none(tmp_path, record_run):
    """All of it has left."""

    def draining(time):
        state = flow_state(time)
        stays = (state["material"] != 0) | (time < 2)
        return {name: values[stays] for name, values in state.items()}

    record_run(tmp_path / "run", state_at=draining)
    assert "front             no fluid is left at 2 s" in summary_text(load(tmp_path / "run"))


def test_summary_of_a_flow(flow_folder):
    text = summary_text(load(flow_folder))
    assert "synthetic" in text
    assert "3 s of 2 s" in text
    assert "1 min 15 s" in text
    assert "5 kg/m initial + 3 entered" in text
    assert "residual 0" in text
    assert "61 free, speed 1 m/s mean" in text
    assert "fluid from 2 s on, mean v_x -1 m/s" in text
    assert "front             x = 0 m" in text
    assert "warning           thin" in text
    assert len(text.splitlines()) <= 25


def test_summary_without_snapshots_or_history(tmp_path, record_run):
    record_run(tmp_path / "run", times=())
    assert "synthetic" in summary_text(load(tmp_path / "run"))


def test_long_times_are_in_hours():
    assert duration_text(9.96) == "10.0 s"
    assert duration_text(75) == "1 min 15 s"
    assert duration_text(3599) == "59 min 59 s"
    assert duration_text(87884) == "24 h 25 min"
