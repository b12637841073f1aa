"""Robots as a new user would have them: a description, ten minutes of recordings, and what is said of it.

The recordings are made here, message by message; what the first two are described by is in shared/robots.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from robophm.core.signal import SECOND

from .px4_flight import fly

ROOT = Path(__file__).parents[2]
DATA = ROOT / "tests" / "data" / "robots"
START, SPAN = 1_790_000_000, 600
STORE = get_typestore(Stores.ROS2_HUMBLE)

Message = tuple[float, str, str, Mapping[str, Any]]
"""Seconds since the start, topic, type, and fields by their paths; others are zero."""


@dataclass(frozen=True)
class NewRobot:
    """A robot that somebody has on the first day."""

    name: str
    urdf: Path
    recorded: Callable[[Path], Path]
    """Writes its recording into a folder."""
    said: Mapping[str, str] = field(default_factory=dict)
    """Answers to questions, at most seven."""
    expects: tuple[str, ...] = ()
    """Entries of the library that must be in the draft."""

    @property
    def by_hand(self) -> Path:
        """A careful design of it from sources of its own."""
        return DATA / f"{self.name.removesuffix('_px4')}_by_hand.yaml"


def build(type_: str, fields: Mapping[str, Any]) -> Any:
    """A message with these fields, by their paths, and zeros else."""
    own = {key: value for key, value in fields.items() if "." not in key}
    inner: dict[str, dict[str, Any]] = {}
    for key, value in fields.items():
        first, dot, rest = key.partition(".")
        if dot:
            inner.setdefault(first, {})[rest] = value
    said = {}
    for name, (node, detail) in STORE.fielddefs[type_][1]:
        if name in own:
            said[name] = own[name]
        elif node == Nodetype.NAME:
            said[name] = build(str(detail), inner.get(name, {}))
        elif node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            said[name] = _zeros(*detail)
        else:
            said[name] = "" if detail[0] == "string" else False if detail[0] == "bool" else 0
    return STORE.types[type_](**said)


def _zeros(element: Any, length: int) -> Any:
    kind = element[1][0] if element[0] == Nodetype.BASE else "string"
    types = {"float32": np.float32, "float64": np.float64, "uint8": np.uint8, "int8": np.int8}
    return [] if kind == "string" else np.zeros(length, types.get(kind, np.float64))


def record(path: Path, messages: Iterator[Message]) -> Path:
    """Write messages as ROS 2 MCAP, in order of time."""
    with path.open("wb") as file:
        writer, channels = Writer(file), dict[str, int]()
        writer.start(profile="ros2")
        for seconds, topic, type_, fields in sorted(messages, key=lambda one: one[0]):
            if topic not in channels:
                definition = STORE.generate_msgdef(type_, 2)[0].encode()
                channels[topic] = writer.register_channel(
                    topic, "cdr", writer.register_schema(type_, "ros2msg", definition)
                )
            time = int((START + seconds) * SECOND)
            stamped = any(name == "header" for name, _ in STORE.fielddefs[type_][1])
            stamp = {"header.stamp.sec": time // SECOND, "header.stamp.nanosec": time % SECOND} if stamped else {}
            raw = bytes(STORE.serialize_cdr(build(type_, {**stamp, **fields}), type_))
            writer.add_message(channels[topic], time, raw, time)
        writer.finish()
    return path


def diagnostics(seconds: float, temperatures: Mapping[str, float]) -> Message:
    """What each of several devices says of its temperature."""
    status = [
        build("diagnostic_msgs/msg/DiagnosticStatus", {
            "name": name, "hardware_id": str(i),
            "values": [build("diagnostic_msgs/msg/KeyValue", {"key": "Temperature", "value": f"{value:.1f}"})],
        })
        for i, (name, value) in enumerate(temperatures.items())
    ]  # fmt: skip
    return seconds, "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", {"status": status}


def joints(seconds: float, names: list[str], positions: list[float], efforts: list[float]) -> Message:
    """A JointState."""
    fields = {
        "name": names,
        "position": np.array(positions),
        "velocity": np.zeros(len(names)),
        "effort": np.array(efforts),
    }
    return seconds, "/joint_states", "sensor_msgs/msg/JointState", fields


def turtlebot() -> Iterator[Message]:
    """Rounds of two minutes at 0.2 m/s, each with a pause of a minute."""
    x = 0.0
    for i in range(SPAN * 2):
        t = i / 2
        driving = t % 180 < 120
        x += 0.1 if driving else 0.0
        yield t, "/odom", "nav_msgs/msg/Odometry", {"pose.pose.position.x": x, "twist.twist.linear.x": 0.2 * driving}
        yield joints(
            t, ["wheel_left_joint", "wheel_right_joint"], [x / 0.033, x / 0.033], [0.12 * driving, 0.11 * driving]
        )
        yield t, "/imu", "sensor_msgs/msg/Imu", {"linear_acceleration.z": 9.81}
        yield t, "/scan", "sensor_msgs/msg/LaserScan", {"ranges": np.full(36, 1.5, np.float32)}
        yield t, "/magnetic_field", "sensor_msgs/msg/MagneticField", {"magnetic_field.x": 2e-5}
        if i % 4 == 0:
            yield t, "/battery_state", "sensor_msgs/msg/BatteryState", {
                "voltage": 12.1 - t / 3000, "temperature": math.nan, "percentage": 0.95 - t / 9000,
            }  # fmt: skip
            warm = 4 * (1 - math.exp(-t / 300))
            yield diagnostics(t, {
                "raspberry pi: cpu": 52 + warm, "opencr: board": 36 + warm,
                "left wheel servo": 33 + 2 * warm, "right wheel servo": 34 + 2 * warm,
            })  # fmt: skip


SO101 = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]


def so101() -> Iterator[Message]:
    """Picking, a cycle in ten seconds."""
    for i in range(SPAN * 4):
        t = i / 4
        swing = math.sin(2 * math.pi * t / 10)
        yield joints(
            t, SO101, [0.8 * swing] * 6, [0.4 + 0.3 * swing, 1.1 + 0.5 * swing, 0.7, 0.3, 0.05, 0.4 * (swing > 0)]
        )
        if i % 8 == 0:
            yield diagnostics(t, {name: 38 + 3 * k + 5 * t / SPAN for k, name in enumerate(SO101)})


ARM = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]


def arm() -> Iterator[Message]:
    """A palletising arm: a cycle in twelve seconds."""
    for i in range(SPAN * 4):
        t = i / 4
        swing = math.sin(2 * math.pi * t / 12)
        yield joints(
            t, ARM, [swing] * 6, [20 * swing, 80 + 20 * swing, 45 + 10 * swing, 8.0 + swing, 5 * swing, 1 + swing]
        )
        yield t, "/wrench", "geometry_msgs/msg/WrenchStamped", {"wrench.force.z": -20 + 10 * swing}
        if i % 8 == 0:
            yield diagnostics(t, {f"{name} motor": 34 + k + 6 * t / SPAN for k, name in enumerate(ARM)})


def quadrotor() -> Iterator[Message]:
    """Hovering and flying a square, as MAVROS tells it."""
    for i in range(SPAN * 2):
        t = i / 2
        yield t, "/mavros/local_position/odom", "nav_msgs/msg/Odometry", {
            "pose.pose.position.x": 5 * math.cos(t / 20), "pose.pose.position.y": 5 * math.sin(t / 20),
            "pose.pose.position.z": 10.0,
        }  # fmt: skip
        yield t, "/mavros/imu/data", "sensor_msgs/msg/Imu", {"linear_acceleration.z": 9.81}
        if i % 4 == 0:
            yield t, "/mavros/imu/temperature_imu", "sensor_msgs/msg/Temperature", {"temperature": 46 + t / 200}
            yield (
                t,
                "/mavros/global_position/raw/fix",
                "sensor_msgs/msg/NavSatFix",
                {"latitude": 47.4, "longitude": 8.5},
            )
            yield t, "/mavros/battery", "sensor_msgs/msg/BatteryState", {
                "voltage": 16.2 - t / 600, "temperature": 30 + t / 100, "current": -14.0, "percentage": 0.98 - t / 900,
            }  # fmt: skip
            yield diagnostics(t, {f"ESC {k}": 48 + k + 8 * (1 - math.exp(-t / 200)) for k in range(4)})


def robots(shared: Path) -> list[NewRobot]:
    """All of them; two are described in shared/robots, where that folder is."""
    there = shared / "robots"

    def as_mcap(name: str, messages: Callable[[], Iterator[Message]]) -> Callable[[Path], Path]:
        return lambda folder: record(folder / f"{name}.mcap", messages())

    def px4_log(folder: Path) -> Path:
        return fly(folder / "flight.ulg")

    flown = ("drone_motor", "esc", "propeller", "gnss_receiver", "flight_controller", "battery_lipo")
    return [
        NewRobot("turtlebot3", there / "burger.urdf", as_mcap("turtlebot3", turtlebot),
                 {"hours": "4", "battery": "lipo", "drive": "dynamixel"},
                 ("smart_servo", "drive_wheel", "lidar_2d_low_cost", "imu", "battery_lipo_robot",
                  "single_board_computer")),
        NewRobot("so101", there / "so101.urdf", as_mcap("so101", so101), {"hours": "2", "computer": "none"},
                 ("smart_servo", "power_supply")),
        NewRobot("six_axis_arm", DATA / "six_axis_arm.urdf", as_mcap("six_axis_arm", arm),
                 {"hours": "16", "where": "factory"},
                 ("strain_wave_gear", "servo_motor", "joint_encoder", "holding_brake", "force_torque_sensor",
                  "industrial_pc")),
        NewRobot("quadrotor", DATA / "quadrotor.urdf", as_mcap("quadrotor", quadrotor), {"hours": "1"}, flown),
        NewRobot("quadrotor_px4", DATA / "quadrotor.urdf", px4_log, {"hours": "1"}, flown),
    ]  # fmt: skip
