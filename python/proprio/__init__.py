"""The shape of a soft robot arm from bend sensors and IMUs.

The estimator, replay, calibration, tuning, alignment and the session check of the program `proprio`, over files or NumPy arrays.
Arrays have their units in their names (`_s`, `_rad`, `_m`), samples in their first dimension and segments, from the base to the
tip, in their second; NaN stands for an unknown value.

    import proprio

    estimates = proprio.replay("session.mcap", "table.toml")
    tip_m = estimates["fusion_end_m"][:, -1]

The command line `proprio` comes with the package.
"""

from ._commands import align, calibrate, check, replay, tune
from ._errors import Error, SessionWarning
from ._estimator import Estimator
from ._export import to_mat, to_pandas
from ._live import Live, open
from ._proprio import __version__
from ._session import read, write
from ._table import Table

__all__ = [
    "Error",
    "Estimator",
    "Live",
    "SessionWarning",
    "Table",
    "__version__",
    "align",
    "calibrate",
    "check",
    "open",
    "read",
    "replay",
    "to_mat",
    "to_pandas",
    "tune",
    "write",
]
