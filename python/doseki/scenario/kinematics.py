"""How the particles of a body move, and which keys of its table that gives a meaning."""

from __future__ import annotations

from dataclasses import dataclass

OF_POINTS = ("damping", "elastic_law", "flaw_seed", "hourglass")
ELASTIC_KEYS = (*OF_POINTS, "clamped", "displacement")
OF_WHOLE_BODIES = ("kinematics", "spin", "settle")


@dataclass(frozen=True)
class Kinematics:
    """One way for the particles of a body to move."""

    name: str
    is_whole: bool = False  # its particles move as those of rigid or deformable bodies
    keys: tuple[str, ...] = ()  # of a table [body.NAME] that mean something only in some ways

    def why_not(self, key: str) -> str | None:
        """Why a body that moves in this way has no such key; None where it has."""
        if key in self.keys:
            return None
        if self.is_whole and key in OF_POINTS:
            return 'only kinematics = "elastic" and "breakable" have it'
        if self.is_whole and key in ELASTIC_KEYS:
            return 'only kinematics = "elastic" has it'
        if not self.is_whole and key in (*OF_WHOLE_BODIES, *ELASTIC_KEYS):
            return "only solids of the resolved scheme that are not fixed have it"
        return None


FIXED = Kinematics("fixed")  # moves only as its `motion` says
PARTICLES = Kinematics("particles")  # each particle by itself, as the scheme says
RIGID = Kinematics("rigid", True, OF_WHOLE_BODIES)
SINGLE = Kinematics("single", True, OF_WHOLE_BODIES)  # rigid, one particle per body
ELASTIC = Kinematics("elastic", True, (*OF_WHOLE_BODIES, *ELASTIC_KEYS))
BREAKABLE = Kinematics("breakable", True, (*OF_WHOLE_BODIES, *OF_POINTS))  # rigid until struck
DEFORM = ("elastic", "breakable")  # the kinematics of bodies that are not always rigid
