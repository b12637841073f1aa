from ..foxglove.conftest import foxglove_sdk
from ..mqtt.conftest import mosquitto
from ..ros2_dds.conftest import domain

__all__ = ["domain", "foxglove_sdk", "mosquitto"]
