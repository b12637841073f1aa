"""Connections whose other end may go without a word."""

from __future__ import annotations

import socket


def keep_alive(connection: socket.socket) -> None:
    """Have it noticed after half a minute that the machine at the other end is gone without a word."""
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (("TCP_KEEPIDLE", 15), ("TCP_KEEPINTVL", 5), ("TCP_KEEPCNT", 3)):
        if hasattr(socket, option):  # by other names, or not at all, outside Linux
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, option), value)
