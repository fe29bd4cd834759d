"""Compares a recording that proprio has made of a CSV and a table, read with the packages mcap-ros2-support and rosbags, with the
estimates that `proprio replay` writes as CSV."""

import csv
import math
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

folder, table = Path(sys.argv[1]), Path(sys.argv[2])
recording = folder / "simulated.mcap"
with open(folder / "simulated-estimates.csv", newline="") as file:
    estimates = list(csv.DictReader(file))
with open(folder / "simulated.csv", newline="") as file:
    session = list(csv.DictReader(file))


def number(cell):
    return float(cell) if cell else math.nan


def check(found, cell, tolerance):
    expected = number(cell)
    assert math.isnan(found) == math.isnan(expected) and not abs(found - expected) > tolerance, (found, cell)


topics = ["/proprio/samples", "/joint_states", "/proprio/shape", "/proprio/uncertainty", "/proprio/truth"]
decoded = {topic: [] for topic in topics}
with open(recording, "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    attachments = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
    for _, channel, message, content in reader.iter_decoded_messages(topics=topics):
        decoded[channel.topic].append((message, content))
assert all(len(messages) == len(estimates) == len(session) for messages in decoded.values()), {
    topic: len(messages) for topic, messages in decoded.items()
}

for (_, joints), row in zip(decoded["/joint_states"], estimates):
    for i, theta in enumerate(joints.position, 1):
        check(math.degrees(theta), row[f"fusion{i}_theta_deg"], 1e-6)
for (message, poses), row in zip(decoded["/proprio/shape"], estimates):
    assert message.publish_time == round(float(row["time_s"]) * 1e9), row["time_s"]
    for i, pose in enumerate(poses.poses, 1):
        check(pose.position.x * 1e3, row[f"fusion{i}_x_mm"], 1e-5)
        check(pose.position.y * 1e3, row[f"fusion{i}_y_mm"], 1e-5)
for (_, truth), row in zip(decoded["/proprio/truth"], session):
    for i in range(6):
        check(truth.x[i] * 1e3, row[f"truth{i + 1}_x_mm"], 1e-9)
assert all(len(of.theta_variance) == 6 for _, of in decoded["/proprio/uncertainty"])
assert b"planar-6" in attachments["table.toml"]

with AnyReader([recording], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
    messages = sum(1 for connection, _, data in bag.messages() if bag.deserialize(data, connection.msgtype) is not None)
assert messages >= 6 * len(estimates)
print(f"read: {len(estimates)} estimates of {recording.name}, {messages} messages as a bag of ROS 2")
