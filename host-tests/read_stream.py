"""Reads the live stream of `proprio record --foxglove` with independent packages, and compares it with the recording.

    python read_stream.py PROPRIO FOLDER TABLE

The client is `websockets`; messages are decoded by the advertised schemas with `mcap-ros2-support`, those of ROS 2 also by the
definitions of ROS 2 Humble that `rosbags` has; the recording is read with `mcap`.
"""

import json
import math
import re
import statistics
import struct
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

from mcap.reader import make_reader
from mcap_ros2._dynamic import generate_dynamic
from rosbags.typesys import Stores, get_typestore
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from processor_time import cpu_s

SECONDS = 5
SUBPROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"]
LAYOUTS = Path(__file__).parent.parent / "docs" / "layouts"
LIVE_ALONE = {"/tf", "/proprio/arm"}


def hello(socket):
    """The channels that the server advertises, by number."""
    info, advertised = json.loads(socket.recv()), json.loads(socket.recv())
    assert info["op"] == "serverInfo" and info["capabilities"] == [] and info["name"].startswith("proprio "), info
    assert advertised["op"] == "advertise", advertised
    for channel in advertised["channels"]:
        assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg"), channel
    return {channel["id"]: channel for channel in advertised["channels"]}


def receive(url):
    """Channels, and topic, log time, delay and bytes of each message of some seconds."""
    with connect(url, subprotocols=SUBPROTOCOLS[:1]) as socket:
        assert socket.subprotocol == SUBPROTOCOLS[0]
        channels = hello(socket)
        # The client's numbers differ from the channels'.
        subscriptions = [{"id": 100 + id, "channelId": id} for id in channels]
        socket.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))
        messages, end = [], time.monotonic() + SECONDS
        while time.monotonic() < end:
            data = socket.recv(timeout=10)
            assert isinstance(data, bytes), data
            opcode, subscription, log_time = struct.unpack_from("<BIQ", data)
            assert opcode == 1
            topic = channels[subscription - 100]["topic"]
            messages.append((topic, log_time, time.time_ns() - log_time, data[13:]))
        socket.send(json.dumps({"op": "unsubscribe", "subscriptionIds": [100 + id for id in channels]}))
    return channels, messages


def check_access(url):
    """Viewers of both names of the protocol are answered, pages of other sites and other protocols are not."""
    for subprotocol in SUBPROTOCOLS:
        for origin in [None, "file://", "http://localhost:8080", "https://app.foxglove.dev"]:
            with connect(url, subprotocols=[subprotocol], origin=origin) as socket:
                assert socket.subprotocol == subprotocol and hello(socket)
    refused = [("https://example.com", SUBPROTOCOLS, 403), ("null", SUBPROTOCOLS, 403), (None, ["rosbridge"], 400)]
    for origin, subprotocols, status in refused:
        try:
            connect(url, subprotocols=subprotocols, origin=origin).close()
        except InvalidStatus as error:
            assert error.response.status_code == status, error
        else:
            raise AssertionError(f"{origin} {subprotocols} was answered")


def decode(channels, messages):
    """Topic and decoded message of each, in their order."""
    by_topic = {channel["topic"]: channel for channel in channels.values()}
    own = {topic: generate_dynamic(c["schemaName"], c["schema"])[c["schemaName"]] for topic, c in by_topic.items()}
    humble = get_typestore(Stores.ROS2_HUMBLE)
    for topic, _, _, data in messages:
        name = by_topic[topic]["schemaName"]
        if not name.startswith("proprio_msgs/"):
            humble.deserialize_cdr(data, name)
        yield topic, own[topic](data)


def check_transforms(message, ends):
    assert [t.child_frame_id for t in message.transforms] == [f"segment{i + 1}" for i in range(len(ends))]
    for transform, end in zip(message.transforms, ends):
        at = transform.transform.translation
        assert transform.header.frame_id == "arm_base", transform
        assert (at.x, at.y, at.z) == (end.x, end.y, 0), (transform, end)


def check_markers(message, ends):
    """Lines go from end to end; returns the number of ellipses."""
    lines = [marker for marker in message.markers if marker.ns == "arm"]
    discs = [marker for marker in message.markers if marker.ns == "ellipses"]
    assert len(lines) == len(discs) == len(ends)
    start = (0, 0)
    for line, end in zip(lines, ends):
        assert line.header.frame_id == "arm_base" and line.type == 4 and line.action == 0 and len(line.points) >= 13
        first, last = line.points[0], line.points[-1]
        assert (first.x, first.y) == start
        assert math.dist((last.x, last.y), (end.x, end.y)) < 1e-9
        start = (end.x, end.y)
    shown = [disc for disc in discs if disc.action == 0]
    for disc in shown:
        assert disc.type == 3 and disc.scale.x >= disc.scale.y > 0, disc
    return len(shown)


