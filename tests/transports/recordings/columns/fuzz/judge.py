"""Read a damaged file, and say what is not as it should be."""

from __future__ import annotations

import re
import shutil
import sqlite3
import tempfile
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, suppress
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording

from . import log_judge, message_judge
from .mutate import Mutant
from .seeds import FIELDS, MEMORY, TOPICS, Rows, numbers, truth, typestore

Peers = tuple[tuple[str, Callable[[Path, int], Rows]], ...]
"""Names of others who read recordings, and how."""

_SAID = re.compile(r"lost|unreadable|looked through|in the index|damaged|backwards")


class Read(NamedTuple):
    """What came out of a file."""

    rows: Rows
    notes: Counter[str]


class Verdict(NamedTuple):
    outcome: str
    """refused; whole; in part; changed: other values than were written, where nothing protects them."""
    fault: str = ""
    """What is not as it should be."""


def read(path: Path, topics: Iterable[str] = TOPICS) -> Read | SourceError:
    """The columns of these topics, or of those that are still there."""
    known = [f"{topic}.{field}" for topic in topics for field in FIELDS[topic]]
    refused: Counter[str] = Counter()
    while True:
        try:
            ours = _columns(path, known)
            ours.notes.update(refused)
            return ours
        except SourceError as error:
            # a topic alone may be damaged: the others are to be read all the same
            gone = next((topic for topic in TOPICS if f"topic '{topic}'" in str(error)), None)
            left = [signal for signal in known if gone is None or not signal.startswith(f"{gone}.")]
            if not left or len(left) == len(known):
                return error
            refused[f"lost: {error}"] += 1
            known = left


def _columns(path: Path, signals: list[str]) -> Read:
    columns = read_columns(path, signals)
    rows: Rows = {}
    for block in columns:
        for topic, part in block.items():
            assert all(len(values) == len(part) for values in part.values.values())
            fields = [part.values[field].tolist() for field in FIELDS[topic]]
            received = part.received.tolist()
            assert received == sorted(received), "a block is not in order of receipt"
            rows.setdefault(topic, []).extend(zip(received, zip(*fields, strict=True), strict=True))
    return Read(rows, columns.notes)


