"""A node of ROS 2 that logs and goes through its lifecycle, by Cyclone DDS alone: types by hand, nothing of robophm.

Reads commands, a line each: ``log LOGGER LEVEL WORDS`` is a message on /rosout as rcl publishes it, ``state START
GOAL`` a transition of /lidar; ``matched`` answers once both topics have a reader.
"""

import sys
import time
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import uint8, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from peer_types import LOOPBACK, Time


@dataclass
class Log(IdlStruct, typename="rcl_interfaces.msg.dds_.Log_"):
    stamp: Time
    level: uint8
    name: str
    msg: str
    file: str = "lidar.cpp"
    function: str = "spin"
    line: uint32 = 7


@dataclass
class Transition(IdlStruct, typename="lifecycle_msgs.msg.dds_.Transition_"):
    id: uint8 = 0
    label: str = ""


@dataclass
class State(IdlStruct, typename="lifecycle_msgs.msg.dds_.State_"):
    id: uint8 = 0
    label: str = ""


@dataclass
class TransitionEvent(IdlStruct, typename="lifecycle_msgs.msg.dds_.TransitionEvent_"):
    timestamp: uint64 = 0
    transition: Transition = field(default_factory=Transition)
    start_state: State = field(default_factory=State)
    goal_state: State = field(default_factory=State)


def main() -> None:
    number = int(sys.argv[1])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    reliable, latched = Policy.Reliability.Reliable(0), Policy.Durability.TransientLocal

    def writer(topic: str, kind: type, *policies: object) -> DataWriter:
        return DataWriter(participant, Topic(participant, f"rt/{topic}", kind, Qos(xcdr1)), Qos(xcdr1, *policies))

    log = writer("rosout", Log, reliable, latched, Policy.History.KeepLast(1000))
    states = writer("lidar/transition_event", TransitionEvent, reliable, Policy.History.KeepLast(10))
    print("ready", flush=True)
    for line in sys.stdin:
        command, *words = line.split(maxsplit=3)
        if command == "log":
            now = time.time_ns()
            log.write(Log(Time(now // 10**9, now % 10**9), int(words[1]), words[0], words[2].strip()))
        elif command == "state":
            states.write(TransitionEvent(start_state=State(int(words[0])), goal_state=State(int(words[1]))))
        elif command == "matched":
            while not (log.get_matched_subscriptions() and states.get_matched_subscriptions()):
                time.sleep(0.01)
            print("matched", flush=True)
    del domain


main()
