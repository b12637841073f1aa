"""The messages of one publisher on one topic."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable

from robophm.transports.live.decoding import TopicDecoder
from robophm.transports.live.receiving import Receiver
from robophm.transports.ros1.loop import Loop, Peer
from robophm.transports.ros1.tcpros import LONGEST_MESSAGE

_LENGTH = struct.Struct("<I")


class Stream(Peer):
    """Cuts what a publisher sends into messages and has them heard; ``lost`` is called when the connection is gone."""

    guest = False

    def __init__(
        self,
        loop: Loop,
        connection: socket.socket,
        uri: str,
        reading: TopicDecoder,
        hearing: Receiver,
        lost: Callable[[Stream], None],
    ) -> None:
        super().__init__(loop, connection)
        self.uri = uri
        self.reading = reading
        self.messages = 0
        self.sequence: int | None = None
        """Header.seq of the latest message."""
        self._hearing = hearing
        self._lost = lost

    def taken(self) -> None:
        """Hand on all messages that are whole."""
        received, raws, at = self.received, [], 0
        with memoryview(received) as view:
            while len(received) - at >= 4:
                (length,) = _LENGTH.unpack_from(received, at)
                if length > LONGEST_MESSAGE:
                    break
                end = at + 4 + length
                if end > len(received):
                    break
                raws.append(bytes(view[at + 4 : end]))
                at = end
        if raws:
            self.messages += len(raws)
            self.sequence = self._hearing.messages(self.reading, raws, self.sequence)
            del received[:at]
        if len(received) >= 4 and (length := _LENGTH.unpack_from(received)[0]) > LONGEST_MESSAGE:
            self.loop.notes.add(f"message on {self.reading.topic} longer than {LONGEST_MESSAGE} bytes")
            raise ValueError(f"message of {length} bytes")

    def ended(self) -> None:
        """Ask for the connection to be made again."""
        self._lost(self)
