"""NumPy arrays from and to the bytes of the extension module."""

from __future__ import annotations

from typing import Any, Mapping, Optional

import numpy as np


def to_arrays(raw: Mapping[str, Any]) -> dict[str, Any]:
    """The arrays of a result, by their names."""
    return {name: np.frombuffer(data, dtype).reshape(-1, *row) for name, (data, dtype, row) in raw.items()}


def to_raw(session: Mapping[str, Any]) -> dict[str, Any]:
    """The readings and the truth of a session as the extension module takes them."""
    time_s = _floats(session["time_s"], "time_s", 1)
    n = len(time_s)
    bend = session.get("bend_counts")
    heading, quaternion = session.get("imu_heading_rad"), session.get("imu_quaternion")
    known = [array for array in (bend, quaternion, heading) if array is not None]
    if not known:
        raise ValueError("a session has bend_counts, imu_heading_rad or imu_quaternion, found none of them")
    segments = np.shape(known[0])[1] if np.ndim(known[0]) > 1 else 0
    if bend is None:
        bend = np.full((n, segments, 2), np.nan)
    # The quaternion is the finer reading.
    if quaternion is not None:
        heading = None
    elif heading is None:
        heading = np.full((n, segments), np.nan)
    return {
        "segments": segments,
        "time_s": time_s.tobytes(),
        "start": np.ascontiguousarray(session.get("start", np.zeros(n)), bool).tobytes(),
        "bend_sensors": np.ascontiguousarray(session.get("bend_sensors", ()), bool).tobytes(),
        "bend_counts": _bytes(bend, "bend_counts", (n, segments, 2)),
        "imu_heading_rad": _bytes(heading, "imu_heading_rad", (n, segments)),
        "imu_quaternion": _bytes(quaternion, "imu_quaternion", (n, segments, 4)),
        "truth_m": _bytes(session.get("truth_m"), "truth_m", (n, segments, 2)),
        "truth_heading_rad": _bytes(session.get("truth_heading_rad"), "truth_heading_rad", (n, segments)),
    }


def _floats(values: Any, name: str, dimensions: int) -> np.ndarray:
    array = np.ascontiguousarray(values, np.float64)
    if array.ndim != dimensions:
        raise ValueError(f"{name} has {array.ndim} dimensions, expected {dimensions}")
    return array


def _bytes(values: Optional[Any], name: str, shape: tuple[int, ...]) -> bytes:
    if values is None:
        return b""
    array = _floats(values, name, len(shape))
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}, expected {shape}")
    return array.tobytes()


def columns(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """A list of reports as a dictionary of arrays; a missing number is NaN."""
    names = rows[0].keys() if rows else ()
    return {name: _column([row[name] for row in rows]) for name in names}


def _column(values: list[Any]) -> np.ndarray:
    if any(value is None for value in values):
        return np.array([np.nan if value is None else value for value in values], np.float64)
    is_ragged = len({len(value) for value in values if isinstance(value, list)}) > 1
    return np.array(values, object) if is_ragged else np.array(values)
