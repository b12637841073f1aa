"""Transport ``ros1``: live ROS 1 from the standard library, with message types from rosbags; no rospy.

``Ros1`` listens (``source.py``), a ``Publisher`` speaks (``publisher.py``), a ``Service`` answers (``service.py``),
each from a ``Node`` that the master knows (``node.py``). All sockets of a node are served by one thread (``loop.py``):
messages that come (``stream.py``), subscribers, callers of services, and the calls of the master and of tools
(``slave.py``). What blocks, calls to others (``xmlrpc.py``, ``master.py``) and new connections (``tcpros.py``), is done
by others, each with a deadline.
"""

from __future__ import annotations

from robophm.transports.ros1.node import Node
from robophm.transports.ros1.publisher import Publisher
from robophm.transports.ros1.service import Service
from robophm.transports.ros1.source import Ros1

__all__ = ["Node", "Publisher", "Ros1", "Service"]
