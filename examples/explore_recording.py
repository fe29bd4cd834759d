# %% [markdown]
# # A recording, read in Python
#
# Loads what `proprio record`, `proprio replay --out est.mcap` or `proprio convert` has written, and the CSV that `proprio convert`
# makes of a recording or `proprio simulate` writes: bend angles, the tip's trail, the board's health and the raw sensors, on one
# time axis. It needs none of proprio's own software. Open it as a notebook (VS Code, Spyder or jupytext know the `# %%` cells) and
# change the names below, or run it with a recording, a CSV or both:
#
#     pip install mcap mcap-ros2-support pandas matplotlib
#     python examples/explore_recording.py session.mcap session.csv
#
# Run like that, it saves the figures in the folder where it is run. docs/reference/files.md has every topic and column, and
# docs/tutorials/python.md the Python package, which replays, calibrates and checks sessions, too.

# %%
import sys

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

recording, session = "session.mcap", "session.csv"
if "ipykernel" not in sys.modules:
    names = sys.argv[1:]
    recording = next((name for name in names if name.endswith(".mcap")), None)
    session = next((name for name in names if name.endswith(".csv")), None)
    if not names or len(names) != (recording is not None) + (session is not None):
        sys.exit(
            "usage: explore_recording.py [RECORDING.mcap] [SESSION.csv]\n"
            "For a first session: proprio simulate --scenario 2 --seconds 60 --seed 1 -o session.csv\n"
            "A recording of it with estimates: proprio convert session.csv session.mcap --table TABLE.toml"
        )


def frame(rows):
    """A table by time, s; empty without rows."""
    return pd.DataFrame(rows).set_index("time_s") if rows else pd.DataFrame()


# %% [markdown]
# ## The recording (MCAP)
#
# Messages are those of ROS 2; `sequence` is the board's tick. Times are those of the samples on the board's clock, and 0 is the
# first sample, as in a CSV; `publish_time` would be the same on the host's clock, ns since 1970. A recording of a board has estimates and health, one that `convert` has made of a CSV has estimates where it
# was given a table.

# %%
theta, tip, health, sensors, times_s, board_s, start_s, count = [], [], [], [], {}, None, None, 0
topics = ["/proprio/samples", "/joint_states", "/proprio/shape", "/diagnostics"]
if recording:
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, content in reader.iter_decoded_messages(topics=topics):
            if channel.topic == "/proprio/samples":
                now_s, count = content.board_time_us / 1e6, count + 1
                start_s = now_s if start_s is None else start_s
                if board_s is not None and now_s < board_s:
                    # The board has restarted.
                    start_s += now_s - board_s
                board_s = now_s
                times_s[message.sequence] = now_s - start_s
                continue
            time_s = times_s.get(message.sequence)
            if time_s is None:
                # The sample of this tick was lost.
                continue
            if channel.topic == "/joint_states":
                # rad, clockwise positive; NaN where nothing is known, as before the tare.
                theta.append({"time_s": time_s, **dict(zip(content.name, np.degrees(content.position)))})
            elif channel.topic == "/proprio/shape":
                # m, in the frame of the arm's base: x to the right, y along the base.
                position = content.poses[-1].position
                tip.append({"time_s": time_s, "x_mm": position.x * 1e3, "y_mm": position.y * 1e3})
            else:
                board, *others = content.status
                values = {value.key: value.value for value in board.values}
                health.append({"time_s": time_s, **{key: float(values[key]) for key in ("load_percent", "overruns")}})
                sensors.append({"time_s": time_s, **{status.name: status.message for status in others}})
theta, tip, health, sensors = map(frame, (theta, tip, health, sensors))

# %% [markdown]
# ## The session (CSV)
#
# A row a sample; an empty cell is a missing reading, which pandas reads as NaN. An IMU is a heading in degrees or a quaternion.

