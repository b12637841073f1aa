from ..mqtt.conftest import mosquitto
from ..ros2_dds.conftest import domain

__all__ = ["domain", "mosquitto"]
