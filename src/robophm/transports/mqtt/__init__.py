"""Transport ``mqtt``: JSON on the topics of an MQTT broker, as AMRs without ROS tell their state by VDA 5050.

``Mqtt`` listens (``source.py``), a ``Publisher`` speaks from a ``Node`` (``publisher.py``). An address says where the
broker is and below which topic the robot speaks (``address.py``). What a message holds is read by path, within bounds
(``json_message.py``). All that touches paho-mqtt is in ``connection.py``.
"""

from __future__ import annotations

from robophm.transports.mqtt.address import Address, address
from robophm.transports.mqtt.publisher import Node, Publisher
from robophm.transports.mqtt.source import Mqtt

__all__ = ["Address", "Mqtt", "Node", "Publisher", "address"]
