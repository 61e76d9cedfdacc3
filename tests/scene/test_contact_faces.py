"""Areas of faces on which films of water press."""

from __future__ import annotations

import numpy as np
import pytest

from doseki.scenario.load import load_scenario
from doseki.scene.build import build_scene
from doseki.scene.contact_faces import contact_faces
from doseki.validate.running import CASES


@pytest.mark.parametrize(("dim", "across"), [(2, 5), (2, 6), (2, 12), (3, 5), (3, 6)])
def test_the_first_row_of_a_face_has_the_area_of_all_rows(dim, across):
    """Also beside edges, where deep particles see the outside below and beside the block."""
    block = str(CASES / "grains" / "block-under-water.toml")
    scenario = load_scenario(block, [f"across={across}", f"dim={dim}"])
    scene = build_scene(scenario)
    bodies, particles = scene.bodies, scene.particles
    faces = contact_faces(scenario, particles, bodies, bodies.depth)
    height = particles.position[:, -1] / scenario.dp
    lower = (bodies.grain == 0) & (height < 0.5 * across - 0.25)
    first = lower & (faces.face > 0)
    dealt = (faces.rows[first, None] * faces.area[first]).sum(axis=0)
    assert dealt == pytest.approx(
        faces.area[lower].sum(axis=0), abs=0.002 * across * scenario.dp ** (dim - 1)
    )
    assert np.all(faces.rows[lower] < 1.2)
