"""Algebra of small matrices, and that it is written once."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

CORE = Path(__file__).resolve().parents[3] / "core"


def test_inverse_is_that_of_linear_algebra(point, dim, random):
    m = np.eye(dim) + 0.3 * random.uniform(-1, 1, (30, dim, dim))
    got = point("inverse", *m.reshape(30, -1).T, 0.0, dim=dim).T.reshape(m.shape)
    np.testing.assert_allclose(got, np.linalg.inv(m), rtol=1e-12, atol=1e-13)


def test_nearly_singular_matrices_have_the_inverse_zero(point, dim):
    diagonal = np.diag([0.49] + [1.0] * (dim - 1)).ravel()
    assert not point("inverse", *diagonal, 0.5, dim=dim).any()
    assert point("inverse", *diagonal, 0.48, dim=dim).any()


def test_only_one_function_inverts_a_matrix():
    """Whatever divides by a determinant is an inversion, but for stresses per current volume."""
    divides = re.compile(r"/ (det|determinant)\b")
    files = {
        path.relative_to(CORE).as_posix()
        for path in CORE.rglob("*.hpp")
        if divides.search(path.read_text(encoding="utf-8"))
    }
    assert {file for file in files if "hyperelastic/" not in file} == {"base/matrix.hpp"}
