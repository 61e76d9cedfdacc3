"""The shipped cases: whole, findable, and at their coarsest resolution as good as they say."""

import pytest

from doseki.validate.case import Case
from doseki.validate.catalogue import all_cases
from doseki.validate.judging import FAIL, validate_case
from doseki.validate.report import remarks
from doseki.validate.running import CASES

# Cases that the default tier runs.
CANARIES = (
    "artificial-viscosity", "bingham", "couette-disc", "dam-front", "elastic-oblique",
    "elastic-plate", "elliptical-drop-disturbed", "grains-drag", "grains-incline",
    "grains-stream", "grains-under-water", "hydrostatic", "layers", "nusselt-film", "poiseuille",
    "shear-decay", "sound-wave", "still-water", "taylor-green-100-lattice", "voellmy-slab",
)  # fmt: skip
# One case each of the families that take minutes at their coarsest: the tier validate has them.
SLOW = ("channel-plane", "hydrostatic-plate", "sphere-in-oil")


def test_names_and_words():
    for name, case in all_cases().items():
        assert isinstance(case, Case)
        assert name == case.name == name.lower()
        assert case.title
        assert all(criterion.reason for criterion in case.criteria)
        assert len(case.resolutions) == 3


def test_scenarios_are_part_of_the_package():
    assert (CASES / "free_surfaces/tank.toml").is_file()


def test_every_family_has_one_canary():
    """A family: the cases of one module."""
    families = [case.run.__module__ for case in all_cases().values()]
    canaries = [all_cases()[name].run.__module__ for name in (*CANARIES, *SLOW)]
    assert sorted(canaries) == sorted(set(families))


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[] if name in CANARIES else pytest.mark.validate)
        for name in all_cases()
    ],
)
def test_coarse(name):
    result = validate_case(all_cases()[name], "coarse", lambda _: None)
    assert not [row for row in result.rows if row.verdict == FAIL], remarks([result])
