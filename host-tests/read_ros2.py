"""Subscribes to the topics of `proprio-ros2` with CycloneDDS, which is no part of it, and checks what arrives.

    python read_ros2.py PROGRAMS FOLDER TABLE FIRMWARE

Three sources: a board, the stream of a recording, whose messages are compared with the file, and a running monitor. Types are
those of the package `rosbags` for ROS 2 Jazzy, and those of ros2/proprio_msgs.
"""

import math
import os
import re
import statistics
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from catkin_pkg.package import parse_package
from mcap.reader import make_reader
from rosbags.typesys import Stores

from processor_time import cpu_s
from ros2_subscriber import PACKAGE, Node, dds_name

SAMPLES = 1000
# One of its own for each run, so that two runs do not meet.
DOMAIN = 20 + os.getpid() % 80
TOPICS = {
    "/joint_states": "sensor_msgs/msg/JointState",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
    "/proprio/shape": "geometry_msgs/msg/PoseArray",
    "/proprio/arm": "visualization_msgs/msg/MarkerArray",
    "/proprio/samples": "proprio_msgs/msg/Sample",
    "/proprio/uncertainty": "proprio_msgs/msg/Uncertainty",
    "/proprio/contact": "proprio_msgs/msg/Contact",
}
LAYOUT = Path(__file__).parent.parent / "docs" / "layouts" / "proprio.rviz"
RECORDED = set(TOPICS) - {"/tf", "/proprio/arm"}


class Program:
    """A program that runs within a `with` statement, and is ended as by Ctrl-C."""

    def __init__(self, *command, **variables):
        self.command, self.environment = command, {**os.environ, **variables}

    def __enter__(self):
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
        self.process = subprocess.Popen(self.command, env=self.environment, text=True, **pipes)
        return self

    def printed(self, pattern):
        """The part of its output that the pattern has in brackets."""
        for line in self.process.stdout:
            if found := re.search(pattern, line):
                return found.group(1)
        raise AssertionError(f"{self.command} has ended without {pattern}")

    def __exit__(self, *error):
        self.process.send_signal(2)
        output, _ = self.process.communicate(timeout=20)
        if error[0] is None:
            assert self.process.returncode in (0, 130), (self.command, self.process.returncode, output)


