"""The parts that topics tell of: a LaserScan has a lidar behind it, a BatteryState a battery."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from robophm.design.draft import DraftPart
from robophm.design.importers.urdf.drives import words_of
from robophm.design.importers.urdf.sensors import named_parts, same_body
from robophm.drafting.seen import Seen, SeenTopic
from robophm.parts import Entry, part

OF_TYPE = {
    "sensor_msgs/LaserScan": ("lidar_2d", ""),
    "sensor_msgs/PointCloud2": ("lidar_3d", "points of no camera: taken for a lidar with a spinning head"),
    "sensor_msgs/Image": ("camera", ""),
    "sensor_msgs/CompressedImage": ("camera", ""),
    "sensor_msgs/Imu": ("imu", ""),
    "sensor_msgs/NavSatFix": ("gnss_receiver", ""),
    "sensor_msgs/MagneticField": ("magnetometer", ""),
    "sensor_msgs/FluidPressure": ("barometer", ""),
    "sensor_msgs/Range": ("ultrasonic_sensor", "a range sensor, taken for an ultrasonic one"),
    "sensor_msgs/RelativeHumidity": ("humidity_sensor", ""),
    "geometry_msgs/WrenchStamped": ("force_torque_sensor", ""),
    "px4_msgs/SensorGps": ("gnss_receiver", ""),
    "px4_msgs/SensorCombined": ("imu", ""),
    "px4_msgs/SensorBaro": ("barometer", ""),
    "px4_msgs/VehicleAirData": ("barometer", ""),
    "px4_msgs/DistanceSensor": ("time_of_flight_sensor", "a range sensor, taken for one of time of flight"),
}
"""The entry of the library that most likely publishes each type of message, and what is assumed in taking it; "" where
nothing is."""

BATTERY = ("sensor_msgs/BatteryState", "px4_msgs/BatteryStatus")
"""Types that tell of a battery."""

_DEEP = frozenset({"depth", "realsense", "zed", "oak", "kinect", "astra", "points", "stereo"})
_MADE = frozenset({"costmap", "map", "filtered", "markers", "plan", "cloud", "compensated", "fused", "estimated"})
"""Words of topics that software makes of others."""

FUSED = {"imu": ("magnetometer",), "flight_controller": ("imu", "magnetometer", "barometer")}
"""Parts that are mostly inside another: an inertial unit of nine axes, an autopilot."""


def parts_by_topic(seen: Seen, described: Sequence[DraftPart]) -> list[DraftPart]:
    """Sensors as described, with the topics that they are heard on, and those that only topics tell of."""
    waiting = [(topic, *found) for topic in seen.topics if (found := _entry(topic))]
    parts: list[DraftPart] = []
    for one in described:
        mine = next((each for each in waiting if same_body(each[1], part(one.entry))), None)
        if mine is None:
            parts.append(one)
            continue
        waiting = [each for each in waiting if not _same_source(each, mine)]
        parts.append(replace(one, seen=f"{one.seen}, heard on {mine[0].name}"))
    known = {(one.module, one.name) for one in parts}
    for one in named_parts(_bodies(waiting)):
        name, more = one.name, 2
        while (one.module, name) in known:
            name, more = f"{one.name} {more}", more + 1
        parts.append(replace(one, name=name))
    return parts


def _entry(topic: SeenTopic) -> tuple[Entry, str] | None:
    name, assumed = OF_TYPE.get(topic.type, ("", ""))
    if not name or topic.words & _MADE:
        return None
    if name in ("camera", "lidar_3d") and (topic.words & _DEEP if name == "camera" else _of_camera(topic)):
        name, assumed = "depth_camera", ""
    return part(name), assumed


def _of_camera(topic: SeenTopic) -> bool:
    return bool(topic.words & (_DEEP - {"points"} | {"camera", "color", "rgb"}))


def _source(topic: SeenTopic) -> str:
    """What a topic is of: its first step, /camera of /camera/depth/image_raw."""
    return topic.name.strip("/").partition("/")[0]


def _same_source(one: tuple[SeenTopic, Entry, str], other: tuple[SeenTopic, Entry, str]) -> bool:
    if one[1].kind == "cameras" and other[1].kind == "cameras":
        return _source(one[0]) == _source(other[0])
    return one[1] is other[1] and (one[0] is other[0] or _source(one[0]) == _source(other[0]))


def _bodies(waiting: Sequence[tuple[SeenTopic, Entry, str]]) -> Iterator[tuple[Entry, str, str, str]]:
    left = sorted(waiting, key=lambda one: one[1].name == "camera")  # a depth camera's colour image is its own
    while left:
        first = left[0]
        left = [one for one in left if not _same_source(one, first)]
        topic, entry, assumed = first
        yield entry, " ".join(words_of(topic.name)), f"topic {topic.name}, {topic.type}", assumed
