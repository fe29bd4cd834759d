"""The estimator, sample by sample or over arrays."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional, Union

import numpy as np

from . import _proprio
from ._arrays import to_arrays, to_raw
from ._table import Table, as_table


class Estimator:
    """The estimator of an arm: by default in the board's fixed point, with the same bits.

    One object is one session after the other: `start` begins the next. The few kB of its configuration stay in memory until
    Python ends.
    """

    def __init__(
        self, table: Union[Table, str, os.PathLike[str]], rate_hz: Optional[float] = None, *, float: bool = False
    ) -> None:
        """An estimator at the start of a session of `rate_hz` samples per second, by default the table's.

        `float` selects the 64-bit float reference instead of fixed point. Raises `Error`.
        """
        self.table = as_table(table)
        self._estimator = _proprio.Estimator(self.table, rate_hz, float)

    def start(self) -> None:
        """Starts a session: the arm is tared again, and the state of the one before is cleared."""
        self._estimator.start()

    def update(self, time_s: float, bend_counts: Any = None, imu: Any = None) -> dict[str, Any]:
        """Processes one sample. Raises `Error` for readings that no sensor gives.

        Args:
            time_s: Time, s; not before the sample before.
            bend_counts: (s, 2) ADC counts of each segment's bend sensors a and b; NaN or `None` where they are missing.
            imu: (s,) headings, rad, clockwise; or (s, 4) quaternions w, x, y, z; NaN or `None` where they are missing.

        Returns:
            The estimate: the keys of `replay` for one sample, so that `fusion_theta_rad` has the shape (s,).
        """
        if bend_counts is None:
            bend_counts = np.full((self.table.segments, 2), np.nan)
        sample: dict[str, Any] = {"time_s": [time_s], "bend_counts": np.asarray(bend_counts, np.float64)[np.newaxis]}
        if imu is not None:
            readings = np.asarray(imu, np.float64)[np.newaxis]
            sample["imu_quaternion" if readings.ndim == 3 else "imu_heading_rad"] = readings
        return {name: values[0] for name, values in self.run(sample).items()}

    def run(self, session: Mapping[str, Any]) -> dict[str, Any]:
        """Processes the samples of a session's arrays, as `read` gives them, and returns arrays with the keys of `replay`.

        A sample with `start` starts the estimator before it; without that the session goes on from the samples before. Raises
        `Error` for readings that no sensor gives.
        """
        return to_arrays(self._estimator.run(to_raw(session)))
