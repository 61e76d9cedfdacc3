"""Every field of a particle, declared once: files, Python names and labels derive from here."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .units import unit_in

SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # XX YY ZZ XY YZ XZ, as VTK has it
SHAPES = ("scalar", "vector", "symmetric", "rows")


@dataclass(frozen=True)
class ParticleField:
    """One field: its name in Python and in files, its symbol, unit (3-D), shape and meaning.

    A "vector" is (N, dim) in Python and (N, 3) in files (z = 0 in 2-D); a "symmetric" tensor is
    (N, 3, 3) in Python and (N, 6) in files, in the order of SYMMETRIC; "rows" are alike in both.
    """

    key: str
    file_name: str
    symbol: str
    unit: str
    shape: str
    doc: str
    dtype: str = "float64"
    width: int = 1  # of "rows"
    absent: int | None = None  # the value where a state or an older file has none

    def unit_in(self, dim: int) -> str:
        """Its unit in a run of `dim` dimensions."""
        return unit_in(self.unit, dim)

    @property
    def columns(self) -> tuple[int, ...]:
        """The shape of one row in a file."""
        return {"vector": (3,), "symmetric": (6,), "rows": (self.width,)}.get(self.shape, ())

    def encode(self, values: np.ndarray) -> np.ndarray:
        """The array as it stands in a file, from the array as it stands in Python."""
        values = np.asarray(values, self.dtype)
        if self.shape == "symmetric":
            return np.stack([values[:, a, b] for a, b in SYMMETRIC], axis=1)
        if self.shape == "vector" and values.shape[1] == 2:
            return np.pad(values, ((0, 0), (0, 1)))
        return values

    def decode(self, stored: np.ndarray, dim: int) -> np.ndarray:
        """The inverse of `encode` in a run of `dim` dimensions."""
        if self.shape == "vector":
            return np.ascontiguousarray(stored[:, :dim])
        if self.shape == "symmetric":
            tensor = np.empty((len(stored), 3, 3), stored.dtype)
            for component, (a, b) in enumerate(SYMMETRIC):
                tensor[:, a, b] = tensor[:, b, a] = stored[:, component]
            return tensor
        return stored


FIELDS = (
    ParticleField("position", "Points", "x", "m", "vector", "position"),
    ParticleField("velocity", "Velocity", "v", "m/s", "vector", "velocity"),
    ParticleField("density", "Density", "rho", "kg/m3", "scalar", "density"),
    ParticleField("pressure", "Pressure", "p", "Pa", "scalar", "pressure"),
    ParticleField("mass", "Mass", "m", "kg", "scalar", "mass; in 2-D per metre of thickness"),
    ParticleField("smoothing_length", "SmoothingLength", "h", "m", "scalar", "smoothing length"),
    ParticleField("stress", "Stress", "sigma", "Pa", "symmetric", "Cauchy stress"),
    ParticleField("deviatoric_stress", "DeviatoricStress", "S", "Pa", "symmetric", "elastic part"),
    ParticleField("sound_speed", "SoundSpeed", "c", "m/s", "scalar", "bulk sound speed"),
    ParticleField("material", "Material", "", "", "scalar", "index of the material", "int32"),
    ParticleField("body", "Body", "", "", "scalar", "index of the body", "int32"),
    ParticleField(
        "motion",
        "Motion",
        "",
        "",
        "scalar",
        "0 free, 1 fixed, 2 driven by an inflow, 3 bound",
        "int32",
    ),
    ParticleField("id", "Id", "", "", "scalar", "number that stays with the particle", "int64"),
    ParticleField(
        "grain", "Grain", "", "", "scalar", "index of its grain, or -1", "int32", absent=-1
    ),
    ParticleField(
        "damage", "Damage", "", "", "scalar", "share of its bonds that is broken", absent=0
    ),
)

FIELD_BY_KEY = {field.key: field for field in FIELDS}

# Of bodies that move, one row each.
GRAIN_FIELDS = (
    ParticleField("position", "Position", "", "m", "vector", "centre of mass"),
    ParticleField("velocity", "Velocity", "", "m/s", "vector", "of the centre of mass"),
    ParticleField("spin", "Spin", "", "rad/s", "rows", "angular velocity (N, 3)", width=3),
    ParticleField(
        "orientation", "Orientation", "", "", "rows", "quaternion w, x, y, z (N, 4)", width=4
    ),
    ParticleField("diameter", "Diameter", "", "m", "scalar", "of the circumscribed ball"),
    ParticleField("mass", "Mass", "", "kg", "scalar", "mass; in 2-D per metre of thickness"),
    ParticleField("contacts", "Contacts", "", "", "scalar", "number of bodies it touches", "int32"),
    ParticleField("overlap", "Overlap", "", "", "scalar", "largest overlap over the diameter"),
    ParticleField("removed", "Removed", "", "", "scalar", "1: has left or is all dust", "int32"),
    ParticleField("body", "Body", "", "", "scalar", "index of the named body", "int32"),
    ParticleField(
        "parent",
        "Parent",
        "",
        "",
        "scalar",
        "row of the body it was part of, or -1",
        "int32",
        absent=-1,
    ),
    ParticleField("born", "Born", "", "s", "scalar", "when it came off", absent=0),
)
