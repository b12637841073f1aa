"""A peer over Cyclone DDS alone: types written by hand, nothing of robophm. Reads commands, a line each.

``joints NAME EFFORT,EFFORT…`` and ``poses Z,Z…`` publish; ``graph`` says participants' nodes and how many they read and
write, and which of those identifiers belong to publishers and subscribers that discovery knows.
"""

import sys
import time
from dataclasses import dataclass, field

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float64, sequence, uint8
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from peer_types import LOOPBACK, Header, Point, Pose, Time


@dataclass
class JointState(IdlStruct, typename="sensor_msgs.msg.dds_.JointState_"):
    header: Header = field(default_factory=Header)
    name: sequence[str] = field(default_factory=list)
    position: sequence[float64] = field(default_factory=list)
    velocity: sequence[float64] = field(default_factory=list)
    effort: sequence[float64] = field(default_factory=list)


@dataclass
class PoseArray(IdlStruct, typename="geometry_msgs.msg.dds_.PoseArray_"):
    header: Header = field(default_factory=Header)
    poses: sequence[Pose] = field(default_factory=list)


@dataclass
class Gid(IdlStruct, typename="rmw_dds_common.msg.dds_.Gid_"):
    data: array[uint8, 16]


@dataclass
class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common.msg.dds_.NodeEntitiesInfo_"):
    node_namespace: str
    node_name: str
    reader_gid_seq: sequence[Gid]
    writer_gid_seq: sequence[Gid]


@dataclass
class ParticipantEntitiesInfo(IdlStruct, typename="rmw_dds_common.msg.dds_.ParticipantEntitiesInfo_"):
    gid: Gid
    node_entities_info_seq: sequence[NodeEntitiesInfo]


def main() -> None:
    number = int(sys.argv[1])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    reliable = Policy.Reliability.Reliable(0)
    latched = Qos(xcdr1, reliable, Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
    writers = {
        name: DataWriter(participant, Topic(participant, f"rt/{name}", kind, Qos(xcdr1)), latched)
        for name, kind in (("joint_states", JointState), ("poses", PoseArray))
    }
    told = DataReader(
        participant, Topic(participant, "ros_discovery_info", ParticipantEntitiesInfo, Qos(xcdr1)), latched
    )
    known = {
        kind: BuiltinDataReader(participant, topic)
        for kind, topic in (("writes", BuiltinTopicDcpsPublication), ("reads", BuiltinTopicDcpsSubscription))
    }
    topics: dict[bytes, str] = {}
    print("ready", flush=True)
    for line in sys.stdin:
        command, *words = line.split()
        if command == "joints":
            seconds, nanoseconds = divmod(int(words[0]), 10**9)
            effort = [float(each) for each in words[1].split(",")] if len(words) > 1 else []
            stamp = Header(Time(seconds, nanoseconds))
            writers["joint_states"].write(JointState(stamp, name=["é"] * len(effort), effort=effort))
        elif command == "poses":
            poses = [Pose(Point(0, 0, float(each))) for each in words]
            writers["poses"].write(PoseArray(poses=poses))
        elif command == "graph":
            time.sleep(0.2)
            for reader in known.values():
                for each in reader.take(1000):
                    topics[each.key.bytes] = each.topic_name
            for info in told.read(100):
                for node in getattr(info, "node_entities_info_seq", ()):
                    reads = sorted(topics.get(bytes(gid.data), "?") for gid in node.reader_gid_seq)
                    writes = sorted(topics.get(bytes(gid.data), "?") for gid in node.writer_gid_seq)
                    print(node.node_namespace, node.node_name, "reads", *reads, "writes", *writes, flush=True)
            print("end", flush=True)
    del domain


main()
