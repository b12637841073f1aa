from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta

SIGNALS = (
    "/ota/battery.current",
    "/ota/battery.voltage",
    "/ota/mobility/temperature.temperature",
    "/ota/odom.pose.pose.position.x",
    "/ota/odom.twist.twist.angular.z",
)


@pytest.fixture(scope="session")
def drive() -> SyntheticOta:
    """Half a minute of the synthetic robot."""
    return SyntheticOta(seed=3, duration=30 * SECOND)


@pytest.fixture(scope="session")
def recorded(drive: SyntheticOta, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The drive in the three formats, by suffix."""
    folder = tmp_path_factory.mktemp("recorded")
    return {suffix: drive.record(folder / f"drive{suffix}") for suffix in (".bag", ".db3", ".mcap")}


@pytest.fixture
def write_messages() -> Callable[..., Path]:
    """Write (topic, type, receipt [ns], message as keyword arguments of its class) as ROS 2 MCAP."""

    def write(path: Path, messages: Iterable[tuple[str, str, int, Callable[[Any], object]]]) -> Path:
        from mcap.writer import Writer
        from rosbags.typesys import Stores, get_typestore

        store = get_typestore(Stores.ROS2_HUMBLE)
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            channels: dict[str, int] = {}
            for topic, type_, receipt, make in messages:
                if topic not in channels:
                    definition = store.generate_msgdef(type_, 2)[0].encode()
                    schema = writer.register_schema(type_, "ros2msg", definition)
                    channels[topic] = writer.register_channel(topic, "cdr", schema)
                raw = bytes(store.serialize_cdr(make(store.types), type_))
                writer.add_message(channels[topic], receipt, raw, receipt)
            writer.finish()
        return path

    return write
