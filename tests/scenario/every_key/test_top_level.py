"""Every key of the top level changes the run or is refused: see walk.py."""

from __future__ import annotations

from doseki.scenario.tables.root import ScenarioTable
from doseki.scenario.tables.sections import SECTIONS

from .walk import BLOCK, NONE, SCHEMES, WORDS, cases, ignored, text_of

# Not what a run computes: when it writes, and what is drawn of it (tests/driver, tests/figures).
OF_RECORD = {"time_max", "time_out", "time_history", *SECTIONS}
# In test_materials.py, tests/start, test_maps.py and test_terrain.py.
ELSEWHERE = {"contact", "start", "maps", "terrain"}

ROOT = {
    "dim": ["{other_dim}"],
    "scheme": ["{other_scheme}"],
    "dp": ["0.09"],
    "kernel": ["wendland_c6", "wendland_c2"],
    "eos": ["tait"],
    "viscosity": ["monaghan_cleary"],
    "turbulence": ["smagorinsky", "mixing_length"],
    "smagorinsky": ["0.3", "0.3 with turbulence=smagorinsky"],
    "shifting": ["false"],
    "acoustic_damping": ["0.3", "0"],
    "relax": ["0.01"],
    "uplift": ["false"],
    "speed_max": ["8"],
    "precision": ["mixed"],
    "gravity": ["[1, {zeros}-5]"],
    "slope": ["10"],
    "g": ["5 with slope=10", "5 with gravity=[0, {zeros}0]; xi_height=0.3"],
    "attraction": ["2"],
    "eta": ["1.35"],
    "alpha": ["0.5"],
    "balsara": ["false"],
    "strength": ["false"],
    "tension": ["free", "clamp_all"],
    "h_mode": ["eq10"],
    "sym_grad": ["true with h_mode=eq10"],
    "cflnumber": ["0.05"],
    "cfl_force": ["0.001"],
    "xi": ["0.07"],
    "xi_height": ["0.7"],
    "fixed_limits_dt": ["false"],
    "skin": ["0.2"],
    "periodic": ['["x"] with domain_min=[-0.3, {low}-1]; domain_max=[1.6, {high}1]'],
    "domain_min": ["[-0.4, {low}-1]"],
    "domain_max": ["[1.7, {high}1]"],
}  # fmt: skip


@cases
def test_the_top_level(tmp_path, scheme, dim):
    path = tmp_path / "case.toml"
    path.write_text(text_of(scheme, dim, BLOCK))
    middle = (
        {"zeros": "0, ", "low": "-1, ", "high": "1, "}
        if dim == 3
        else dict.fromkeys(("zeros", "low", "high"), "")
    )
    middle |= {
        "other_dim": str(5 - dim),
        "other_scheme": next(other for other in SCHEMES if other != scheme),
    }
    values = {key: [v.format(**middle) for v in entries] for key, entries in ROOT.items()}
    keys = set(ScenarioTable.model_fields) - WORDS - OF_RECORD - ELSEWHERE
    assert ignored(str(path), "", sorted(keys), values) == NONE
