"""A peer over Cyclone DDS alone that sends pictures of 2.8 MB, best effort: ``images NUMBER``."""

import struct
import sys
import time
from dataclasses import dataclass, field

from cyclonedds import _clayer
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from peer_types import LOOPBACK, Header

SIZE = 2_800_000


@dataclass
class Image(IdlStruct, typename="sensor_msgs.msg.dds_.Image_"):
    header: Header = field(default_factory=Header)
    height: uint32 = 0
    width: uint32 = 0
    encoding: str = ""
    is_bigendian: uint8 = 0
    step: uint32 = 0
    data: sequence[uint8] = field(default_factory=list)


def main() -> None:
    number = int(sys.argv[1])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    qos = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1), xcdr1)
    writer = DataWriter(participant, Topic(participant, "rt/image", Image, Qos(xcdr1)), qos)
    print("ready", flush=True)
    for line in sys.stdin:
        for height in range(int(line.split()[1])):
            head = struct.pack("<iII", 0, 0, 1) + b"\0" + bytes(3) + struct.pack("<III", height, 1, 1) + b"\0"
            body = head + b"\0" + bytes(2) + struct.pack("<II", 1, SIZE)
            _clayer.ddspy_write(writer._ref, b"\0\1\0\0" + body + bytes(SIZE))
            time.sleep(0.02)
        print("sent", flush=True)
    del domain


main()
