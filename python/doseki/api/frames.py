"""Columns of a table as a DataFrame of pandas, or as a Dataset of xarray, with their units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..record.reader import GaugeRecord, History
from ..util.extras import extra

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

Columns = Mapping[str, np.ndarray]
Units = Mapping[str, str]


def frame_of(columns: Columns, units: Units) -> pd.DataFrame:
    """Columns (N,) as a table; `attrs["units"]` has their units.

    Raises UserError where pandas is not installed.
    """
    with extra("analysis", "a table"):
        import pandas as pd
    frame = pd.DataFrame(dict(columns))
    frame.attrs["units"] = dict(units)
    return frame


def dataset_of(columns: Columns, units: Units) -> xr.Dataset:
    """Columns, of which the first is the time, as arrays over `time`.

    Where several rows have a time and the second column tells them apart in the same way at each,
    that column is the second dimension; else they are arrays over `row`.  Raises UserError where
    xarray is not installed.
    """
    with extra("analysis", "a Dataset"):
        import xarray as xr
    (first, times), *others = columns.items()
    unique = np.unique(times)
    if len(unique) == len(times):
        keys = {first: times}
    elif others and (grid := _second_key(times, others[0][1], len(unique))) is not None:
        keys = {first: unique, others[0][0]: grid}
    else:
        keys = {}
    shape = [len(values) for values in keys.values()] or [len(times)]
    found = xr.Dataset(coords={name: (name, values) for name, values in keys.items()})
    for name, values in columns.items():
        if name not in keys:
            found[name] = (list(keys) or ["row"], values.reshape(shape))
    for name in columns:
        found[name].attrs |= attributes(name.replace("_", " "), units.get(name, ""))
    return found


def attributes(long_name: str, unit: str) -> dict[str, str]:
    """What an array says of itself, as the CF conventions have it."""
    return {"long_name": long_name, "units": unit or "1"}


def _second_key(times: np.ndarray, key: np.ndarray, count: int) -> np.ndarray | None:
    """The values of the second column at each of `count` times; None where they differ."""
    if len(times) % count:
        return None
    keys, rows = key.reshape(count, -1), times.reshape(count, -1)
    alike = np.array_equal(keys, np.broadcast_to(keys[0], keys.shape))
    in_order = np.all(rows == rows[:, :1]) and len(np.unique(keys[0])) == len(keys[0])
    return keys[0] if alike and in_order else None


class Analysed(Mapping[str, np.ndarray]):
    """A table of a record that can become one of pandas or xarray."""

    units: dict[str, str]

    def to_pandas(self) -> pd.DataFrame:
        """A DataFrame with the time, s, as index, and a column for each other one of the record.

        Its `attrs["units"]` has the unit of each.  Raises UserError where pandas is not installed.
        """
        return frame_of(dict(self), self.units).set_index("time")

    def to_xarray(self) -> xr.Dataset:
        """A Dataset: each column is an array over `time`, s, with its unit in `attrs`.

        Where rows have a second key, such as the height of a profile, it is the second dimension.
        Raises UserError where xarray is not installed.
        """
        return dataset_of(dict(self), self.units)


class HistoryTable(Analysed, History):
    """The diagnostics of a run: a mapping from column name to the values over time, (N,).

    `units` has the unit of each column.
    """


class GaugeTable(Analysed, GaugeRecord):
    """What a gauge read: a mapping from column name to an array (N,), in `units`.

    A velocity profile has one row for each sample and height.
    """
