# %% [markdown]
# # A recording, read in Python
#
# Loads what `proprio record` has written, and the CSV that `proprio convert` makes of it or `proprio simulate` writes, and
# plots bend angles, the tip's trail, the board's health and the raw sensors. Open it as a notebook (VS Code, Spyder or
# jupytext know the `# %%` cells) and change the two names below, or run it:
#
#     pip install mcap mcap-ros2-support pandas matplotlib
#     python examples/explore_recording.py session.mcap session.csv
#
# Run like that, it saves the figures in the folder where it is run. docs/reference/files.md has every topic and column.

# %%
import sys

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

recording, session = "session.mcap", "session.csv"
is_notebook = "ipykernel" in sys.modules
if not is_notebook:
    recording, session = sys.argv[1:3]

# %% [markdown]
# ## The recording (MCAP)
#
# Messages are those of ROS 2; `publish_time` is the board's time of the tick on the host's clock, in ns.

# %%
theta, tip, health, sensors = [], [], [], []
with open(recording, "rb") as file:
    reader = make_reader(file, decoder_factories=[DecoderFactory()])
    for _, channel, message, content in reader.iter_decoded_messages(
        topics=["/joint_states", "/proprio/shape", "/diagnostics"]
    ):
        time = pd.Timestamp(message.publish_time, tz="UTC")
        if channel.topic == "/joint_states":
            # rad, clockwise positive; NaN where nothing is known, as before the tare.
            theta.append({"time": time, **dict(zip(content.name, np.degrees(content.position)))})
        elif channel.topic == "/proprio/shape":
            # m, in the frame of the arm's base: x to the right, y along the base.
            position = content.poses[-1].position
            tip.append({"time": time, "x_mm": position.x * 1e3, "y_mm": position.y * 1e3})
        else:
            board, *others = content.status
            values = {value.key: value.value for value in board.values}
            health.append({"time": time, **{key: float(values[key]) for key in ("load_percent", "overruns")}})
            sensors.append({"time": time, **{status.name: status.message for status in others}})

theta, tip, health, sensors = (pd.DataFrame(rows).set_index("time") for rows in (theta, tip, health, sensors))

# %% [markdown]
# ## The session (CSV)
#
# A row a sample; an empty cell is a missing reading, which pandas reads as NaN. An IMU is a heading in degrees or a quaternion.

# %%
samples = pd.read_csv(session, index_col="time_s")
counts = samples.filter(regex=r"^bend\d+[ab]_adc$")
headings = samples.filter(regex=r"^imu\d+_deg$")
if headings.empty:
    imus = sorted({name.split("_")[0] for name in samples.columns if name.endswith("_qw")})
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
seconds = (theta.index[-1] - theta.index[0]).total_seconds()
print(f"{recording}: {len(theta)} estimates in {seconds:.1f} s")
print(theta.agg(["count", "min", "max"]).round(1).to_string())
print(f"tip: x {tip.x_mm.min():.0f} to {tip.x_mm.max():.0f} mm, y {tip.y_mm.min():.0f} to {tip.y_mm.max():.0f} mm")
print(f"board: load {health.load_percent.mean():.1f} %, {health.overruns.iloc[-1]:.0f} overruns")
ok_percent = (sensors == "Ok").mean() * 100
print(f"sensors that were not always ok: {ok_percent[ok_percent < 100].round(1).to_dict() or 'none'}")
print(f"{session}: {len(samples)} samples, {counts.shape[1]} bend sensors, {headings.shape[1]} IMUs")
missing_percent = samples[counts.columns].isna().mean().mean() * 100
print(f"readings of bend sensors that are missing: {missing_percent:.2f} %")

# %% [markdown]
# ## In pictures

# %%
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(9, 6), layout="constrained")
since = theta.index[0]
above.plot((theta.index - since).total_seconds(), theta, label=list(theta.columns))
above.set(ylabel="bend angle θ, °", title="Shape")
above.legend(ncols=3, fontsize="small")
below.plot((health.index - since).total_seconds(), health.load_percent, label="load, %")
below.plot((sensors.index - since).total_seconds(), (sensors != "Ok").sum(axis=1), label="sensors that are not ok")
below.set(xlabel="time, s", ylim=(0, None), title="Health")
below.legend(fontsize="small")
figure.savefig("theta_and_health.png")

# %%
figure, axes = plt.subplots(figsize=(6, 6), layout="constrained")
axes.plot(tip.x_mm, tip.y_mm, label="estimated")
if not truth.empty:
    x_mm, y_mm = truth.columns[-2:]
    axes.plot(truth[x_mm], truth[y_mm], "--", label="true")
axes.set(xlabel="x, mm", ylabel="y, mm", title="The tip's trail", aspect="equal")
axes.legend()
figure.savefig("tip.png")

# %%
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(9, 6), layout="constrained")
above.plot(counts, label=list(counts.columns))
above.set(ylabel="counts", title="Bend sensors")
below.plot(headings, ".", markersize=2, label=list(headings.columns))
below.set(xlabel="time, s", ylabel="heading, °", title="IMUs")
for axes in (above, below):
    axes.legend(ncols=6, fontsize="x-small")
figure.savefig("sensors.png")
plt.show()
