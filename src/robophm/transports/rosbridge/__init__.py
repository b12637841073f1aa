"""Transport ``rosbridge``: a robot behind rosbridge_server, which says its topics as JSON over a WebSocket.

``Rosbridge`` listens (``source.py``), a ``Publisher`` speaks from a ``Node`` (``publisher.py``). What goes over it is
in ``protocol.py``. Which topics there are, and of which types, tells rosapi, which runs beside the server.
"""

from __future__ import annotations

from robophm.transports.rosbridge.publisher import Node, Publisher
from robophm.transports.rosbridge.source import Rosbridge

__all__ = ["Node", "Publisher", "Rosbridge"]