def judge(mutant: Mutant, path: Path) -> tuple[Verdict, Read | SourceError]:
    """Whether what is read of a file is what may be read of it."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        try:
            if mutant.told:
                return Verdict(*message_judge.verdict(mutant.told, path)), SourceError("")
            if mutant.log:
                return Verdict(*log_judge.verdict(mutant, path)), SourceError("")
            ours = read(path, mutant.topics)
        except SourceError as error:
            return _refusal(error, mutant, path), error
        except Exception:
            return Verdict("fault", traceback.format_exc()), SourceError("")
    if warned:
        return Verdict("fault", f"warning: {warned[0].message} at {warned[0].filename}:{warned[0].lineno}"), ours
    if isinstance(ours, SourceError):
        return _refusal(ours, mutant, path), ours
    return _answer(ours, mutant), ours


def _refusal(error: SourceError, mutant: Mutant, path: Path) -> Verdict:
    if "\n" in str(error) or str(path) not in str(error):
        return Verdict("fault", f"an error that is not one line with the name of the file: {error!s:.300}")
    cause: BaseException | None = error
    while cause:
        if isinstance(cause, MemoryError):
            return Verdict("fault", "wants all memory: " + "".join(traceback.format_exception(cause)))
        cause = cause.__cause__ or (None if cause.__suppress_context__ else cause.__context__)
    if mutant.losable is not None and not mutant.log and mutant.suffix != ".db3" and len(mutant.losable) < 6:
        return Verdict("fault", f"refused where most can be read: {error}")
    return Verdict("refused")


def _answer(ours: Read, mutant: Mutant) -> Verdict:
    if any("allocate" in note or "MemoryError" in note for note in ours.notes):
        return Verdict("fault", f"wants all memory: {dict(ours.notes)}")
    said = any(map(_SAID.search, ours.notes))
    there = counted(truth(mutant.ros), mutant.topics)
    found = counted(ours.rows, mutant.topics)
    if found == there:
        return Verdict("whole")
    if mutant.losable is not None:
        if made_up := found - there:
            return Verdict("fault", f"made up: {[*made_up][:3]}; {dict(ours.notes)}")
        gone = there - found
        if extra := [row for row in gone if (row[0], row[1]) not in mutant.losable]:
            return Verdict("fault", f"lost more than what was damaged: {extra[:3]}; {dict(ours.notes)}")
        if not said:
            return Verdict("fault", f"{sum(gone.values())} messages are lost without a word: {dict(ours.notes)}")
    return Verdict("changed" if found - there else "in part")


def counted(rows: Rows, topics: Iterable[str]) -> Counter[tuple[str, int, str]]:
    """How often each message of these topics is there; of numbers that are NaN one is as good as another."""
    return Counter((topic, time, repr(values)) for topic in topics for time, values in rows.get(topic, ()))


def peers_of(mutant: Mutant, slow: bool) -> Peers:
    """The peers that a file is given to, the slow ones among them or not."""
    return (
        () if mutant.log or mutant.told else (*ALWAYS.get(mutant.suffix, ()), *(PEERS[mutant.suffix] if slow else ()))
    )


def compare(ours: Read | SourceError, mutant: Mutant, path: Path, peers: Peers) -> Iterator[tuple[str, str]]:
    """What every peer makes of the file: 'refuses', 'agrees', 'ours says what is lost', or where they differ."""
    for name, peer in peers:
        if mutant.beside and peer is _rosbags:  # which does not look into a log
            continue
        try:
            theirs = peer(path, mutant.ros)
        except Exception:  # peers let anything through
            yield f"{name} refuses", ""
            continue
        other, there = counted(theirs, mutant.topics), counted(truth(mutant.ros), mutant.topics)
        found = counted({} if isinstance(ours, SourceError) else ours.rows, mutant.topics)
        if found == other:
            yield f"{name} agrees", ""
        elif isinstance(ours, SourceError):
            yield f"{name} reads what ours refuses", ""  # a refusal is said; where it must not be, judge() finds it
        elif found == there or (not other - found and not found - other - there):  # a peer may stop where we go on
            yield f"{name} differs, ours is what was written", ""
        elif not other - found and _one_changed(found - other - there, there - found):
            yield f"{name} differs, ours goes on and has one message changed", ""
        elif any(map(_SAID.search, ours.notes)):
            yield f"{name} differs, ours says why", ""
        else:
            more, less = [*(found - other)][:3], [*(other - found)][:3]
            yield f"{name} differs", f"only ours: {more}; only {name}: {less}; notes {dict(ours.notes)}"


def _one_changed(more: Counter[tuple[str, int, str]], missing: Counter[tuple[str, int, str]]) -> bool:
    """Whether one message stands where one that was written does not; if that was protected, _answer() has said so."""
    return more.total() == 1 and {row[:2] for row in more} <= {row[:2] for row in missing}


@lru_cache(maxsize=64)
def _decoder(type_: str, definition: Any, encoding: str) -> Any:
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    if definition.format is not Format.MSG:
        raise ValueError(definition.format)
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(definition.data, type_))
    deserialize = store.deserialize_ros1 if encoding == "ros1" else store.deserialize_cdr
    return lambda raw: deserialize(raw, type_)


def _rosbags(path: Path, _: int) -> Rows:
    from rosbags.rosbag1 import Reader as BagReader
    from rosbags.rosbag2 import Reader as Rosbag2Reader

    if path.suffix == ".db3":
        with closing(sqlite3.connect(f"{path.as_uri()}?immutable=1", uri=True)) as database:
            assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    rows: Rows = {}
    with BagReader(path) if path.suffix == ".bag" else Rosbag2Reader(path) as reader:
        for connection, time, raw in reader.messages():
            if connection.topic in TOPICS:
                encoding = getattr(connection.ext, "serialization_format", "ros1")
                message = _decoder(connection.msgtype, connection.msgdef, encoding)(raw)
                rows.setdefault(connection.topic, []).append((time, numbers(connection.topic, message)))
    return rows


def _table(path: Path, ros: int) -> Rows:
    """The rows of the table of messages as SQLite finds them in it, with what was committed in the log, by no index.

    Where it refuses, those that it gives before, from either end; one that does not decode is none.
    """
    each: dict[int, tuple[Any, int, bytes]] = {}
    with tempfile.TemporaryDirectory(dir=MEMORY) as folder:
        copy = Path(folder) / path.name
        shutil.copy(path, copy)
        if (log := path.with_name(path.name + "-wal")).exists():
            shutil.copy(log, copy.with_name(log.name))
        with closing(sqlite3.connect(copy)) as database:
            database.execute("PRAGMA synchronous = OFF")  # it is a copy
            database.execute("PRAGMA writable_schema = ON")  # else a file that was cut is refused
            topics = dict(database.execute("SELECT id, name FROM topics NOT INDEXED"))
            for order in ("", "DESC"):
                rows = database.execute(
                    f"SELECT rowid, topic_id, timestamp, data FROM messages NOT INDEXED ORDER BY rowid {order}"
                )
                with suppress(sqlite3.Error):
                    each.update((row, (topic, time, raw)) for row, topic, time, raw in rows)
    found: Rows = {}
    for topic, time, raw in each.values():
        if (name := topics.get(topic)) in TOPICS:
            with suppress(Exception):
                value = numbers(name, typestore(ros).deserialize_cdr(raw, TOPICS[name]))
                found.setdefault(name, []).append((time, value))
    return found


def _mcap(path: Path, ros: int) -> Rows:
    from mcap.reader import make_reader
    from rosbags.interfaces import MessageDefinition
    from rosbags.interfaces import MessageDefinitionFormat as Format
    from rosbags.typesys.msg import normalize_msgtype

    rows: Rows = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            if channel.topic in TOPICS:
                assert schema
                definition = MessageDefinition(Format.MSG, schema.data.decode())
                decode = _decoder(normalize_msgtype(schema.name), definition, channel.message_encoding)
                value = numbers(channel.topic, decode(message.data))
                rows.setdefault(channel.topic, []).append((message.log_time, value))
    return rows


def _one_by_one(path: Path, _: int) -> Rows:
    """The messages as the stepwise reader gives them, each decoded whole; raises ValueError where it says a loss."""
    rows: Rows = {}
    with open_source(path) as source:
        assert isinstance(source, Recording)
        there = [info.topic for info in source.topics() if info.topic in TOPICS]
        for time, topic, message in source.messages(there, 1 << 27):
            if message is not None:
                rows.setdefault(topic, []).append((time, numbers(topic, message)))
        if source.lost() or any("unreadable" in note for note in source.notes):
            raise ValueError(source.notes)
    return rows


PEERS: dict[str, Peers] = {
    ".mcap": (("mcap", _mcap), ("rosbags", _rosbags), ("one by one", _one_by_one)),
    ".bag": (("rosbags", _rosbags), ("one by one", _one_by_one)),
    ".db3": (("rosbags", _rosbags), ("one by one", _one_by_one)),
}
ALWAYS: dict[str, Peers] = {".db3": (("the table", _table),)}
"""Peers that every file is given to; the others are slow."""
