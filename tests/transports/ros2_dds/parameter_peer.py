"""A client of a node's parameters as ros2 param is one, through rmw_cyclonedds: by Cyclone DDS alone, types by hand.

Reads commands, a line each: ``list``, ``get NAME…``, ``types NAME…``, ``describe NAME…``, ``set NAME=VALUE…`` and
``together NAME=VALUE…``, whose values are JSON, and prints each reply as JSON. ``there`` says whether all six services
of the node are there.
"""

import json
import sys
import time
from dataclasses import asdict, dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import byte, float64, int64, sequence, uint8, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from peer_types import LOOPBACK

OURS = 0x0123_4567_89AB_CDEF


@dataclass
class Value(IdlStruct, typename="rcl_interfaces.msg.dds_.ParameterValue_"):
    type: uint8 = 0
    bool_value: bool = False
    integer_value: int64 = 0
    double_value: float64 = 0.0
    string_value: str = ""
    byte_array_value: sequence[byte] = field(default_factory=list)
    bool_array_value: sequence[bool] = field(default_factory=list)
    integer_array_value: sequence[int64] = field(default_factory=list)
    double_array_value: sequence[float64] = field(default_factory=list)
    string_array_value: sequence[str] = field(default_factory=list)


@dataclass
class Parameter(IdlStruct, typename="rcl_interfaces.msg.dds_.Parameter_"):
    name: str
    value: Value


@dataclass
class FloatingPointRange(IdlStruct, typename="rcl_interfaces.msg.dds_.FloatingPointRange_"):
    from_value: float64
    to_value: float64
    step: float64


@dataclass
class IntegerRange(IdlStruct, typename="rcl_interfaces.msg.dds_.IntegerRange_"):
    from_value: int64
    to_value: int64
    step: uint64


@dataclass
class Descriptor(IdlStruct, typename="rcl_interfaces.msg.dds_.ParameterDescriptor_"):
    name: str
    type: uint8
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: sequence[FloatingPointRange]  # of one at most, which RMWs do not tell over DDS
    integer_range: sequence[IntegerRange]


@dataclass
class Result(IdlStruct, typename="rcl_interfaces.msg.dds_.SetParametersResult_"):
    successful: bool
    reason: str


@dataclass
class Listed(IdlStruct, typename="rcl_interfaces.msg.dds_.ListParametersResult_"):
    names: sequence[str]
    prefixes: sequence[str]


@dataclass
class ListRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.ListParameters_Request_"):
    guid: uint64
    seq: int64
    prefixes: sequence[str] = field(default_factory=list)
    depth: uint64 = 0


@dataclass
class ListResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.ListParameters_Response_"):
    guid: uint64
    seq: int64
    result: Listed


@dataclass
class GetRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.GetParameters_Request_"):
    guid: uint64
    seq: int64
    names: sequence[str]


@dataclass
class GetResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.GetParameters_Response_"):
    guid: uint64
    seq: int64
    values: sequence[Value]


@dataclass
class TypesRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.GetParameterTypes_Request_"):
    guid: uint64
    seq: int64
    names: sequence[str]


@dataclass
class TypesResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.GetParameterTypes_Response_"):
    guid: uint64
    seq: int64
    types: sequence[uint8]


@dataclass
class DescribeRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.DescribeParameters_Request_"):
    guid: uint64
    seq: int64
    names: sequence[str]


@dataclass
class DescribeResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.DescribeParameters_Response_"):
    guid: uint64
    seq: int64
    descriptors: sequence[Descriptor]


@dataclass
class SetRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.SetParameters_Request_"):
    guid: uint64
    seq: int64
    parameters: sequence[Parameter]


@dataclass
class SetResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.SetParameters_Response_"):
    guid: uint64
    seq: int64
    results: sequence[Result]


@dataclass
class TogetherRequest(IdlStruct, typename="rcl_interfaces.srv.dds_.SetParametersAtomically_Request_"):
    guid: uint64
    seq: int64
    parameters: sequence[Parameter]


@dataclass
class TogetherResponse(IdlStruct, typename="rcl_interfaces.srv.dds_.SetParametersAtomically_Response_"):
    guid: uint64
    seq: int64
    result: Result


SERVICES = {
    "list": ("list_parameters", ListRequest, ListResponse), "get": ("get_parameters", GetRequest, GetResponse),
    "types": ("get_parameter_types", TypesRequest, TypesResponse),
    "describe": ("describe_parameters", DescribeRequest, DescribeResponse),
    "set": ("set_parameters", SetRequest, SetResponse),
    "together": ("set_parameters_atomically", TogetherRequest, TogetherResponse),
}  # fmt: skip


def parameter(said: str) -> Parameter:
    """A parameter as ros2 param set reads it, which takes what looks like a whole number for one."""
    name, _, text = said.partition("=")
    value = json.loads(text)
    if isinstance(value, bool):
        return Parameter(name, Value(1, bool_value=value))
    if isinstance(value, int):
        return Parameter(name, Value(2, integer_value=value))
    if isinstance(value, float):
        return Parameter(name, Value(3, double_value=value))
    return Parameter(name, Value(4, string_value=value))


def main() -> None:
    number, node = int(sys.argv[1]), sys.argv[2]
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    reliable, last = Policy.Reliability.Reliable(0), Policy.History.KeepLast(10)

    def client(service: str, request: type, response: type) -> tuple[DataWriter, DataReader]:
        asks = Topic(participant, f"rq{node}/{service}Request", request, Qos(xcdr1))
        replies = Topic(participant, f"rr{node}/{service}Reply", response, Qos(xcdr1))
        told = Policy.Userdata(b"clientid=00.11.22;")
        return (DataWriter(participant, asks, Qos(xcdr1, reliable, last, told)),
                DataReader(participant, replies, Qos(xcdr1, reliable, last)))  # fmt: skip

    clients = {name: client(*ends) for name, ends in SERVICES.items()}
    print("ready", flush=True)
    for seq, line in enumerate(sys.stdin, 1):
        command, *words = line.split()
        if command == "there":
            served = [asks.get_matched_subscriptions() and replies.get_matched_publications()
                      for asks, replies in clients.values()]  # fmt: skip
            print("yes" if all(served) else "no", flush=True)
            continue
        asks, replies = clients[command]
        what = [words] if command in ("get", "types", "describe") else []
        what += [[parameter(word) for word in words]] if command in ("set", "together") else []
        asks.write(SERVICES[command][1](OURS, seq, *what))
        reply = None
        while reply is None:
            for one in replies.take(10):
                if getattr(one, "guid", None) == OURS and one.seq == seq:
                    reply = one
            time.sleep(0.001)
        print(json.dumps({name: value for name, value in asdict(reply).items() if name not in ("guid", "seq")}),
              flush=True)  # fmt: skip
    del domain


main()
