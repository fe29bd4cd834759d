"""Sessions: read as arrays, written, and passed to the commands."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import Any, Iterator, Mapping, Union

from . import _proprio
from ._arrays import to_arrays, to_raw
from ._errors import Error, warn

Session = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def read(path: Union[str, os.PathLike[str]]) -> dict[str, Any]:
    """Reads a session: CSV, a recording (MCAP), or a board's raw bytes. Raises `Error`.

    Returns a dictionary of arrays of n samples of an arm of s segments, from the base to the tip. NaN stands for a reading that
    is missing.

    | key | shape, type | unit |
    |---|---|---|
    | `time_s` | (n,) float | s, by the board's clock or the file's |
    | `start` | (n,) bool | the arm was tared, and the estimator starts, before this sample |
    | `bend_counts` | (n, s, 2) float | ADC counts, 0 to 4095, of the bend sensors a and b |
    | `bend_sensors` | (s, 2) bool | the bend sensors that the session has |
    | `imu_heading_rad` | (n, s) float | rad, clockwise, within ±π |
    | `imu_quaternion` | (n, s, 4) float | w, x, y, z; only where the file has quaternions |
    | `truth_m` | (n, s, 2) float | m, x and y of each segment's end; only with truth |
    | `truth_heading_rad` | (n, s) float | rad; only where the truth has headings |
    | `board_tick` | (n,) uint32 | number of the board's tick; only of a recording |
    | `board_theta_rad` | (n, s) float | rad, the bend angles that the board has sent |
    | `board_end_m` | (n, s, 2) float | m, the ends that the board has sent |

    Samples from before the begin of a recording, which only the estimator needs, are left out: to replay a recording, give
    `replay` its path.
    """
    arrays, warnings = _proprio.read(Path(path))
    warn(warnings)
    return to_arrays(arrays)


def write(path: Union[str, os.PathLike[str]], session: Mapping[str, Any], *, replace: bool = False) -> None:
    """Writes arrays, as `read` gives them, as a session in CSV. Raises `Error`.

    `time_s` is needed, and one of `bend_counts`, `imu_heading_rad` and `imu_quaternion`; the board's output is left out.
    Bend sensors have columns where `bend_sensors` is true; without it, where they were ever read. Every
    value comes back to the bit; times are rounded to 1 µs. A file of this name is replaced only with `replace`.
    """
    _proprio.write(Path(path), to_raw(session), replace)


class Files:
    """The files of sessions; those of arrays are temporary, `arrays-1.csv` and so on."""

    def __init__(self, sessions: list[Session], folder: str) -> None:
        self._folder = folder + os.sep
        self.paths = []
        for number, session in enumerate(sessions, 1):
            if isinstance(session, Mapping):
                self.paths.append(Path(folder) / f"arrays-{number}.csv")
                write(self.paths[-1], session)
            else:
                self.paths.append(Path(session))

    def plain(self, text: str) -> str:
        """A text without the folder of the temporary files."""
        return text.replace(self._folder, "")


@contextlib.contextmanager
def as_files(sessions: list[Session]) -> Iterator[Files]:
    """The files of sessions, while the block runs."""
    with tempfile.TemporaryDirectory(prefix="proprio-") as folder:
        files = Files(sessions, folder)
        try:
            yield files
        except Error as error:
            raise Error(files.plain(error.message), error.help) from None


def as_list(sessions: Union[Session, list[Session], tuple[Session, ...]]) -> list[Session]:
    """One session or several."""
    return list(sessions) if isinstance(sessions, (list, tuple)) else [sessions]
