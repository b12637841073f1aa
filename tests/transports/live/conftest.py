from ..foxglove.conftest import foxglove_sdk
from ..mqtt.conftest import mosquitto
from ..ros2_dds.conftest import domain
from ..ros2_zenoh.conftest import zenoh_wheel

__all__ = ["domain", "foxglove_sdk", "mosquitto", "zenoh_wheel"]
