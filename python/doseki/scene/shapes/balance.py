"""Arrangements of particles of an elastic body in which an even stress is in balance.

The force of an even stress P on a particle, Eq. (83), is P times the sum of V F (B_i + B_j) R_ij
over its neighbours.  On a lattice the sum vanishes inside; elsewhere stress has to make up for it,
by as much at any resolution.  Lengths in spacings.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import coo_array, csr_array, eye_array, kron
from scipy.sparse.linalg import lsmr
from scipy.spatial import cKDTree

SUPPORT = 1.6  # of the kernel of elastic bodies; its F is a multiple of (1 - q)^3
CLOSE = 5e-3  # largest sum left; 0.6 at the centre of rings
MOST_STEPS, LONGEST_STEP = 20, 0.1
DAMPING = 0.2  # of shifts that hardly change the sums


def balanced(
    position: np.ndarray, free: np.ndarray, symmetrised: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """Positions (N, dim) from which those that are `free` (N,) bool feel no even stress.

    By Levenberg and Marquardt's method, for equal volumes; particles of rings go half a spacing at
    most.  `symmetrised` gives shifts (N, dim) the symmetry of the positions, which rounding loses.
    """
    x = position.copy()
    moving = np.flatnonzero(np.repeat(free, x.shape[1]))
    for _ in range(MOST_STEPS):
        force, slope = imbalance(x)
        left = force.ravel()[moving]
        if np.abs(left).max(initial=0.0) < CLOSE:
            break
        shift = np.zeros(x.size)
        shift[moving] = lsmr(
            slope[moving][:, moving], -left, DAMPING, atol=1e-4, btol=1e-4, maxiter=1000
        )[0]
        x += symmetrised(shift.reshape(x.shape)) * min(1.0, LONGEST_STEP / np.abs(shift).max())
    return x


def imbalance(x: np.ndarray) -> tuple[np.ndarray, csr_array]:
    """The sums of F (B_i + B_j) R_ij (N, dim), and their derivatives by positions."""
    n, dim = x.shape
    a, b = cKDTree(x).query_pairs(SUPPORT, output_type="ndarray").T
    pairs, unit, points = np.arange(len(a)), np.eye(dim), np.arange(n)
    R = x[a] - x[b]
    r = np.linalg.norm(R, axis=1)
    F = (1 - r / SUPPORT) ** 3
    dF = (-3 / SUPPORT * (1 - r / SUPPORT) ** 2 / r)[:, None] * R
    ends = (
        _blocks(pairs, a, np.ones((len(a), 1, 1)), n),
        _blocks(pairs, b, np.ones((len(b), 1, 1)), n),
    )
    difference = kron(ends[0] - ends[1], eye_array(dim)).tocsr()
    total = kron(ends[0] + ends[1], eye_array(dim * dim)).tocsr()

    square = np.einsum("pi,pj->pij", R, R)
    moment = (total.T @ (F[:, None, None] * square).ravel()).reshape(n, dim, dim)
    B = np.linalg.inv(moment)
    C = B[a] + B[b]
    CR = np.einsum("pij,pj->pi", C, R)
    force = (difference.T @ (F[:, None] * CR).ravel()).reshape(n, dim)

    # d(F R R), then dB = -B dM B, then d(F C R) by R and by C.
    turned = np.einsum("ik,pj->pijk", unit, R) + np.einsum("jk,pi->pijk", unit, R)
    d_moment = np.einsum("pij,pk->pijk", square, dF) + F[:, None, None, None] * turned
    d_inverse = -np.einsum("nik,nlj->nijkl", B, B)
    by_R = np.einsum("pi,pk->pik", CR, dF) + F[:, None, None] * C
    by_C = np.einsum("p,ik,pj->pikj", F, unit, R)
    whole = len(a)
    inner = (
        _blocks(pairs, pairs, by_C.reshape(whole, dim, -1), whole)
        @ total
        @ _blocks(points, points, d_inverse.reshape(n, dim * dim, -1), n)
        @ total.T
        @ _blocks(pairs, pairs, d_moment.reshape(whole, -1, dim), whole)
    )
    slope = difference.T @ (_blocks(pairs, pairs, by_R, whole) + inner) @ difference
    return force, slope.tocsr()


def _blocks(row: np.ndarray, column: np.ndarray, block: np.ndarray, columns: int) -> csr_array:
    """Blocks (n, p, q), one at each row and column of blocks; there are `columns` of the latter."""
    _, p, q = block.shape
    at = np.broadcast_to((p * row[:, None] + np.arange(p))[:, :, None], block.shape)
    to = np.broadcast_to((q * column[:, None] + np.arange(q))[:, None, :], block.shape)
    size = (p * (int(row.max()) + 1), q * columns)
    return coo_array((block.ravel(), (at.ravel(), to.ravel())), size).tocsr()
