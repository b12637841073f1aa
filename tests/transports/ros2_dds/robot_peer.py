"""Nav2 and PX4 as they are on DDS, by Cyclone DDS alone: types written by hand, nothing of robophm.

Reads commands, a line each: ``far GOAL METRES`` is feedback of /navigate_to_pose, ``ends GOAL STATE`` its status;
``battery VOLTS CURRENT CELL,CELL…`` is PX4's BatteryStatus of 1.17 as the bridge of uXRCE-DDS publishes it, best effort
and without a hash; ``old`` publishes on the topic that has no version; ``matched`` answers once feedback and status
have a reader.
"""

import sys
import time
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, int8, int16, int32, sequence, uint8, uint16, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from peer_types import LOOPBACK, Header, Pose, Time


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces.msg.dds_.Duration_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs.msg.dds_.PoseStamped_"):
    header: Header = field(default_factory=lambda: Header(frame_id="map"))
    pose: Pose = field(default_factory=Pose)


@dataclass
class UUID(IdlStruct, typename="unique_identifier_msgs.msg.dds_.UUID_"):
    uuid: array[uint8, 16]


@dataclass
class Feedback(IdlStruct, typename="nav2_msgs.action.dds_.NavigateToPose_Feedback_"):
    current_pose: PoseStamped = field(default_factory=PoseStamped)
    navigation_time: Duration = field(default_factory=Duration)
    estimated_time_remaining: Duration = field(default_factory=Duration)
    number_of_recoveries: int16 = 0
    distance_remaining: float32 = 0.0


@dataclass
class FeedbackMessage(IdlStruct, typename="nav2_msgs.action.dds_.NavigateToPose_FeedbackMessage_"):
    goal_id: UUID
    feedback: Feedback


@dataclass
class GoalInfo(IdlStruct, typename="action_msgs.msg.dds_.GoalInfo_"):
    goal_id: UUID
    stamp: Time


@dataclass
class GoalStatus(IdlStruct, typename="action_msgs.msg.dds_.GoalStatus_"):
    goal_info: GoalInfo
    status: int8


@dataclass
class GoalStatusArray(IdlStruct, typename="action_msgs.msg.dds_.GoalStatusArray_"):
    status_list: sequence[GoalStatus]


@dataclass
class BatteryStatus(IdlStruct, typename="px4_msgs.msg.dds_.BatteryStatus_"):
    timestamp: uint64 = 0
    connected: bool = True
    voltage_v: float32 = 0.0
    current_a: float32 = 0.0
    current_average_a: float32 = 0.0
    discharged_mah: float32 = 0.0
    remaining: float32 = 0.0
    scale: float32 = 0.0
    time_remaining_s: float32 = 0.0
    temperature: float32 = 0.0
    cell_count: uint8 = 0
    source: uint8 = 0
    priority: uint8 = 0
    capacity: uint16 = 0
    cycle_count: uint16 = 0
    average_time_to_empty: uint16 = 0
    manufacture_date: uint16 = 0
    state_of_health: uint16 = 0
    max_error: uint16 = 0
    id: uint8 = 0
    interface_error: uint16 = 0
    voltage_cell_v: array[float32, 14] = field(default_factory=lambda: [0.0] * 14)
    max_cell_voltage_delta: float32 = 0.0
    is_powering_off: bool = False
    is_required: bool = False
    warning: uint8 = 0
    faults: uint16 = 0
    full_charge_capacity_wh: float32 = 0.0
    remaining_capacity_wh: float32 = 0.0
    over_discharge_count: uint16 = 0
    nominal_voltage: float32 = 0.0
    internal_resistance_estimate: float32 = 0.0
    ocv_estimate: float32 = 0.0
    ocv_estimate_filtered: float32 = 0.0
    volt_based_soc_estimate: float32 = 0.0
    voltage_prediction: float32 = 0.0
    prediction_error: float32 = 0.0
    estimation_covariance_norm: float32 = 0.0


def main() -> None:
    number = int(sys.argv[1])
    domain = Domain(number, LOOPBACK)
    participant = DomainParticipant(number)
    xcdr1 = Policy.DataRepresentation(use_cdrv0_representation=True)
    latched = Policy.Durability.TransientLocal
    reliable, best_effort = Policy.Reliability.Reliable(0), Policy.Reliability.BestEffort

    def writer(topic: str, kind: type, *policies: object) -> DataWriter:
        return DataWriter(participant, Topic(participant, f"rt/{topic}", kind, Qos(xcdr1)), Qos(xcdr1, *policies))

    action = "navigate_to_pose/_action"
    feedback = writer(f"{action}/feedback", FeedbackMessage, reliable, Policy.History.KeepLast(10))
    status = writer(f"{action}/status", GoalStatusArray, reliable, latched, Policy.History.KeepLast(1))
    battery = writer("fmu/out/battery_status_v1", BatteryStatus, best_effort, latched, Policy.History.KeepLast(1))
    old = []
    print("ready", flush=True)
    for line in sys.stdin:
        command, *words = line.split()
        name = UUID([int(words[0])] * 16) if command in ("far", "ends") else None
        if command == "far":
            feedback.write(FeedbackMessage(name, Feedback(distance_remaining=float(words[1]))))
        elif command == "ends":
            status.write(GoalStatusArray([GoalStatus(GoalInfo(name, Time()), int(words[1]))]))
        elif command == "battery":
            cells = [float(each) for each in words[2].split(",")]
            cells += [0.0] * (14 - len(cells))
            battery.write(BatteryStatus(voltage_v=float(words[0]), current_a=float(words[1]), voltage_cell_v=cells))
        elif command == "matched":
            while not all(one.get_matched_subscriptions() for one in (feedback, status)):
                time.sleep(0.02)
            print("matched", flush=True)
        elif command == "old":
            old.append(writer("fmu/out/battery_status", BatteryStatus, best_effort, latched))
    del domain


main()
