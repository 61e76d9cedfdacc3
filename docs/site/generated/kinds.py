"""In which runs a kind of body or gauge can stand at all."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from doseki.scenario.gauges.gauge import Gauge, Setting
from doseki.scenario.schemes import RESOLVED, UETA2022
from doseki.scenario.table import Table, only_kind
from doseki.scenario.tables.body import BodyTable


def where_alone(section: str, kind: type[Table]) -> str:
    """A sentence on the schemes and dimensions that have this kind; empty where all have it."""
    words = []
    if issubclass(kind, BodyTable):
        words = [f"{kind.only_dim}-D runs"] if kind.only_dim else []
        words += ["solids of the resolved scheme"] if kind.is_solid else []
    elif issubclass(kind, Gauge):
        refused = {(s, d) for s in (UETA2022, RESOLVED) for d in (2, 3) if _is_refused(kind, s, d)}
        if {(UETA2022, 2), (UETA2022, 3)} <= refused:
            words.append("the resolved scheme")
        if {(UETA2022, 2), (RESOLVED, 2)} <= refused:
            words.append("3-D runs")
    return f"Only for {' and '.join(words)}." if words else ""


def _is_refused(kind: type[Gauge], scheme: str, dim: int) -> bool:
    """Whether a gauge objects to the run as such, by its key `kind`."""
    gauge = kind.model_construct(kind=only_kind(kind, "kind"), bodies=["wall"])
    around = Setting(
        dim, 0.1, 0.1, scheme, np.zeros(dim), (), None, defaultdict(lambda: True),
        defaultdict(lambda: "fixed"), ["water"], ["wall"], {"wall": ["wall"]},
    )  # fmt: skip
    try:
        return any(key == "kind" for key, _ in gauge.objections(around))
    except AttributeError:  # of a key that is not given here: what comes after is about keys
        return False
