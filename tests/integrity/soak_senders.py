"""Robots for hours at many times their pace, as programs of their own: over ROS 1 by rospy, over DDS by Cyclone."""

ROS1 = """
import sys, time
import rospy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Temperature
from std_msgs.msg import Header
begun, pace, begin = float(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
rospy.init_node("sensors", disable_signals=True)
clock = rospy.Publisher("/clock", Clock, queue_size=100)
outs = {name: rospy.Publisher(name, Temperature, queue_size=100) for name in ("/warm", "/hot")}
number = 0
while True:
    time.sleep(0.05)
    now = rospy.Time.from_sec(begin + pace * (time.monotonic() - begun))
    clock.publish(Clock(now))
    for name, out in outs.items():
        out.publish(Temperature(header=Header(stamp=now), temperature=20 + number % 97 / 7 + 5 * (name == "/hot")))
    number += 1
"""

DDS = """
import os, sys, time
from dataclasses import dataclass, field
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
sys.path.append(sys.argv[4])
from peer_types import Header, Time
@dataclass
class Clock(IdlStruct, typename="rosgraph_msgs.msg.dds_.Clock_"):
    clock: Time = field(default_factory=Time)
@dataclass
class Temperature(IdlStruct, typename="sensor_msgs.msg.dds_.Temperature_"):
    header: Header = field(default_factory=Header)
    temperature: float64 = 0.0
    variance: float64 = 0.0
begun, pace, begin = float(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
old = Policy.DataRepresentation(use_cdrv0_representation=True)
how = Qos(old, Policy.Reliability.Reliable(0), Policy.History.KeepLast(100))
kinds = {"clock": Clock, "warm": Temperature, "hot": Temperature}
outs = {n: DataWriter(participant, Topic(participant, "rt/" + n, kind, Qos(old)), how) for n, kind in kinds.items()}
number = 0
while True:
    time.sleep(0.05)
    now = begin + pace * (time.monotonic() - begun)
    stamp = Time(int(now), int(now % 1 * 1e9))
    outs["clock"].write(Clock(stamp))
    for name in ("warm", "hot"):
        outs[name].write(Temperature(Header(stamp), 20 + number % 97 / 7 + 5 * (name == "hot")))
    number += 1
"""
