"""Materials and the laws that they follow, each declared once."""

from .complete import MaterialError, complete_materials
from .laws import (
    ELASTIC_DEFAULTS,
    EQUATIONS_OF_STATE,
    FRACTURES,
    HYPERELASTIC_LAWS,
    MOST_FLAWS,
    NO_FRACTURE,
    RHEOLOGIES,
    Law,
    equation_of_state,
    fracture_keys,
    laws_of,
)
from .material import BUILT_IN, LAWS, MATERIAL_PARAMETERS, Material
from .parameters import MaterialParameter
from .presets import CONCENTRATIONS, PRESETS, SOILS, mud

__all__ = [
    "BUILT_IN",
    "CONCENTRATIONS",
    "ELASTIC_DEFAULTS",
    "EQUATIONS_OF_STATE",
    "FRACTURES",
    "HYPERELASTIC_LAWS",
    "LAWS",
    "MATERIAL_PARAMETERS",
    "MOST_FLAWS",
    "NO_FRACTURE",
    "PRESETS",
    "RHEOLOGIES",
    "SOILS",
    "Law",
    "Material",
    "MaterialError",
    "MaterialParameter",
    "complete_materials",
    "equation_of_state",
    "fracture_keys",
    "laws_of",
    "mud",
]