def check_scene(decoded):
    """Transforms and markers, which follow the shape of their tick, show the same arm."""
    ends, ellipses = None, 0
    for topic, message in decoded:
        if topic == "/proprio/shape":
            ends = [pose.position for pose in message.poses]
            assert len(ends) == 6
        elif topic == "/tf" and ends:
            check_transforms(message, ends)
        elif topic == "/proprio/arm" and ends:
            ellipses += check_markers(message, ends)
    assert ellipses > 0


def value(message, fields):
    """The number at a path such as `poses[5].position.x`."""
    for name, index in re.findall(r"(\w+)(?:\[(\d+)\])?", fields):
        message = getattr(message, name)
        message = message[int(index)] if index else message
    return float(message)


def check_layouts(decoded):
    """Each series of the layouts for Foxglove and PlotJuggler is in the stream."""
    last = dict(decoded)
    panels = json.loads((LAYOUTS / "foxglove.json").read_text())["configById"]
    assert all(topic in last for topic in panels["3D!arm"]["topics"])
    assert panels["DiagnosticSummary!board"]["topicToRender"] in last
    for path in [path["value"] for panel in panels.values() for path in panel.get("paths", [])]:
        topic, fields = path.split(".", 1)
        value(last[topic], fields)
    for curve in ElementTree.parse(LAYOUTS / "plotjuggler.xml").iter("curve"):
        name = curve.get("name")
        topic = next(topic for topic in last if name.startswith(topic + "/"))
        fields = name.removeprefix(topic + "/")
        if topic == "/joint_states":
            joint, part = fields.split("/")
            assert part == "position" and joint in last[topic].name, name
        else:
            value(last[topic], fields.replace("/", "."))


def recorded(path):
    """The messages of the recording: topic, log time and bytes."""
    with path.open("rb") as file:
        return {(c.topic, m.log_time, m.data) for _, c, m in make_reader(file).iter_messages()}


def main(proprio, folder, table):
    path = Path(folder) / "session.mcap"
    path.unlink(missing_ok=True)
    command = [proprio, "record", "--virtual", "--table", table, "--foxglove=0", "-o", path]
    record = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        line = next(line for line in record.stderr if "ws://" in line)
        url = re.search(r"ws://[0-9.:]+", line).group()
        # The board boots, and tares.
        time.sleep(3)
        check_access(url)
        alone = cpu_s(record)
        time.sleep(SECONDS)
        streaming = cpu_s(record)
        channels, messages = receive(url)
        end = cpu_s(record)
    finally:
        # As Ctrl-C.
        record.send_signal(2)
        record.communicate()
    assert record.returncode == 0, record.returncode

    decoded = list(decode(channels, messages))
    counts = Counter(topic for topic, _ in decoded)
    for topic, per_second in [("/proprio/samples", 100), ("/joint_states", 100), ("/proprio/shape", 100), ("/tf", 100)]:
        assert counts[topic] > 0.8 * SECONDS * per_second, counts
    for topic, per_second in [("/proprio/arm", 25), ("/diagnostics", 4), ("/proprio/uncertainty", 4)]:
        assert counts[topic] > 0.7 * SECONDS * per_second, counts
    ticks = [message.tick for topic, message in decoded if topic == "/proprio/samples"]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks))), "samples are missing"
    check_scene(decoded)
    check_layouts(decoded)

    file = recorded(path)
    for topic, log_time, _, data in messages:
        assert topic in LIVE_ALONE or (topic, log_time, data) in file, (topic, log_time)

    delays = sorted(delay / 1e6 for _, _, delay, _ in messages)
    size = sum(len(data) for _, _, _, data in messages) / SECONDS
    print(f"{len(messages)} messages in {SECONDS} s, {size / 1e3:.0f} kB/s, the recording's own to the byte")
    loads = [100 * seconds / SECONDS for seconds in (streaming - alone, end - streaming)]
    print(f"record takes {loads[0]:.1f} % of a core without a client, {loads[1]:.1f} % with this one")
    print(f"arrival of the bytes to the client: median {statistics.median(delays):.2f} ms, "
          f"99 % {delays[int(0.99 * len(delays))]:.2f} ms, longest {delays[-1]:.2f} ms")


main(*sys.argv[1:])
