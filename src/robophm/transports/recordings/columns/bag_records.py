"""Records of ROS 1 bags: a header of ``name=value`` fields and data, each behind a length of four bytes, little-endian.

Format: wiki.ros.org/Bags/Format/2.0.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from robophm.core.signal import SECOND
from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import DamageError

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

MESSAGE, HEADER, INDEX, CHUNK, CHUNK_INFO, CONNECTION = range(2, 8)

_OUTSIDE = {
    HEADER: {b"index_pos", b"conn_count", b"chunk_count"},
    INDEX: {b"ver", b"conn", b"count"},
    CHUNK: {b"compression", b"size"},
    CHUNK_INFO: {b"ver", b"chunk_pos", b"start_time", b"end_time", b"count"},
    CONNECTION: {b"conn", b"topic"},
}
"""The fields of each record that may lie outside chunks."""

LONGEST_HEADER = 1 << 16
"""Bytes of the fields of a record, beyond which their length is taken to be a lie."""

_FORMER_HEADER = re.compile(r"\broslib/Header\b")
"""The name of the header's type until 2011, with the same fields."""

_LENGTH = struct.Struct("<I").unpack_from
_TIME = struct.Struct("<II").unpack
_VERSION, _CHUNK_INFO = b"\1\0\0\0", bytes([CHUNK_INFO])

INDEX_ENTRY = 12
"""Bytes of an entry of an index."""


class Record(NamedTuple):
    """A record: what its header says, and where its data lies."""

    operation: int
    fields: dict[bytes, bytes]
    start: int
    end: int
    """End of its data, as the record says."""

    def number(self, name: bytes) -> int:
        """Return a field that is a number; raises DamageError."""
        value = self.fields.get(name, b"")
        if len(value) not in (4, 8):
            raise DamageError(f"a record without {name.decode()}")
        return int.from_bytes(value, "little")

    def time(self, name: bytes) -> int:
        """Return a field that is a time [ns]; raises DamageError."""
        if len(self.fields.get(name, b"")) != 8:
            raise DamageError(f"a record without {name.decode()}")
        seconds, nanoseconds = struct.unpack("<II", self.fields[name])
        return int(seconds) * SECOND + int(nanoseconds)


def record_at(
    content: Bytes,
    position: int,
    size: int,
    longest: int = LONGEST_HEADER,
    fields_of: Callable[[bytes], dict[bytes, bytes]] | None = None,
) -> Record:
    """The record at this place of a content of this size, with a header of this length at most; raises DamageError.

    ``fields_of`` takes the fields of its header, where others than ``fields_of_header`` does.
    """
    view, last = content.data, len(content) - 4
    behind = position + 4 + (_LENGTH(view, position)[0] if position <= last else 0)
    if behind > last or behind - position > longest:
        raise DamageError(f"no record at byte {position}")
    end = behind + 4 + _LENGTH(view, behind)[0]
    if end > size:
        raise DamageError(f"a record beyond the end at byte {position}")
    fields = (fields_of or fields_of_header)(bytes(view[position + 4 : behind]))
    operation = fields.get(b"op", b"")
    if len(operation) != 1:
        raise DamageError(f"a record without operation at byte {position}")
    return Record(operation[0], fields, behind + 4, end)


class Index(NamedTuple):
    """An index record behind a chunk: the connection that it is of, and where its entries lie."""

    connection: int
    start: int
    end: int
    sound: bool
    """Whether it is of the version that is known, and as long as it says."""


def index_at(content: memoryview, position: int) -> Index | None:
    """The index record at this place of a file, None where another is; raises DamageError.

    Of thousands of files each has a dozen, with few different headers.
    """
    last = len(content) - 4
    behind = position + 4 + (_LENGTH(content, position)[0] if position <= last else 0)
    if behind > last or behind - position > LONGEST_HEADER:
        raise DamageError(f"no record at byte {position}")
    end = behind + 4 + _LENGTH(content, behind)[0]
    if end > len(content):
        raise DamageError(f"a record beyond the end at byte {position}")
    header = bytes(content[position + 4 : behind])
    said = _index_lately(header) if len(header) <= _SHORT_HEADER else _index_of(header)
    return said and Index(said[0], behind + 4, end, said[1] == end - behind - 4)


