"""The Foxglove WebSocket protocol as it is spoken here: addresses, channels, and messages in their frames."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from typing import Any

from robophm.transports.live.web_socket import Server
from robophm.transports.recordings.columns.mcap_definitions import connections_of
from robophm.transports.signals.message_type import MessageType, message_type

SERVER = Server("Foxglove server", "foxglove", 8765, ("foxglove.sdk.v1", "foxglove.websocket.v1"))
"""The kind of server: its port is that of foxglove_bridge; the names of the protocol, the newer one first, differ in
nothing that is used here."""

PUBLISHED_ENCODINGS = ("cdr", "ros1")
"""Encodings in which messages are published, by what the server says that it takes."""

MOST_CHANNELS = 10_000
"""Channels of one server that are remembered."""

_MESSAGE = struct.Struct("<BIQ")
_MESSAGE_DATA = 1


@dataclass(frozen=True)
class Channel:
    """A topic as the server tells of it: of one publisher, or of all that publish one type."""

    id: int
    topic: str
    encoding: str
    schema_name: str
    schema_encoding: str
    schema: bytes

    @property
    def identity(self) -> str:
        """Return a text by which its type is known when it changes."""
        return f"{self.encoding} {self.schema_name} {hash(self.schema):x}"

    def type(self) -> MessageType:
        """Return the type of its messages. Raises SourceError where they cannot be decoded."""
        schemas = {1: (self.schema_name, self.schema_encoding, self.schema)}
        (connection,) = connections_of(schemas, {self.id: (1, self.topic, self.encoding)})
        return message_type(connection)


def channels_of(said: Any) -> list[Channel]:
    """Return the channels that an ``advertise`` tells of; those that are none are left out."""
    found = []
    for one in said if isinstance(said, list) else []:
        try:
            encoding, language = str(one["encoding"]), str(one.get("schemaEncoding") or "")
            language = language or {"ros1": "ros1msg", "cdr": "ros2msg", "json": "jsonschema"}.get(encoding, encoding)
            schema = str(one.get("schema") or "")
            binary = language in ("protobuf", "flatbuffer")
            raw = base64.b64decode(schema, validate=True) if binary else schema.encode()
            found.append(Channel(int(one["id"]), str(one["topic"]), encoding, str(one["schemaName"]), language, raw))
        except (AttributeError, KeyError, TypeError, ValueError):
            continue
    return found


def message_in(frame: bytes) -> tuple[int, bytes] | None:
    """Return the subscription's number and the message of a binary frame; None where it is of another kind."""
    if len(frame) < _MESSAGE.size or frame[0] != _MESSAGE_DATA:
        return None
    _, subscription, _ = _MESSAGE.unpack_from(frame)
    return subscription, frame[_MESSAGE.size :]


def framed(channel: int, message: bytes) -> bytes:
    """Return the frame of a message that we publish."""
    return struct.pack("<BI", 1, channel) + message


def text(op: str, **fields: Any) -> str:
    """Return a message of the protocol as JSON."""
    return json.dumps({"op": op, **fields})