def ros2(programs, *arguments, **variables):
    """The program proprio-ros2, for nodes on this machine."""
    settings = {"ROS_DOMAIN_ID": str(DOMAIN), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", **variables}
    return Program(programs / "proprio-ros2", *arguments, **settings)


def receive(readers, samples):
    """Topic, message and delay from its publication, ns, of all that the readers get until this number of samples is there."""
    received, missing, end = [], samples, time.monotonic() + 120
    while missing > 0:
        assert time.monotonic() < end, f"{missing} of {samples} samples have not arrived"
        for topic, reader in readers.items():
            for message in reader.take(100):
                received.append((topic, message, time.time_ns() - message.sample_info.source_timestamp))
                missing -= topic == "/proprio/samples"
        time.sleep(0.001)
    return received


def subscribe(node):
    return {topic: node.subscribe(topic, name) for topic, name in TOPICS.items()}


def check_node(node):
    """Other nodes find the name of the node, and the topics are its own: as `ros2 node info` does."""
    reader = node.subscribe("ros_discovery_info", "rmw_dds_common/msg/ParticipantEntitiesInfo", prefix="")
    end = time.monotonic() + 10
    infos = []
    while not infos and time.monotonic() < end:
        infos = reader.take(10)
    (info,) = infos
    (entry,) = info.node_entities_info_seq
    assert (entry.node_namespace, entry.node_name, entry.reader_gid_seq) == ("/", "proprio", []), entry
    published = {p.topic_name: p for p in node.publications.take(1000) if p.topic_name.startswith("rt/")}
    assert {name: p.type_name for name, p in published.items()} == {
        "rt" + topic: dds_name(name) for topic, name in TOPICS.items()
    }
    pad = bytes(len(info.gid.data) - 16)
    assert {bytes(p.participant_key.bytes) + pad for p in published.values()} == {bytes(info.gid.data)}
    assert {bytes(p.key.bytes) + pad for p in published.values()} == {bytes(g.data) for g in entry.writer_gid_seq}


def stamp(message):
    """Time of the header of a message, or of its first part."""
    for parts in ("status", "transforms", "markers"):
        if not hasattr(message, "header"):
            message = getattr(message, parts, [message])[0]
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def heading(rotation):
    """Angle of a rotation about z, rad."""
    assert (rotation.x, rotation.y) == (0, 0), rotation
    return 2 * math.atan2(rotation.z, rotation.w)


def check_tick(joints, shape, transforms):
    """Bend angles, rad, poses, m, and transforms of a tick are the same arm."""
    assert joints.header.frame_id == shape.header.frame_id == "arm_base"
    assert list(joints.name) == [f"theta{i}" for i in range(1, 7)] and not joints.velocity and not joints.effort
    assert [t.child_frame_id for t in transforms] == [f"segment{i}" for i in range(1, 7)]
    turned = math.pi / 2
    for theta, pose, transform in zip(joints.position, shape.poses, transforms):
        # Bend angles count clockwise from the base's tangent, y; x is along the segment's.
        turned -= theta
        assert math.isclose(math.remainder(heading(pose.orientation) - turned, 2 * math.pi), 0, abs_tol=1e-9)
        assert transform.header.frame_id == "arm_base" and transform.transform.rotation == pose.orientation
        at = transform.transform.translation
        assert (at.x, at.y, at.z) == (pose.position.x, pose.position.y, pose.position.z), transform
    tip = shape.poses[-1].position
    assert 0.1 < math.hypot(tip.x, tip.y) < 0.7, tip


def once(messages):
    """Messages by their stamps, without stamps that several have: those that an emulated board has sent late."""
    counts = Counter(map(stamp, messages))
    return {stamp(message): message for message in messages if counts[stamp(message)] == 1}


def check_board(programs, table):
    """A board: all topics at their rates, no sample lost, every tick's estimates of one arm."""
    with ros2(programs, "--virtual", "--table", table) as program:
        program.printed("(node /proprio of ROS 2)")
        node = Node(DOMAIN)
        readers = subscribe(node)
        best_effort = node.subscribe("/joint_states", TOPICS["/joint_states"], reliable=False)
        check_node(node)
        # The emulated board boots, and catches up with real time.
        receive(readers, 600)
        start, start_s = time.time_ns(), cpu_s(program.process)
        received = receive({**readers, "best effort": best_effort}, SAMPLES)
        end, end_s = time.time_ns(), cpu_s(program.process)

    by_topic = {}
    for topic, message, _ in received:
        by_topic.setdefault(topic, []).append(message)
    counts = {topic: len(messages) for topic, messages in by_topic.items()}
    for topic in ["/joint_states", "/proprio/shape", "/tf", "best effort"]:
        assert counts[topic] > 0.9 * SAMPLES, counts
    for topic, per_second in [("/proprio/arm", 25), ("/diagnostics", 4), ("/proprio/uncertainty", 4)]:
        assert counts[topic] > 0.8 * SAMPLES * per_second / 100, counts
    ticks = [sample.tick for sample in by_topic["/proprio/samples"]]
    gaps = [(a, b) for a, b in zip(ticks, ticks[1:]) if b != a + 1]
    assert not gaps, f"samples are missing between ticks {gaps}"
    for message in by_topic["/joint_states"]:
        assert start - 10e9 < stamp(message) < end, "a stamp is not of this clock"
    joints, shapes, transforms = (once(by_topic[topic]) for topic in ("/joint_states", "/proprio/shape", "/tf"))
    common = joints.keys() & shapes.keys() & transforms.keys()
    assert len(common) > 0.3 * SAMPLES, len(common)
    for at in common:
        check_tick(joints[at], shapes[at], transforms[at].transforms)
    first_rad = [joints.position[0] for joints in by_topic["/joint_states"]]
    assert max(first_rad) - min(first_rad) > 0.05, "the arm does not move"
    assert by_topic["/diagnostics"][-1].status[0].name == "board"

    seconds = (end - start) / 1e9
    delays = sorted(delay / 1e6 for topic, _, delay in received if topic != "best effort")
    print(f"a board: {counts['/proprio/samples']} samples of {ticks[-1] - ticks[0] + 1} ticks, "
          f"{len(received)} messages in {seconds:.1f} s, {100 * (end_s - start_s) / seconds:.1f} % of a core")
    print(f"publication to the subscriber: median {statistics.median(delays):.2f} ms, "
          f"99 % {delays[int(0.99 * len(delays))]:.2f} ms, longest {delays[-1]:.2f} ms")


def check_recording(programs, table, folder):
    """The stream of a recording: the messages are those of the file, to the byte."""
    path = folder / "session.mcap"
    path.unlink(missing_ok=True)
    record = Program(programs / "proprio", "record", "--virtual", "--table", table, "--foxglove=0", "-o", path)
    with record:
        address = record.printed(r"ws://([0-9.:]+)")
        with ros2(programs, f"--stream={address}", ROS_DISTRO="humble") as program:
            program.printed("(node /proprio of ROS 2)")
            # Identifiers of Humble are longer.
            node = Node(DOMAIN, Stores.ROS2_HUMBLE)
            readers = subscribe(node)
            check_node(node)
            received = receive(readers, 400)
    with path.open("rb") as file:
        recorded = {(channel.topic, message.data) for _, channel, message in make_reader(file).iter_messages()}
    compared = [(topic, message) for topic, message, _ in received if topic in RECORDED]
    for topic, message in compared:
        # CycloneDDS fills up to a multiple of four bytes.
        encoded = message.serialize(use_version_2=False)
        assert any((topic, encoded[: len(encoded) - pad]) in recorded for pad in range(4)), (topic, message)
    topics = {topic for topic, _ in compared}
    assert topics >= RECORDED - {"/proprio/contact"} and len(compared) > 1000, (topics, len(compared))
    print(f"a recording's stream: {len(compared)} messages, to the byte those of the file")


def check_monitor(programs, folder, firmware):
    """A board whose line a running monitor has: its stream is found by the name of the line."""
    variables = {"XDG_RUNTIME_DIR": str(folder)}
    with Program(programs / "virtual-due", "run", firmware, "--serial", "pty", "--speed", "real") as board:
        port = board.printed(r"(/dev/\S+)")
        monitor = [programs / "proprio", "monitor", "--port", port, "--listen", "0", "--folder", folder]
        with Program(*monitor, "--foxglove=0", **variables) as page:
            page.printed(r"(http://\S+)")
            with ros2(programs, "--port", port, **variables) as program:
                program.printed("(node /proprio of ROS 2)")
                samples = Node(DOMAIN).subscribe("/proprio/samples", TOPICS["/proprio/samples"])
                received = receive({"/proprio/samples": samples}, 200)
        with Program(*monitor, **variables) as page:
            page.printed(r"(http://\S+)")
            with ros2(programs, "--port", port, **variables) as program:
                program.printed("(start the monitor with --foxglove)")
                assert program.process.wait(10) == 2
                program.process.returncode = 0
    print(f"a running monitor: {len(received)} samples through it")


def check_package():
    """The package of our own messages is one that colcon builds: its manifest is valid, and lists each message."""
    package = parse_package(str(PACKAGE))
    assert (package.name, package.get_build_type()) == ("proprio_msgs", "ament_cmake"), package
    assert [group.name for group in package.member_of_groups] == ["rosidl_interface_packages"]
    listed = set(re.findall(r'"msg/(\w+)\.msg"', (PACKAGE / "CMakeLists.txt").read_text()))
    assert listed == {path.stem for path in (PACKAGE / "msg").iterdir()}, listed


def check_layout():
    """The topics of the layout for RViz are those of the node."""
    named = set(re.findall(r"Value: (/\S+)", LAYOUT.read_text()))
    assert named and named <= set(TOPICS), named


def main(programs, folder, table, firmware):
    programs, folder = Path(programs).absolute(), Path(folder).absolute()
    check_package()
    check_layout()
    check_board(programs, table)
    check_recording(programs, table, folder)
    check_monitor(programs, folder, firmware)


main(*sys.argv[1:])
