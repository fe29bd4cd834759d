"""Subscriptions to topics of ROS 2 with CycloneDDS, by the definitions of ROS 2 that `rosbags` has.

Discovery and messages go over 127.0.0.1 alone.
"""

import os
from pathlib import Path

os.environ["CYCLONEDDS_URI"] = """
<CycloneDDS><Domain>
  <General>
    <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
    <AllowMulticast>false</AllowMulticast>
  </General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>
"""

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication  # noqa: E402
from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.idl import make_idl_struct, types  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402
from rosbags.interfaces import Nodetype  # noqa: E402

PACKAGE = Path(__file__).parent.parent / "ros2" / "proprio_msgs"
BASE = {"string": str, "bool": bool, "byte": types.byte, "char": types.uint8, **{
    name: getattr(types, name)
    for name in ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64")
}}


def dds_name(name):
    """Name of a type on the wire."""
    *package, message = name.split("/")
    return "::".join([*package, "dds_", message + "_"])


class Types:
    """Types of CycloneDDS for messages of a distribution, and for those of the package proprio_msgs."""

    def __init__(self, distribution):
        store = get_typestore(distribution)
        for path in (PACKAGE / "msg").glob("*.msg"):
            store.register(get_types_from_msg(path.read_text(), f"proprio_msgs/msg/{path.stem}"))
        self.definitions = store.fielddefs
        self.made = {}

    def __getitem__(self, name):
        if name not in self.made:
            fields = {field: self.of(kind) for field, kind in self.definitions[name][1]}
            self.made[name] = make_idl_struct(name.split("/")[-1], dds_name(name), fields)
        return self.made[name]

    def of(self, kind):
        node, inner = kind
        if node == Nodetype.BASE:
            return BASE[inner[0]]
        if node == Nodetype.NAME:
            return self[inner]
        item, length = self.of(inner[0]), inner[1]
        return types.array[item, length] if node == Nodetype.ARRAY else types.sequence[item]


class Node:
    """A participant of DDS with readers."""

    def __init__(self, domain, distribution=Stores.ROS2_JAZZY):
        self.participant, self.types = DomainParticipant(domain), Types(distribution)
        self.publications = BuiltinDataReader(self.participant, BuiltinTopicDcpsPublication)

    def subscribe(self, topic, name, reliable=True, prefix="rt"):
        """A reader with the quality of service of a subscriber of ROS 2, and room for all messages of a slow test."""
        reliability = Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort
        durability = Policy.Durability.Volatile if prefix else Policy.Durability.TransientLocal
        quality = Qos(reliability, durability, Policy.History.KeepLast(10_000))
        return DataReader(self.participant, Topic(self.participant, prefix + topic, self.types[name]), qos=quality)
