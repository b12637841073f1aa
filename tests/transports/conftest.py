from __future__ import annotations

from pathlib import Path

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
