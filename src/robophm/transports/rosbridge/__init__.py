"""Transport ``rosbridge``: a robot behind rosbridge_server, which says its topics as JSON over a WebSocket.

``Rosbridge`` listens (``source.py``), a ``Publisher`` and a ``Service`` speak from a ``Node`` (``publisher.py``,
``service.py``). What goes over the connection is in ``protocol.py``. Which topics there are, and of which types, tells
rosapi, which runs beside the server.
"""

from __future__ import annotations

from robophm.transports.rosbridge.publisher import Node, Publisher
from robophm.transports.rosbridge.service import Service
from robophm.transports.rosbridge.source import Rosbridge

__all__ = ["Node", "Publisher", "Rosbridge", "Service"]
