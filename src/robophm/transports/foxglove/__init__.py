"""Transport ``foxglove``: a robot that serves its topics over the Foxglove WebSocket protocol, as foxglove_bridge does.

``Foxglove`` listens (``source.py``), a ``Publisher`` speaks from a ``Node`` (``publisher.py``). The server tells the
definition of each type, so that neither ROS nor its messages are needed here. What goes over the connection is in
``protocol.py``.
"""

from __future__ import annotations

from robophm.transports.foxglove.publisher import Node, Publisher
from robophm.transports.foxglove.source import Foxglove

__all__ = ["Foxglove", "Node", "Publisher"]
