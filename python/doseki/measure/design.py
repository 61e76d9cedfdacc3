"""Loads that formulas for design expect of a flow that comes.

Depth h, m, speed v, m/s, and density rho, kg/m3, are those of the flow before the structure, arrays
(n,).  Pressures are Pa over the depth of the flow, forces N per metre of width.
"""

from __future__ import annotations

import numpy as np

KWAN_ALPHA = 2.5  # Kwan (2012), for rigid barriers
KWAN_REDUCTION = 0.1  # Kc of Kwan (2012), for the stiffness and strength that Hertz leaves out
HERTZ_BOULDER = 4e6  # N s^1.2 m^-3.2: granite on concrete, Lo (2000), Kwan (2012)


def momentum_flux(h: np.ndarray, v: np.ndarray, rho: np.ndarray) -> np.ndarray:
    """rho v2 h, N/m: of a jet that is turned aside at right angles (Eq. 100)."""
    return np.asarray(rho * v**2 * h)


def hydrostatic(h: np.ndarray, rho: np.ndarray, g: float) -> np.ndarray:
    """rho g h2/2, N/m, of a flow at rest as deep as that which comes (Eq. 100)."""
    return np.asarray(0.5 * rho * g * h**2)


def huebl_holzinger(h: np.ndarray, v: np.ndarray, rho: np.ndarray, g: float) -> np.ndarray:
    """Peak pressure 5 rho v^0.8 (g h)^0.6, Pa (Eq. 101).

    Huebl and Holzinger, WLS Report 50, Univ. of Natural Resources, Vienna (2003): fitted to
    debris flows of the laboratory and of the field; also in Huebl, Suda, Proske, Kaitna and
    Scheidl, Debris flow impact estimation, Ohrid (2009).
    """
    return np.asarray(5.0 * rho * v**0.8 * (g * h) ** 0.6)


def kwan(v: np.ndarray, rho: np.ndarray) -> np.ndarray:
    """Pressure alpha rho v2 with alpha = 2.5, Pa (Eq. 102).

    Kwan, Supplementary technical guidance on design of rigid debris-resisting barriers, GEO
    Report 270, Hong Kong (2012).
    """
    return np.asarray(KWAN_ALPHA * rho * v**2)


def boulder(speed: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Force of a boulder, Kc 4000 v^1.2 R2 kN, in N (Eq. 103); that of a sphere in 2-D as well.

    Hertz between an elastic sphere of granite and concrete, times Kc = 0.1 (Kwan 2012).
    """
    return np.asarray(KWAN_REDUCTION * HERTZ_BOULDER * speed**1.2 * radius**2)
