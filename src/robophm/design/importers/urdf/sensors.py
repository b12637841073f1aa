"""The sensors of a URDF: by tags of Gazebo and ros2_control, and by names and meshes of links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from robophm.design.draft import DraftPart
from robophm.design.importers.urdf.drives import named, words_of
from robophm.design.importers.urdf.reading import Description, Sensor
from robophm.parts import Entry, library, part, search

SENSING = ("lidars", "cameras", "inertial", "rangefinders", "sensors", "radio", "switches")
"""Kinds of the library that sense."""

OF_GAZEBO = {
    "ray": "lidar_2d", "gpu_ray": "lidar_2d", "lidar": "lidar_2d", "gpu_lidar": "lidar_2d", "camera": "camera",
    "wideanglecamera": "camera", "multicamera": "camera", "depth": "depth_camera", "depth_camera": "depth_camera",
    "rgbd": "depth_camera", "rgbd_camera": "depth_camera", "thermal_camera": "thermal_camera", "imu": "imu",
    "gps": "gnss_receiver", "navsat": "gnss_receiver", "contact": "bumper_switch", "sonar": "ultrasonic_sensor",
    "force_torque": "force_torque_sensor", "altimeter": "barometer", "air_pressure": "barometer",
    "magnetometer": "magnetometer",
}  # fmt: skip
"""The most likely entry of the library of parts for each type of sensor in a tag of Gazebo (SDFormat)."""

_CALLED = {
    "scan": "lidar_2d", "laser": "lidar_2d", "lidar": "lidar_2d", "sonar": "ultrasonic_sensor", "gnss": "gnss_receiver",
    "gps": "gnss_receiver", "depth": "depth_camera", "rgbd": "depth_camera", "bumper": "bumper_switch",
    "cliff": "infrared_sensor", "ft": "force_torque_sensor", "rgb": "camera", "optical": "camera",
}  # fmt: skip
"""The entry of the library for each word by which links are named after the sensor on them."""

_SIDES = ("front", "rear", "back", "left", "right", "top", "bottom", "upper", "lower")
_VAGUE = frozenset(
    {"link", "frame", "base", "mount", "joint", "holder", "plate", "sensor", "sensors", "robot", "body", "tool"}
)
_SHORT = {"lidars": "lidar", "cameras": "camera"}


@dataclass
class _Found:
    entry: Entry
    link: str
    seen: str
    assumed: str = ""


def sensor_parts(description: Description) -> list[DraftPart]:
    """The sensors that a robot is described with, one for each body, however many frames that has."""
    on: dict[str, _Found] = {}
    for link in description.links:
        if found := _on_link(link.name, list(link.looks)):
            on[link.name] = found
    for sensor in description.sensors:
        _add(on, sensor)
    above = {joint.child: joint.parent for joint in description.joints if joint.type == "fixed"}
    for frame in list(on):
        holder, steps = above.get(frame), 0
        while holder not in (None, frame) and steps < len(above):
            if holder in on and same_body(on[holder].entry, on[frame].entry):
                if part_rank(on[frame].entry) > part_rank(on[holder].entry):
                    on[holder].entry = on[frame].entry
                del on[frame]
                break
            holder, steps = above.get(holder), steps + 1
    return list(named_parts(
        (found.entry, f"{found.link} {found.seen}", found.seen, found.assumed) for found in on.values()
    ))  # fmt: skip


def same_body(one: Entry, other: Entry) -> bool:
    """Whether two frames at one place are of one sensor: the same, or both some lidar or camera."""
    return one is other or (one.kind == other.kind and one.kind in _SHORT)


def part_rank(entry: Entry) -> int:
    """How much an entry says beyond its kind: a depth camera is a camera, a lidar of rings a lidar."""
    return 0 if entry.name in ("camera", "lidar_2d") else 1


def named_parts(found: Iterator[tuple[Entry, str, str, str]]) -> Iterator[DraftPart]:
    """Sensors under names that tell them apart, from (entry, words of its place, what was seen, what is assumed)."""
    taken: dict[str, int] = {}
    for entry, place, seen, assumed in found:
        noun = _SHORT.get(entry.kind, entry.name.replace("_", " "))
        name = " ".join([*dict.fromkeys(word for word in words_of(place) if word in _SIDES), noun])
        taken[name] = taken.get(name, 0) + 1
        yield DraftPart("sensing", name if taken[name] == 1 else f"{name} {taken[name]}", entry.name, seen, assumed)


def _on_link(name: str, looks: list[str]) -> _Found | None:
    """What sensor is on a link, if its meshes or its name say so."""
    if entry := named(looks, SENSING):
        return _Found(entry, name, f"link {name}, drawn as {_matching(looks, entry)}")
    words = [word for word in words_of(name) if word not in _VAGUE]
    if entry := named(["_".join(words)], SENSING):
        entry = library()["depth_camera"] if entry.name == "camera" and "depth" in words else entry
        return _Found(entry, name, f"link {name}")
    if called := next((_CALLED[word] for word in words if word in _CALLED), None):
        return _Found(library()[called], name, f"link {name}", "by the name of its link alone")
    return None


def _matching(looks: list[str], entry: Entry) -> str:
    return next(look for look in looks if named([look], (entry.kind,)) is entry)


def _add(on: dict[str, _Found], sensor: Sensor) -> None:
    if sensor.type:
        name = OF_GAZEBO.get(sensor.type.lower())
        entry = part("lidar_3d") if name == "lidar_2d" and sensor.rings > 1 else library().get(name or "")
    else:
        entry = next((one for one in search(" ".join(words_of(sensor.name))) if one.kind in SENSING), None)
    if entry is None:
        return
    seen = f"<sensor> {sensor.name or sensor.type}"
    there = on.get(sensor.link)
    if there and same_body(there.entry, entry):
        if part_rank(entry) > part_rank(there.entry):
            there.entry, there.seen = entry, seen
    else:
        on[sensor.link if sensor.link and not there else f"{sensor.link} {sensor.name}"] = _Found(
            entry, sensor.link, seen
        )
