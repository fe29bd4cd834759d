"""The commands of the program over paths and arrays."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any, Optional, Sequence, Union

from . import _proprio
from ._arrays import columns, to_arrays
from ._errors import decoded, warn
from ._session import Session, as_files, as_list, read
from ._table import Table, as_table

AnyTable = Union[Table, str, "os.PathLike[str]"]
Sessions = Union[Session, "list[Session]", "tuple[Session, ...]"]


def replay(session: Session, table: AnyTable, *, smooth: bool = False, float: bool = False) -> dict[str, Any]:
    """Runs a session through the estimator, as `proprio replay`: the same bits as on the board. Raises `Error`.

    Args:
        session: Path of a session, or its arrays.
        table: The arm's table, or its path.
        smooth: Estimate from all readings, also those after each sample; needs a table with the bias filter.
        float: Run the 64-bit float reference instead of the board's fixed point.

    Returns:
        A dictionary of arrays of n samples and s segments; NaN stands for an unknown value. In the first four names, METHOD is
        `bend` (bend sensors alone), `imu_o` (raw IMUs), `imu_c` (IMUs with their drift corrected), `fusion` (all sensors), and
        with `smooth` also `smoothed`.

        | key | shape, type | unit |
        |---|---|---|
        | `time_s` | (n,) float | s |
        | `METHOD_theta_rad` | (n, s) float | rad, bend angle of each segment, clockwise |
        | `METHOD_end_m` | (n, s, 2) float | m, x and y of each segment's end |
        | `theta_variance_rad2` | (n, s) float | rad², of `fusion_theta_rad` |
        | `end_covariance_m2` | (n, s, 3) float | m², xx, xy and yy of `fusion_end_m` |
        | `contact` | (n, s) bool | something touches the segment |
        | `degraded` | (n, s) bool | a condition makes the estimate less certain |
        | `truth_m`, `truth_heading_rad` | as in `read` | only with truth |
        | `metrics` | dict | errors against truth, in the form of `proprio replay --json`: mm and degrees |
    """
    with as_files([session]) as files:
        arrays, metrics, warnings = _proprio.replay(files.paths[0], as_table(table), smooth, float)
    warn(warnings, files.plain)
    return {**to_arrays(arrays), "metrics": decoded(files.plain(metrics))}


def check(session: Session, table: AnyTable) -> dict[str, Any]:
    """Checks the sensors and the times of a session, as `proprio check`. Raises `Error`.

    By an arm description only what needs no map is checked.

    Returns:
        `samples`: number of samples; `findings`: list of dictionaries with `sensor`, `rows`, `kind`, `figure`, `text` and `help`,
        in the form of `proprio check --json`; empty where nothing is found.
    """
    with as_files([session]) as files:
        samples, findings, warnings = _proprio.check(files.paths[0], as_table(table))
    warn(warnings, files.plain)
    return {"samples": samples, "findings": decoded(findings)}


def calibrate(sessions: Sessions, arm: AnyTable, *, maps: str = "auto", hysteresis: str = "auto") -> dict[str, Any]:
    """Makes a table from sessions with camera truth, as `proprio calibrate`. Raises `Error`.

    Args:
        sessions: Slow sweeps of every segment through its whole range: a path or arrays, or a list of them.
        arm: The arm's description, or its path.
        maps: `auto`, `curve` or `quadratic`.
        hysteresis: `auto`, `always` or `never`.

    Returns:
        `table`: the `Table`.
        `sensors`: arrays of one value for each bend sensor: `name`, `samples`, `rmse_deg`, `volts` (k, 2), `range_deg` (k, 2).
        `segments`: arrays of one value for each segment with bend sensors: `segment` (from 1), `held_back_rmse_deg`, `maps`,
        `imu_scale`.
        `held_out`: `tip_rmse_mm` by method on the last fifth of each session; `None` where the rest makes no table.
        `truth`: arrays of one value for each session: `path`, `length_scale` (lengths that the markers fit, times the arm's),
        `lag_s` (time by which the truth is later than the IMUs).
    """
    with as_files(as_list(sessions)) as files:
        text, report, warnings = _proprio.calibrate(files.paths, as_table(arm), maps, hysteresis)
    warn(warnings, files.plain)
    made = decoded(files.plain(report))
    lists = {name: columns(made[name]) for name in ("sensors", "segments", "truth")}
    return {"table": Table.parse(files.plain(text)), **lists, "held_out": made["held_out"]}


def tune(sessions: Sessions, table: AnyTable) -> dict[str, Any]:
    """Tunes a table on sessions with truth, as `proprio tune`; Ctrl-C keeps the best so far. Raises `Error`.

    Args:
        sessions: Sessions with truth, all of the same arm: a path or arrays, or a list of them.
        table: The arm's table, or its path.

    Returns:
        `table`: the tuned `Table`; `tuning`: the record that it has, with errors `before` and `after` in mm and degrees, and its
        `stop_reason`; `truth`: as of `calibrate`.
    """
    with as_files(as_list(sessions)) as files:
        text, report, warnings = _proprio.tune(files.paths, as_table(table))
    warn(warnings, files.plain)
    made = decoded(files.plain(report))
    return {"table": Table.parse(files.plain(text)), "tuning": made["tuning"], "truth": columns(made["truth"])}


def align(
    session: Session,
    camera: Union[str, os.PathLike[str]],
    arm: AnyTable,
    bodies: Sequence[str] = (),
    up: Optional[str] = None,
) -> dict[str, Any]:
    """Adds the truth of a camera with its own clock to a session, as `proprio align`. Raises `Error`.

    Args:
        session: Session without truth, or its arrays.
        camera: The camera's file: poses of the markers, one row per frame; or the export of OptiTrack Motive, Vicon or
            Qualisys.
        arm: The arm's description or table, or its path.
        bodies: Rigid bodies of an export from the base to the tip, the base's own first where there is one; all of the
            file where none are given.
        up: Axis of an export's capture volume that points from the arm's plane to the viewer, "x", "y" or "z"; the
            program's vertical one where it is None.

    Returns:
        `session`: the arrays with `truth_m` and `truth_heading_rad`, which `write` writes.
        `offset_s`, `offset_error_ms`: the camera's time less the session's at `middle_s`, and its standard error.
        `skew_ppm`, `skew_error_ppm`: rate by which the camera's clock is faster, and its standard error.
        `residual_ms`, `correlation`, `matched`, `sensors`: quality, and the sensors that were compared.
        `bodies`: names of an export's bodies from the base to the tip, else None.
        `rows`, `rows_with_truth`: numbers of samples; `truth`: as of `calibrate`.
    """
    with as_files([session]) as files, tempfile.TemporaryDirectory(prefix="proprio-") as folder:
        output = Path(folder) / "aligned.csv"
        report, warnings = _proprio.align(files.paths[0], Path(camera), as_table(arm), output, list(bodies), up)
        aligned = read(output)
    warn(warnings, files.plain)
    made = decoded(files.plain(report))
    return {"session": aligned, **made, "truth": columns(made["truth"])}