def _index_of(header: bytes) -> tuple[int, int] | None:
    """The connection and the bytes of entries that an index's header says, -1 of them where it is of another version.

    Of any other record None; raises DamageError.
    """
    record = Record(INDEX, fields_of_header(header), 0, 0)
    operation = record.fields.get(b"op", b"")
    if len(operation) != 1:
        raise DamageError("a record without operation")
    if operation[0] != INDEX:
        return None
    version, count = (record.fields.get(name, b"") for name in (b"ver", b"count"))
    known = int.from_bytes(version, "little") == 1 and len(count) in (4, 8)
    return record.number(b"conn"), int.from_bytes(count, "little") * INDEX_ENTRY if known else -1


def belongs(record: Record) -> bool:
    """Whether a record has the fields of one that may lie outside chunks, and was not another before it was damaged."""
    return _OUTSIDE.get(record.operation, {b""}) <= record.fields.keys()


def chunk_info(infos: memoryview, at: int) -> tuple[int, int, int, dict[int, int], int]:
    """Return where a chunk lies, when it begins and ends, its messages by connection, and where the next info lies.

    Raises DamageError.
    """
    try:
        (length,) = _LENGTH(infos, at)
        fields = fields_of_header(bytes(infos[at + 4 : at + 4 + length]))
        (size,) = _LENGTH(infos, at + 4 + length)
        start = at + 8 + length
        end = start + size
        (count,) = _LENGTH(fields[b"count"])
        if fields[b"op"] != _CHUNK_INFO or fields[b"ver"] != _VERSION or count * 8 != size or end > len(infos):
            raise DamageError("a damaged chunk info")
        counts: dict[int, int] = dict(struct.iter_unpack("<II", infos[start:end]))
        (offset,) = struct.unpack("<Q", fields[b"chunk_pos"])
        (first, first_part), (last, last_part) = map(_TIME, (fields[b"start_time"], fields[b"end_time"]))
    except (KeyError, struct.error) as error:
        raise DamageError("a damaged chunk info") from error
    if len(counts) != count:
        raise DamageError("a damaged chunk info")
    if not count:
        return offset, 0, 0, counts, end
    return offset, first * SECOND + first_part, last * SECOND + last_part, counts, end


def fields_of_header(header: bytes) -> dict[bytes, bytes]:
    """The fields of a header by their names; raises DamageError."""
    fields = {}
    position, length = 0, len(header)
    while position + 4 <= length:
        begin = position + 4
        position = begin + _LENGTH(header, position)[0]
        if position > length:
            raise DamageError("a damaged header")
        name, _, value = header[begin:position].partition(b"=")
        fields[name] = value
    return fields


def fields_often(header: bytes) -> dict[bytes, bytes]:
    """The fields of a header of which many files have the same, as those of an index; raises DamageError."""
    return _fields_lately(header) if len(header) <= _SHORT_HEADER else fields_of_header(header)


_SHORT_HEADER = 64
"""Bytes of an index's header, and some more."""

_fields_lately = lru_cache(maxsize=1024)(fields_of_header)
_index_lately = lru_cache(maxsize=4096)(_index_of)


@lru_cache(maxsize=64)
def connections_of(defined: tuple[tuple[int, tuple[str, str, str]], ...]) -> list[Connection]:
    """The connections by number, topic, type and definition; the files of one drive have the same."""
    from rosbags.interfaces import Connection, ConnectionExtRosbag1, MessageDefinition
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys.msg import normalize_msgtype

    connections = []
    for id_, (topic, name, definition) in defined:
        try:
            name = normalize_msgtype(name)
        except Exception:  # said when the topic is asked for
            definition = ""
        extension = ConnectionExtRosbag1(None, None)
        text = MessageDefinition(Format.MSG, _FORMER_HEADER.sub("std_msgs/Header", definition))
        connections.append(Connection(id_, topic, name, text, "", 0, extension, None))
    return connections
