"""A client of phm_msgs/AssessTask and ReportFailure as rmw_cyclonedds makes it, by Cyclone DDS alone: types by hand.

Before the fields of each request and reply stand the client's number and that of its request. Reads commands, a line
each: ``there`` says whether the service is as a client waits for it; ``ask METRES SPEED LEGS LIMIT`` asks, and prints
the reply as JSON; so does ``fail PART``; ``strange`` makes a client of another RMW, which has no such identity.
"""

import json
import sys
import time
from dataclasses import asdict, dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int64, sequence, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from peer_types import LOOPBACK, Header

OURS = 0x0123_4567_89AB_CDEF


@dataclass
class TaskLeg(IdlStruct, typename="phm_msgs.msg.dds_.TaskLeg_"):
    distance: float64 = 0.0
    speed: float64 = 0.0
    duration: float64 = 0.0
    functions: sequence[str] = field(default_factory=list)
    stresses: sequence[str] = field(default_factory=list)
    stress_values: sequence[str] = field(default_factory=list)


@dataclass
class Request(IdlStruct, typename="phm_msgs.srv.dds_.AssessTask_Request_"):
    guid: uint64
    seq: int64
    legs: sequence[TaskLeg]
    limit: float64
    draws: uint32


@dataclass
class Response(IdlStruct, typename="phm_msgs.srv.dds_.AssessTask_Response_"):
    guid: uint64
    seq: int64
    header: Header
    refused: str
    go: bool
    longest_prefix: uint32
    limit: float64
    duration: float64
    distance: float64
    completion_nominal: float64
    completion_sensor_based: float64
    failure_nominal: float64
    failure_sensor_based: float64
    failure_low: float64
    failure_high: float64
    deciding: sequence[str]
    deciding_shares: sequence[float64]
    left_out: str


@dataclass
class Failure(IdlStruct, typename="phm_msgs.srv.dds_.ReportFailure_Request_"):
    guid: uint64
    seq: int64
    part: str
    by: str
    note: str
    key: str


@dataclass
class Noted(IdlStruct, typename="phm_msgs.srv.dds_.ReportFailure_Response_"):
    guid: uint64
    seq: int64
    header: Header
    noted: bool
    refused: str
    modes: sequence[str]


def main() -> None:
    number = int(sys.argv[1])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    reliable = Policy.Reliability.Reliable(0)
    last = Policy.History.KeepLast(10)

    def writer(service: str, request: type, user_data: bytes) -> DataWriter:
        topic = Topic(participant, f"rq/phm/{service}Request", request, Qos(xcdr1))
        return DataWriter(participant, topic, Qos(xcdr1, reliable, last, Policy.Userdata(user_data)))

    def client(service: str, request: type, response: type) -> tuple[DataWriter, DataReader]:
        topic = Topic(participant, f"rr/phm/{service}Reply", response, Qos(xcdr1))
        return writer(service, request, b"clientid=00.11.22;"), DataReader(
            participant, topic, Qos(xcdr1, reliable, last)
        )

    def answered(ends: tuple[DataWriter, DataReader], request: IdlStruct) -> None:
        ends[0].write(request)
        reply = None
        while reply is None:
            for one in ends[1].take(10):
                if getattr(one, "guid", None) == OURS and one.seq == request.seq:
                    reply = one
            time.sleep(0.001)
        print(json.dumps(asdict(reply)), flush=True)

    task = client("assess_task", Request, Response)
    failure = client("report_failure", Failure, Noted)
    strangers = []
    print("ready", flush=True)
    for seq, line in enumerate(sys.stdin, 1):
        command, *words = line.split()
        if command == "there":
            served = [all((asks.get_matched_subscriptions(), replies.get_matched_publications()))
                      for asks, replies in (task, failure)]  # fmt: skip
            print(" ".join("yes" if one else "no" for one in served), flush=True)
        elif command == "ask":
            metres, speed, legs, limit = float(words[0]), float(words[1]), int(words[2]), float(words[3])
            answered(task, Request(OURS, seq, [TaskLeg(distance=metres, speed=speed)] * legs, limit, 0))
        elif command == "fail":
            answered(failure, Failure(OURS, seq, words[0], "robot", "", ""))
        elif command == "strange":
            strangers.append(writer("assess_task", Request, b""))
    del domain


main()
