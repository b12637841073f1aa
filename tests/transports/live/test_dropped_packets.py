"""Packets that the kernel drops are counted: as many as were sent and cannot be read."""

from __future__ import annotations

import socket
import sys

import pytest

from robophm.transports.live.dropped_packets import DroppedPackets

SENT = 2000


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the kernel's count is Linux's")
def test_what_was_sent_and_cannot_be_read_was_dropped() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as reader, socket.socket(type=socket.SOCK_DGRAM) as sender:
        reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        reader.bind(("127.0.0.1", 0))
        dropped = DroppedPackets()
        assert dropped.fresh() == 0
        for _ in range(SENT):
            sender.sendto(bytes(100), reader.getsockname())
        found = dropped.fresh()
        reader.setblocking(False)
        read = 0
        try:
            while reader.recv(200):
                read += 1
        except BlockingIOError:
            pass
        assert 0 < read < SENT
        assert found == SENT - read
        assert dropped.fresh() == 0
