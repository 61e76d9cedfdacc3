"""The page on paper, on a phone, and with long words."""

from __future__ import annotations

import numpy as np
import pytest
from tests.synthetic_runs import BODIES, MATERIALS, SCENARIO, history_row, random_state

from doseki.record.writer import Recorder
from doseki.report.report import write_report

from .browser import needs_browser, printed, told
from .conftest import give_figure

pytestmark = [needs_browser, pytest.mark.minutes]
LIGHT = (238, 241, 245)  # behind the picture
DARK = "--blink-settings=preferredColorScheme=0"
PHONE = "--window-size=600,900"


@pytest.fixture
def page(map_run):
    """The report on the run on a map."""
    return write_report(map_run).path


def test_a_dark_desktop_prints_what_a_light_one_does(page, tmp_path):
    light, dark = (printed(page, tmp_path / f"profile{k}", *options)
                   for k, options in enumerate([(), (DARK,)]))  # fmt: skip
    assert len(light) == len(dark)
    for one, other in zip(light, dark, strict=True):
        assert one.shape == other.shape
        assert np.abs(one - other).max() <= 1
    assert any(tuple(picture[0, 0]) == LIGHT for picture in dark)


PAPER = """
const share = () => {
  const [bar, stage] = [part("bar"), document.querySelector(".stage")];
  return bar.getBoundingClientRect().width / stage.clientWidth;
};
const size = () => [part("picture").width, part("picture").height];
tell([share(), size()]);
dispatchEvent(new Event("beforeprint"));
document.getElementById("viewer").style.width = "70%";
tell([share(), size()]);
await rest(500);
tell([share(), size()]);
dispatchEvent(new Event("afterprint"));
tell([share(), size()]);
"""


def test_the_scale_bar_is_true_on_paper(page, tmp_path):
    screen, *paper, after = told(page, "", PAPER, tmp_path / "profile")
    assert screen[0] > 0.05
    for share, size in paper:
        assert share == pytest.approx(screen[0], rel=0.01)
        assert size == screen[1]
    assert after[1] != screen[1]


PLACES = """
await rest(500);
for (const name of ["legend", "picture"]) {
  const { top, bottom } = part(name).getBoundingClientRect();
  tell([top, bottom]);
}
"""


def test_the_legend_is_over_the_picture_of_a_phone(page, tmp_path):
    legend, picture = told(page, "", PLACES, tmp_path / "profile", PHONE)
    assert legend[1] > legend[0]
    assert legend[1] <= picture[0] + 1
    assert picture[1] > picture[0] + 200


def test_long_words_do_not_widen_the_page(tmp_path):
    word = "https://example.org/" + 300 * "x"
    text = SCENARIO.format(dim=2, zeros="").replace('"synthetic"', f'"{word}"')
    folder = tmp_path / "run"
    recorder = Recorder(folder, f'{text}description = "{word}"\n', MATERIALS, BODIES, 2)
    recorder.snapshot(random_state(20, 2), time=0.0, step=0, dt=0.1)
    recorder.history(history_row(0.0))
    recorder.close({"status": "done", "warnings": [word]})
    give_figure(folder)
    page = write_report(folder).path
    script = "tell(document.documentElement.scrollWidth); tell(innerWidth);"
    scrolled, window = told(page, "", script, tmp_path / "profile")
    assert scrolled <= window
