"""Arrays for other tools."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Mapping, Union

import numpy as np

if TYPE_CHECKING:
    import pandas


def to_mat(path: Union[str, os.PathLike[str]], arrays: Mapping[str, Any]) -> None:
    """Writes the arrays of a result to a MATLAB file of version 5, one variable for each; needs the package `scipy`.

    Dictionaries, such as `metrics`, become structures. Tables and values that are `None` are left out.
    """
    from scipy.io import savemat

    savemat(os.fspath(path), _storable(arrays), long_field_names=True)


def _storable(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values that a MATLAB file can hold."""
    known = {name: _storable(value) if isinstance(value, Mapping) else value for name, value in values.items()}
    return {name: value for name, value in known.items() if isinstance(value, (dict, str, bool, int, float, list, np.ndarray))}


def to_pandas(arrays: Mapping[str, Any]) -> pandas.DataFrame:
    """The arrays of a session or of estimates as a table, one row for each sample; needs the package `pandas`.

    `time_s` is the index. Segments count from 1: `fusion_theta_rad_1`, `fusion_end_m_1_x`, `bend_counts_1_a`.
    """
    import pandas

    rows = len(arrays["time_s"])
    found: dict[str, np.ndarray] = {}
    for name, values in arrays.items():
        if name not in ("time_s", "bend_sensors") and isinstance(values, np.ndarray) and len(values) == rows:
            found.update(_named(name, values))
    return pandas.DataFrame(found, index=pandas.Index(arrays["time_s"], name="time_s"))


_PARTS = {"bend_counts": "ab", "imu_quaternion": "wxyz", "end_covariance_m2": ("xx", "xy", "yy")}


def _named(name: str, values: np.ndarray) -> dict[str, np.ndarray]:
    """The columns of an array."""
    if values.ndim == 1:
        return {name: values}
    segments = range(values.shape[1])
    if values.ndim == 2:
        return {f"{name}_{i + 1}": values[:, i] for i in segments}
    parts = _PARTS.get(name, "xy")
    return {f"{name}_{i + 1}_{part}": values[:, i, k] for i in segments for k, part in enumerate(parts)}
