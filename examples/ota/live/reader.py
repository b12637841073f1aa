"""A reader of DDS that knows nothing of robophm: what the topic of hazard rates says, once, by the cyclonedds wheel."""

import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float32, int32, sequence, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
@final
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    """builtin_interfaces/Time."""

    sec: int32
    nanosec: uint32


@dataclass
@final
class HazardRate(IdlStruct, typename="phm_msgs::msg::dds_::HazardRate_"):
    """phm_msgs/HazardRate."""

    stamp: Time
    system_value: float32
    system_sensor_based_value: float32
    module_names: sequence[str]
    module_values: sequence[float32]
    module_sensor_based_values: sequence[float32]


participant = DomainParticipant(77)
qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal)
reader = DataReader(participant, Topic(participant, "rt/phm_hazard_rate", HazardRate), qos)
for _ in range(600):
    for message in reader.take(1):
        print(message)
        raise SystemExit
    time.sleep(0.1)
