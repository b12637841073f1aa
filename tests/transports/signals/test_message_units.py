from __future__ import annotations

import pytest

from robophm.transports.ros2_dds.interfaces import releases
from robophm.transports.signals.message_type import numeric_fields
from robophm.transports.signals.message_units import _PARTS, _UNITS, field_unit


@pytest.mark.parametrize(
    ("type_", "field", "unit"),
    [
        ("sensor_msgs/Temperature", "temperature", "degC"),
        ("sensor_msgs/msg/Temperature", "temperature", "degC"),
        ("sensor_msgs/msg/Temperature", "header.stamp.nanosec", "ns"),
        ("sensor_msgs/msg/Temperature", "variance", None),
        ("sensor_msgs/msg/BatteryState", "percentage", ""),
        ("sensor_msgs/msg/BatteryState", "cell_voltage[3]", "V"),
        ("sensor_msgs/msg/Imu", "linear_acceleration.z", "m/s^2"),
        ("sensor_msgs/msg/JointState", "effort[0]", None),
        ("nav_msgs/msg/Odometry", "pose.pose.position.x", "m"),
        ("nav_msgs/msg/Odometry", "pose.pose.orientation.w", ""),
        ("nav_msgs/msg/Odometry", "pose.covariance[0]", None),
        ("nav_msgs/Odometry", "twist.twist.angular.z", "rad/s"),
        ("nav_msgs/msg/Path", "poses[4].pose.position.y", "m"),
        ("geometry_msgs/msg/Twist", "linear.x", "m/s"),
        ("turtlesim/Pose", "linear_velocity", "m/s"),
        ("vda5050/state", "batteryState.batteryVoltage", "V"),  # VDA 5050 2.1, 6.10.6: columns "unit"
        ("vda5050/state", "velocity.omega", "rad/s"),
        ("vda5050/state", "agvPosition.theta", "rad"),
        ("vda5050/state", "batteryState.reach", "m"),
        ("vda5050/state", "headerId", None),
        ("no_msgs/msg/Such", "x", None),
        ("nav_msgs/msg/Odometry", "pose", None),
    ],
)
def test_units(type_: str, field: str, unit: str | None) -> None:
    assert field_unit(type_, field) == unit


def test_every_row_is_a_field_of_the_real_message() -> None:
    from rosbags.typesys import Stores, get_typestore

    definitions = {
        **get_typestore(Stores.ROS2_HUMBLE).fielddefs,
        **get_typestore(Stores.ROS1_NOETIC).fielddefs,
    }
    for type_, rows in (*_UNITS.items(), *_PARTS.items()):
        if type_.startswith(("turtlesim/", "vda5050/")):  # not of these stores
            continue
        if type_.startswith("px4_msgs/"):
            said = releases("px4_msgs")
            texts = [said[one][name].text for one in said for name in said[one] if name == type_.replace("/", "/msg/")]
            assert rows.keys() <= {line.split()[-1] for text in texts for line in text.splitlines()}, type_
            continue
        fields = [f.replace("[]", "") for f in numeric_fields(definitions, type_.replace("/", "/msg/"))]
        for name in rows:
            assert any(f == name or f.startswith(name + ".") for f in fields), (type_, name)


def test_every_unit_is_one() -> None:
    import pint

    registry = pint.UnitRegistry()
    for rows in _UNITS.values():
        for unit in rows.values():
            registry.parse_units(unit)
