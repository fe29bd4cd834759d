"""Samples of a running monitor."""

from __future__ import annotations

import json
from typing import Any, Iterator, Optional
from urllib.parse import urlsplit

import numpy as np

from . import _proprio

# Columns of the monitor's rows, the key of their arrays, their parts for each segment, and the factor to m or rad.
_GROUPS = (
    ("fusion_theta_rad", ("theta{}_deg",), np.pi / 180),
    ("fusion_end_m", ("x{}_mm", "y{}_mm"), 1e-3),
    ("bend_counts", ("bend{}a_adc", "bend{}b_adc"), 1.0),
    ("imu_heading_rad", ("imu{}_deg",), np.pi / 180),
)


class Live:
    """Samples of a running monitor, one after the other, and the state of the board.

    Iteration waits for the next sample; it ends when the monitor does. A program that is too slow loses samples, and gets the
    next ones.

    Attributes:
        segments: Number of segments of the board's arm.
        status: State of board and line, five times a second, as a dictionary; `None` before the first.
    """

    segments: int
    status: Optional[dict[str, Any]]

    def __init__(self, address: str) -> None:
        self.status = None
        self._feed = _proprio.Feed(urlsplit(address).netloc or address)
        self._samples = self._decode()
        self._set_arm(json.loads(self._feed.next() or '{"segments": 0, "columns": []}'))

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return self._samples

    def __next__(self) -> dict[str, Any]:
        return next(self._samples)

    def __enter__(self) -> Live:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the monitor, which goes on."""
        self._feed.close()

    def _set_arm(self, arm: dict[str, Any]) -> None:
        self.segments = arm["segments"]
        places = {name: place for place, name in enumerate(arm["columns"])}
        self._places = {
            key: np.array([[places[name.format(i)] for name in names] for i in range(1, self.segments + 1)], int)
            for key, names, _ in _GROUPS
        }

    def _decode(self) -> Iterator[dict[str, Any]]:
        while (text := self._feed.next()) is not None:
            message = json.loads(text)
            if message["type"] == "arm":
                self._set_arm(message)
            elif message["type"] == "status":
                self.status = message
            elif message["type"] == "rows":
                for time_s, cells in message["rows"]:
                    yield self._sample(time_s, np.array(cells, np.float64))

    def _sample(self, time_s: float, values: np.ndarray) -> dict[str, Any]:
        sample: dict[str, Any] = {"time_s": time_s}
        for key, names, factor in _GROUPS:
            found = values[self._places[key]] * factor
            sample[key] = found[:, 0] if len(names) == 1 else found
        return sample


def open(address: str = "http://127.0.0.1:8642/") -> Live:
    """Opens the feed of a running `proprio monitor` or `proprio demo`, at the address that it prints. Raises `Error`.

        for sample in proprio.open():
            x_m, y_m = sample["fusion_end_m"][-1]

    A sample is a dictionary of values of s segments, rounded to 10⁻⁴ of the page's units; NaN stands for an unknown value.

    | key | shape | unit |
    |---|---|---|
    | `time_s` | () | s, the board's time since its first boot |
    | `fusion_theta_rad` | (s,) | rad, bend angle of each segment by the board |
    | `fusion_end_m` | (s, 2) | m, x and y of each segment's end by the board |
    | `bend_counts` | (s, 2) | ADC counts of the bend sensors a and b |
    | `imu_heading_rad` | (s,) | rad, as it was read |
    """
    return Live(address)
