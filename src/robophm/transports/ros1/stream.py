"""The messages of one publisher on one topic."""

from __future__ import annotations

import socket
import struct
from typing import TYPE_CHECKING

from robophm.transports.reading import Reading
from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.tcpros import LONGEST_MESSAGE

if TYPE_CHECKING:
    from robophm.transports.ros1.listening import Listening


class Stream(Peer):
    """Cuts what a publisher sends into messages and hands them on."""

    guest = False

    def __init__(self, loop: Loop, connection: socket.socket, uri: str, reading: Reading, listening: Listening) -> None:
        super().__init__(loop, connection)
        self.uri = uri
        self.reading = reading
        self.messages = 0
        self.sequence: int | None = None
        """Header.seq of the latest message."""
        self._listening = listening

    def taken(self) -> None:
        """Hand on all messages that are whole."""
        received = self.received
        at = 0
        while len(received) - at >= 4:
            (length,) = struct.unpack_from("<I", received, at)
            if length > LONGEST_MESSAGE:
                self.loop.notes.add(f"message on {self.reading.topic} longer than {LONGEST_MESSAGE} bytes")
                raise ValueError(f"message of {length} bytes")
            end = at + 4 + length
            if end > len(received):
                break
            with memoryview(received) as view:
                raw = bytes(view[at + 4 : end])
            at = end
            self.messages += 1
            self._listening.message(self, raw)
        del received[:at]

    def ended(self) -> None:
        """Have it made again."""
        self._listening.ended(self)