# %%
samples = pd.read_csv(session, index_col="time_s") if session else pd.DataFrame()
counts = samples.filter(regex=r"^bend\d+[ab]_adc$")
headings = samples.filter(regex=r"^imu\d+_deg$")
imus = sorted({name.split("_")[0] for name in samples.columns if name.endswith("_qw")})
if headings.empty and imus:
    part = {axis: samples[[f"{imu}_q{axis}" for imu in imus]].to_numpy() for axis in "wxyz"}
    # Clockwise positive, seen from above.
    turn = np.arctan2(
        2 * (part["w"] * part["z"] + part["x"] * part["y"]), 1 - 2 * (part["y"] ** 2 + part["z"] ** 2)
    )
    headings = pd.DataFrame(np.degrees(-turn) % 360, index=samples.index, columns=[f"{imu}_deg" for imu in imus])
# Of a simulated session, or after `proprio align`.
truth = samples.filter(regex=r"^truth\d+_[xy]_mm$")

# %% [markdown]
# ## In numbers

# %%
if recording:
    print(f"{recording}: {count} samples, {len(theta)} estimates")
if not theta.empty:
    print(theta.agg(["count", "min", "max"]).round(1).to_string())
    print(f"tip: x {tip.x_mm.min():.0f} to {tip.x_mm.max():.0f} mm, y {tip.y_mm.min():.0f} to {tip.y_mm.max():.0f} mm")
elif recording:
    print(f"no estimates: `proprio replay {recording} --table TABLE.toml --out est.mcap` makes them")
if not health.empty:
    print(f"board: load {health.load_percent.mean():.1f} %, {health.overruns.iloc[-1]:.0f} overruns")
    ok_percent = (sensors == "Ok").mean() * 100
    print(f"sensors that were not always ok: {ok_percent[ok_percent < 100].round(1).to_dict() or 'none'}")
if session:
    print(f"{session}: {len(samples)} samples, {counts.shape[1]} bend sensors, {headings.shape[1]} IMUs")
if not counts.empty:
    print(f"readings of bend sensors that are missing: {counts.isna().mean().mean() * 100:.2f} %")

# %% [markdown]
# ## Over time
#
# One time axis for all; what the files do not have is left out. Legends stand beside the axes.

# %%
rows = []
if not theta.empty:
    rows.append(("bend angle θ, °", [(theta, "-")]))
if not counts.empty:
    rows.append(("bend sensors, counts", [(counts, "-")]))
if not headings.empty:
    rows.append(("IMU heading, °", [(headings, ".")]))
if not health.empty:
    not_ok = (sensors != "Ok").sum(axis=1).to_frame("sensors not ok")
    load = health[["load_percent"]].rename(columns={"load_percent": "load, %"})
    rows.append(("health of the board", [(load, "-"), (not_ok, "-")]))
if rows:
    figure, axes = plt.subplots(
        len(rows), 1, sharex=True, squeeze=False, figsize=(10, 1 + 2.4 * len(rows)), layout="constrained"
    )
    for (title, tables), axis in zip(rows, axes[:, 0]):
        for table, style in tables:
            axis.plot(table.index, table, style, markersize=2, linewidth=1, label=list(table.columns))
        axis.set_ylabel(title)
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), ncols=1 + (len(axis.lines) > 8), fontsize="x-small")
    axes[-1, 0].set_xlabel("time, s")
    figure.savefig("over_time.png")

# %% [markdown]
# ## The tip's trail

# %%
if not tip.empty or not truth.empty:
    figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
    if not truth.empty:
        x_mm, y_mm = truth.columns[-2:]
        axes.plot(truth[x_mm], truth[y_mm], color="0.7", linewidth=4, label="true")
    if not tip.empty:
        axes.plot(tip.x_mm, tip.y_mm, linewidth=1, label="estimated")
    axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal")
    figure.legend(loc="outside upper center", ncols=2)
    figure.savefig("tip.png")
plt.show()
