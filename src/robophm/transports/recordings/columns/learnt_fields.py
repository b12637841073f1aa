"""Channels of MCAP whose fields nothing but their messages says: some of those are looked into."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns.rows import one_by_one
from robophm.transports.signals.element_names import MOST_UNNAMED, PLACES_NAMING
from robophm.transports.signals.json_messages import ENCODINGS, LearntSchema, parser, says_fields
from robophm.transports.signals.message_type import message_type, ways_to

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

    from robophm.transports.recordings.columns.pieces import PiecedFile

MOST_FILES = 16
"""Files of a drive, as far apart, that are looked into for fields."""


def learn_fields(files: Sequence[PiecedFile], wanted: Mapping[str, Collection[str]] | None = None) -> None:
    """Give channels without a schema the one that their messages make, the same in all files of a drive.

    Some messages are looked into, as for the names of elements; all, if a field that is wanted is not in those.
    """
    described = {id(file.connections): file.connections for file in files}  # many have the same
    known = [one for connections in described.values() for one in connections if _unsaid(one)]
    topics = {one.topic for one in known if wanted is None or not _has(one, wanted.get(one.topic, ()))}
    if not topics:
        return
    learnt = {(one.topic, _encoding(one)): LearntSchema() for one in known if one.topic in topics}
    for file in files if wanted else files[:: -(-len(files) // MOST_FILES)]:
        for one in file.connections:
            if schema := learnt.get((one.topic, _encoding(one))) if _unsaid(one) else None:
                _learn(schema, file, one, everything=wanted is not None)
    said = {list_: [_described(one, learnt) for one in connections] for list_, connections in described.items()}
    for file in files:  # those that share their connections go on sharing them
        file.connections = said[id(file.connections)]


def _learn(schema: LearntSchema, file: PiecedFile, connection: Connection, everything: bool) -> None:
    try:
        parse = parser(_encoding(connection))
    except SourceError:  # a library is missing, which is said when the topic is asked for
        return
    notes, file.notes = file.notes, Counter()  # what is lost is noted when it is asked for
    try:
        with suppress(Exception):  # what cannot be had says nothing
            _, spans = file.told().get(connection.id, (0, ()))
            places = 1 if everything else PLACES_NAMING
            for part in range(places if spans else 0):
                start = spans[0][0] + (spans[-1][1] - spans[0][0]) * part // places
                left = MOST_UNNAMED
                for _, raw, _ in one_by_one(file, [connection.id], start):
                    left = MOST_UNNAMED if _learnt(schema, parse, raw) or everything else left - 1
                    if left < 1:
                        break
    finally:
        file.notes = notes


def _learnt(schema: LearntSchema, parse: Callable[[bytes], Any], raw: bytes) -> bool:
    """Whether a message brings anything new; what cannot be read does not."""
    try:
        return schema.learn(parse(raw))
    except Exception:  # damaged bytes fail in many ways; each is counted where the message is read
        return False


def _has(connection: Connection, fields: Collection[str]) -> bool:
    """Whether messages are known to have all of these fields."""
    try:
        type_ = message_type(connection)
        return all(ways_to(type_.definitions, type_.name, field) for field in fields)
    except SourceError:
        return not fields


def _unsaid(connection: Connection) -> bool:
    return _encoding(connection) in ENCODINGS and not says_fields(connection.msgdef.data.encode("latin-1"))


def _encoding(connection: Connection) -> str:
    return getattr(connection.ext, "serialization_format", "")


def _described(connection: Connection, learnt: Mapping[tuple[str, str], LearntSchema]) -> Connection:
    schema = learnt.get((connection.topic, _encoding(connection)))
    if not schema or not _unsaid(connection):
        return connection
    return connection._replace(msgdef=connection.msgdef._replace(data=schema.schema.decode("latin-1")))
