"""Compares a recording, read with the packages mcap and mcap-ros2-support, with the output of proprio."""

import csv
import json
import math
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

folder, table = Path(sys.argv[1]), Path(sys.argv[2])
SENSORS = [f"bend{i}{name}_adc" for i in range(1, 7) for name in "ab"]
PARTS = [f"imu{i}_q{part}" for i in range(1, 7) for part in "wxyz"]


def rows(name):
    with open(folder / name, newline="") as file:
        return list(csv.DictReader(file))


def number(cell):
    return float(cell) if cell else math.nan


def same(found, expected, tolerance):
    """True if two numbers are the same, or both unknown."""
    return math.isnan(found) == math.isnan(expected) and not abs(found - expected) > tolerance


def check_sample(sample, row):
    assert abs(sample.board_time_us / 1e6 - float(row["time_s"])) < 1e-9, sample
    for i, name in enumerate(SENSORS):
        read = sample.bend_read >> i & 1
        assert str(sample.bend_adc[i]) == row[name] if read else row[name] == "", (name, sample)
    for i, name in enumerate(PARTS):
        read = sample.imu_read >> i // 4 & 1
        assert same(sample.imu[i] / 2**14 if read else math.nan, number(row[name]), 0), (name, sample)


def check_joints(joints, row):
    assert joints.name == [f"theta{i}" for i in range(1, 7)]
    for i, theta in enumerate(joints.position, 1):
        assert same(math.degrees(theta), number(row[f"fusion{i}_theta_deg"]), 1e-6), (i, joints)


def check_poses(poses, row):
    assert poses.header.frame_id == "arm_base"
    heading_deg = 0.0
    for i, pose in enumerate(poses.poses, 1):
        for axis in "xy":
            found_mm = getattr(pose.position, axis) * 1e3
            assert same(found_mm, number(row[f"fusion{i}_{axis}_mm"]), 1e-5), (i, poses)
        # Clockwise from y, as turns about z are counter-clockwise from x.
        heading_deg += number(row[f"fusion{i}_theta_deg"])
        turn_deg = math.degrees(2 * math.atan2(pose.orientation.z, pose.orientation.w))
        assert same(math.cos(math.radians(90 - turn_deg - heading_deg)), 1 + 0 * heading_deg, 1e-9), (i, poses)


def check_uncertainty(uncertainty, row):
    assert len(uncertainty.theta_variance) == 6 and len(uncertainty.end_covariance) == 18, uncertainty
    for i in range(6):
        xx, xy, yy = uncertainty.end_covariance[3 * i : 3 * i + 3]
        if math.isnan(xx):
            continue
        assert row[f"fusion{i + 1}_x_mm"] != "" and 0 < uncertainty.theta_variance[i] < math.radians(9.5) ** 2, (i, uncertainty)
        assert 1e-4 < math.sqrt(xx + yy) < 0.05 and abs(xy) <= max(xx, yy), (i, uncertainty)
    assert not any(uncertainty.touched) and all(percent <= 100 for percent in uncertainty.contact_percent), uncertainty


def check_diagnostics(diagnostics):
    names = [status.name for status in diagnostics.status]
    bends = [f"bend {i}{name}" for i in range(1, 7) for name in "ab"]
    assert names == ["board", *bends, *(f"imu {i}" for i in range(1, 7))], names
    board = {value.key: value.value for value in diagnostics.status[0].values}
    assert board["arm"] == "planar-6" and board["overruns"] == "0", board
    for status in diagnostics.status:
        level = status.level if isinstance(status.level, int) else status.level[0]
        bad = 1 if status.name == "board" else 2
        assert level == (0 if status.message in ("Ok", "running") else bad), status


with open(folder / "session.mcap", "rb") as file:
    reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
    statistics = reader.get_summary().statistics
    attachments = {attachment.name: attachment.data for attachment in reader.iter_attachments()}
    metadata = {entry.name: entry.metadata for entry in reader.iter_metadata()}
    raw = [(message, content) for _, _, message, content in reader.iter_decoded_messages(topics=["/proprio/raw"])]
    topics = ["/proprio/samples", "/joint_states", "/proprio/shape", "/proprio/uncertainty", "/diagnostics"]
    decoded = {topic: [] for topic in topics}
    for _, channel, message, content in reader.iter_decoded_messages(topics=topics):
        decoded[channel.topic].append((message, content))

assert b"".join(bytes(content.data) for _, content in raw) == (folder / "session.bin").read_bytes()
assert all(before.log_time <= after.log_time for (before, _), (after, _) in zip(raw, raw[1:]))
assert statistics.message_count == len(raw) + sum(map(len, decoded.values()))
assert statistics.chunk_count >= 5, "a chunk a second"

session, estimates = rows("session.csv"), rows("estimates.csv")
samples = decoded["/proprio/samples"]
assert len(samples) == len(session) == len(estimates) > 100
places = {message.sequence: place for place, (message, _) in enumerate(samples)}
for message, sample in samples:
    check_sample(sample, session[places[message.sequence]])
for message, joints in decoded["/joint_states"]:
    check_joints(joints, estimates[places[message.sequence]])
for message, poses in decoded["/proprio/shape"]:
    check_poses(poses, estimates[places[message.sequence]])
for message, uncertainty in decoded["/proprio/uncertainty"]:
    check_uncertainty(uncertainty, estimates[places[message.sequence]])
assert not math.isnan(decoded["/proprio/uncertainty"][-1][1].end_covariance[-1])
for _, diagnostics in decoded["/diagnostics"]:
    check_diagnostics(diagnostics)
for message, content in [entry for entries in decoded.values() for entry in entries]:
    stamp = content.header.stamp
    assert stamp.sec * 10**9 + stamp.nanosec == message.publish_time <= message.log_time

# As a bag of ROS 2, in which every message is one.
with AnyReader([folder / "session.mcap"], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
    deserialised = [bag.deserialize(data, connection.msgtype) for connection, _, data in bag.messages()]
assert len(deserialised) == statistics.message_count

assert attachments["table.toml"] == table.read_bytes()
assert json.loads(attachments["hello-boot-1.json"])["arm"] == "planar-6"
assert metadata["proprio"]["line"] == "virtual Due", metadata
print(f"read: {len(samples)} samples, {len(decoded['/joint_states'])} estimates, {statistics.chunk_count} chunks, as proprio has them")
