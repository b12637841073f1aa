"""The Foxglove WebSocket protocol as it is spoken here: addresses, channels, and messages in their frames."""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.mcap_definitions import connections_of
from robophm.transports.signals.message_type import MessageType, message_type

SUBPROTOCOLS = ("foxglove.sdk.v1", "foxglove.websocket.v1")
"""Names of the protocol, the newer one first; they differ in nothing that is used here."""

PORT = 8765
"""Port of a server that names none, that of foxglove_bridge."""

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


def address(text: str) -> str:
    """Return the WebSocket address of ``foxglove`` or ``foxglove://host[:port]``. Raises SourceError for another."""
    try:
        parts = urlsplit(text if "://" in text else f"{text}://127.0.0.1")
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port, parts = None, None, urlsplit("")
    if parts.scheme != "foxglove" or not host or parts.path.strip("/") or parts.query or parts.username:
        raise SourceError(
            f"'{text}' is not the address of a Foxglove server; expected e.g. foxglove://127.0.0.1:{PORT}"
        )
    return f"ws://{f'[{host}]' if ':' in host else host}:{port or PORT}"


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
