"""Units of the fields of well-known messages, as the comments in their definitions and REP-103 state them.

A field that stands for a whole vector gives its components their unit. A joint's position and effort are rad
and N·m or m and N as the joint is, so they are left out; so are variances and covariances.

Source: std_msgs, sensor_msgs, geometry_msgs, nav_msgs (common_interfaces), turtlesim; REP-103; the state topic of
VDA 5050 2.1; PX4's definitions of uORB messages.
"""

from __future__ import annotations

import re

_UNITS: dict[str, dict[str, str]] = {
    "builtin_interfaces/Time": {"sec": "s", "nanosec": "ns"},
    "builtin_interfaces/Duration": {"sec": "s", "nanosec": "ns"},
    "geometry_msgs/Point": {"x": "m", "y": "m", "z": "m"},
    "geometry_msgs/Point32": {"x": "m", "y": "m", "z": "m"},
    "geometry_msgs/Pose2D": {"x": "m", "y": "m", "theta": "rad"},
    "geometry_msgs/Quaternion": {"x": "", "y": "", "z": "", "w": ""},
    "geometry_msgs/Pose": {"position": "m", "orientation": ""},
    "geometry_msgs/Transform": {"translation": "m", "rotation": ""},
    "geometry_msgs/Twist": {"linear": "m/s", "angular": "rad/s"},
    "geometry_msgs/Accel": {"linear": "m/s^2", "angular": "rad/s^2"},
    "geometry_msgs/Wrench": {"force": "N", "torque": "N*m"},
    "geometry_msgs/Inertia": {"m": "kg", "com": "m"},
    "sensor_msgs/BatteryState": {
        "voltage": "V",
        "temperature": "degC",
        "current": "A",
        "charge": "A*h",
        "capacity": "A*h",
        "design_capacity": "A*h",
        "percentage": "",
        "cell_voltage": "V",
        "cell_temperature": "degC",
    },
    "sensor_msgs/FluidPressure": {"fluid_pressure": "Pa"},
    "sensor_msgs/Illuminance": {"illuminance": "lux"},
    "sensor_msgs/Imu": {"orientation": "", "angular_velocity": "rad/s", "linear_acceleration": "m/s^2"},
    "sensor_msgs/LaserScan": {
        "angle_min": "rad",
        "angle_max": "rad",
        "angle_increment": "rad",
        "time_increment": "s",
        "scan_time": "s",
        "range_min": "m",
        "range_max": "m",
        "ranges": "m",
    },
    "sensor_msgs/MagneticField": {"magnetic_field": "T"},
    "sensor_msgs/NavSatFix": {"latitude": "deg", "longitude": "deg", "altitude": "m"},
    "sensor_msgs/Range": {"field_of_view": "rad", "min_range": "m", "max_range": "m", "range": "m"},
    "sensor_msgs/RelativeHumidity": {"relative_humidity": ""},
    "sensor_msgs/Temperature": {"temperature": "degC"},
    "vda5050/state": {
        "agvPosition.x": "m",
        "agvPosition.y": "m",
        "agvPosition.theta": "rad",
        "batteryState.batteryCharge": "percent",
        "batteryState.batteryHealth": "percent",
        "batteryState.batteryVoltage": "V",
        "batteryState.reach": "m",
        "distanceSinceLastNode": "m",
        "velocity.vx": "m/s",
        "velocity.vy": "m/s",
        "velocity.omega": "rad/s",
    },
    "px4_msgs/AirspeedValidated": {"true_airspeed_m_s": "m/s"},
    "px4_msgs/BatteryStatus": {
        "voltage_v": "V",
        "current_a": "A",
        "current_average_a": "A",
        "discharged_mah": "mA*h",
        "remaining": "",
        "temperature": "degC",
        "voltage_cell_v": "V",
    },
    "px4_msgs/EscReport": {
        "esc_rpm": "rpm",
        "esc_voltage": "V",
        "esc_current": "A",
        "esc_temperature": "degC",
    },
    "px4_msgs/SensorAccel": {"x": "m/s^2", "y": "m/s^2", "z": "m/s^2", "temperature": "degC"},
    "px4_msgs/SensorBaro": {"pressure": "Pa", "temperature": "degC"},
    "px4_msgs/SensorGyro": {"x": "rad/s", "y": "rad/s", "z": "rad/s", "temperature": "degC"},
    "px4_msgs/VehicleImuStatus": {"temperature_accel": "degC", "temperature_gyro": "degC"},
    "px4_msgs/VehicleLocalPosition": {
        "x": "m",
        "y": "m",
        "z": "m",
        "vx": "m/s",
        "vy": "m/s",
        "vz": "m/s",
        "heading": "rad",
    },
    "turtlesim/Pose": {
        "x": "m",
        "y": "m",
        "theta": "rad",
        "linear_velocity": "m/s",
        "angular_velocity": "rad/s",
    },
}

_PARTS: dict[str, dict[str, str]] = {
    "std_msgs/Header": {"stamp": "builtin_interfaces/Time"},
    "std_msgs/Time": {"data": "builtin_interfaces/Time"},
    "std_msgs/Duration": {"data": "builtin_interfaces/Duration"},
    "geometry_msgs/PointStamped": {"point": "geometry_msgs/Point"},
    "geometry_msgs/PoseStamped": {"pose": "geometry_msgs/Pose"},
    "geometry_msgs/PoseArray": {"poses": "geometry_msgs/Pose"},
    "geometry_msgs/PoseWithCovariance": {"pose": "geometry_msgs/Pose"},
    "geometry_msgs/PoseWithCovarianceStamped": {"pose": "geometry_msgs/PoseWithCovariance"},
    "geometry_msgs/TransformStamped": {"transform": "geometry_msgs/Transform"},
    "geometry_msgs/TwistStamped": {"twist": "geometry_msgs/Twist"},
    "geometry_msgs/TwistWithCovariance": {"twist": "geometry_msgs/Twist"},
    "geometry_msgs/TwistWithCovarianceStamped": {"twist": "geometry_msgs/TwistWithCovariance"},
    "geometry_msgs/AccelStamped": {"accel": "geometry_msgs/Accel"},
    "geometry_msgs/WrenchStamped": {"wrench": "geometry_msgs/Wrench"},
    "nav_msgs/Odometry": {
        "pose": "geometry_msgs/PoseWithCovariance",
        "twist": "geometry_msgs/TwistWithCovariance",
    },
    "px4_msgs/EscStatus": {"esc": "px4_msgs/EscReport"},
    "nav_msgs/Path": {"poses": "geometry_msgs/PoseStamped"},
}


def field_unit(type: str, field: str) -> str | None:  # noqa: A002  the message's type, as ROS calls it
    """Return the unit of a field of a message, spelled as pint reads it; "" is a ratio, None is not known.

    Takes ``sensor_msgs/Temperature`` and ``sensor_msgs/msg/Temperature``, and fields with or without indices.
    """
    name = type.replace("/msg/", "/")
    path = re.sub(r"\[\d*\]", "", field)
    for known, unit in _UNITS.get(name, {}).items():
        if path == known or path.startswith(known + "."):
            return unit
    first, _, rest = path.partition(".")
    part = "std_msgs/Header" if first == "header" else _PARTS.get(name, {}).get(first)
    return field_unit(part, rest) if part and rest else None
