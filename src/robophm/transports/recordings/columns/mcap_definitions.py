"""The schemas and channels of MCAP files: who publishes what, and how its messages are read."""

from __future__ import annotations

import struct
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from robophm.transports.recordings.columns.pieces import LONGEST_TEXT, DamageError
from robophm.transports.signals.json_messages import ENCODINGS

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

SCHEMA, CHANNEL = 3, 4
"""Opcodes of records."""

_SCHEMAS = {**dict.fromkeys(ENCODINGS, "jsonschema"), "protobuf": "protobuf", "flatbuffer": "flatbuffer"}
"""The language of schemas by the encoding of messages that are not of ROS."""

Schemas = dict[int, tuple[str, str, bytes]]
"""Name, language and text of each."""

Channels = dict[int, tuple[int, str, str]]
"""Schema, topic and encoding of messages of each."""


class Definitions(NamedTuple):
    """The schemas, channels and connections that a run of records defines."""

    run: bytes
    schemas: Schemas
    channels: Channels
    connections: list[Connection]


def define(opcode: int, content: memoryview, schemas: Schemas, channels: Channels) -> None:
    """Keep a schema or a channel; what was said first holds. Raises DamageError."""
    try:
        (id_,) = struct.unpack_from("<H", content)
        if opcode == SCHEMA:
            name, at = _text(content, 2)
            encoding, at = _text(content, at)
            data, _ = _sized(content, at)
            schemas.setdefault(id_, (name, encoding, data))
        else:
            (schema,) = struct.unpack_from("<H", content, 2)
            topic, at = _text(content, 4)
            encoding, _ = _text(content, at)
            channels.setdefault(id_, (schema, topic, encoding))
    except (struct.error, UnicodeDecodeError) as error:
        raise DamageError("a damaged schema or channel") from error


def definitions_of(records: memoryview) -> Definitions:
    """Return what the schemas and channels define that these records begin with. Raises DamageError.

    The files of one drive have the same: those of the file before are compared as they lie.
    """
    global _defined_last
    last = _defined_last
    end = len(last.run)
    more = end < len(records) and records[end] in (SCHEMA, CHANNEL)
    if not end or more or bytes(records[:end]) != last.run:  # which is ten times as fast as to compare a view
        last = _defined_last = _definitions_of(_run_of_definitions(records))
    return last


_defined_last = Definitions(b"", {}, {}, [])
"""The definitions of the file before."""


def _run_of_definitions(records: memoryview) -> bytes:
    """The schemas and channels that these records begin with."""
    end = 0
    while end + 9 <= len(records) and records[end] in (SCHEMA, CHANNEL):
        behind = end + 9 + int(struct.unpack_from("<Q", records, end + 1)[0])
        if behind > len(records):
            break
        end = behind
    return bytes(records[:end])


@lru_cache(maxsize=64)
def _definitions_of(run: bytes) -> Definitions:
    schemas: Schemas = {}
    channels: Channels = {}
    position = 0
    while position < len(run):
        opcode, length = struct.unpack_from("<BQ", run, position)
        define(opcode, memoryview(run)[position + 9 : position + 9 + length], schemas, channels)
        position += 9 + length
    return Definitions(run, schemas, channels, connections_of(schemas, channels))


def connections_of(schemas: Schemas, channels: Channels) -> list[Connection]:
    """The connections that channels are."""
    from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys.msg import normalize_msgtype

    formats = {"ros1msg": Format.MSG, "ros2msg": Format.MSG, "ros2idl": Format.IDL, "omgidl": Format.IDL}
    connections = []
    for id_, (schema, topic, encoding) in sorted(channels.items()):
        name, language, data = schemas.get(schema, ("", "", b""))
        format_ = formats.get(language, Format.NONE)
        definition = MessageDefinition(format_, data.decode(errors="replace") if format_.value else "")
        if encoding in _SCHEMAS:  # a byte a letter: a definition is a text
            definition = MessageDefinition(
                Format.NONE, data.decode("latin-1") if _SCHEMAS[encoding] == language else ""
            )
        try:
            name = normalize_msgtype(name) if name and encoding not in _SCHEMAS else name
        except Exception:  # said when the topic is asked for
            definition = MessageDefinition(Format.MSG, "")
        connections.append(Connection(id_, topic, name, definition, "", 0, ConnectionExtRosbag2(encoding, []), None))
    return connections


def _sized(content: memoryview, at: int) -> tuple[bytes, int]:
    (size,) = struct.unpack_from("<I", content, at)
    if at + 4 + size > len(content) or size > LONGEST_TEXT:
        raise DamageError("a length beyond the end")
    return bytes(content[at + 4 : at + 4 + size]), at + 4 + size


def _text(content: memoryview, at: int) -> tuple[str, int]:
    text, behind = _sized(content, at)
    return text.decode(), behind
