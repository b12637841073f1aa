"""Transport ``recording``: what ``rosbag record`` and ``ros2 bag record`` write, and MCAP from elsewhere.

ROS 1 ``.bag`` and ROS 2 ``.db3`` and ``.mcap``: single files, rosbag2 folders, split and compressed ones.
Read through rosbags; an MCAP file without the ROS 2 profile, as foxglove-sdk writes it, through mcap.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass
from functools import cached_property
from heapq import merge
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import SECOND, Sample, split_signal
from robophm.transports.message_type import field_getter, fields_of, message_type
from robophm.transports.source import Heard, SignalSource, TopicInfo, existing, reading

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

STAMP_LIMIT = 10 * SECOND
"""How far [ns] a header stamp may be from receipt and still be believed."""

SUFFIXES = (".bag", ".db3", ".mcap")
"""Suffixes of the files that are read."""

_EDGE = 64 * 1024


class EmptyError(SourceError):
    """A recording that has no message."""


class Recording(SignalSource):
    """One drive: any number of files and folders, merged in order of receipt; a context manager.

    A sample's time is the message's header stamp, or its receipt where there is no header, or the stamp is
    zero or more than STAMP_LIMIT from receipt. ``notes`` counts those, and messages that do not decode.

    Raises SourceError where a file is missing, not a recording, damaged, given twice, or all are empty.
    """

    def __init__(self, *paths: str | Path) -> None:
        self.notes = Counter()
        self._paths = paths
        self._files: list[_File] = []
        with ExitStack() as opened:
            for path in (part for given in paths for part in parts_of(existing(Path(given)))):
                file = _File(path)
                opened.callback(file.close)
                self._files.append(file)
            self._files.sort(key=lambda file: (file.reader.start_time, file.fingerprint))
            for one, other in zip(self._files, self._files[1:], strict=False):
                if one.fingerprint == other.fingerprint and one.reader.message_count:
                    raise SourceError(f"{one.path} and {other.path} are the same recording; expected it once")
            if not sum(file.reader.message_count for file in self._files):
                raise EmptyError(f"{', '.join(map(str, paths)) or 'no file'}: holds no messages")
            self._opened = opened.pop_all()
        self._name = str(self._files[0].path) + (" …" if len(self._files) > 1 else "")
        digests = "".join(sorted(file.fingerprint for file in self._files))
        self.fingerprint = hashlib.sha256(digests.encode()).hexdigest()

    def close(self) -> None:
        """Close all files; closing twice does no harm."""
        self._opened.close()
        self._files.clear()

    def topics(self) -> list[TopicInfo]:
        """What there is to ask for. ``fields`` is empty where the messages cannot be decoded."""
        return list(self._topics)

    def spans(self) -> list[tuple[int, int]]:
        """When each file began and ended, of those that hold messages; a reader's end is a nanosecond too late."""
        return [(file.reader.start_time, file.reader.end_time - 1) for file in self._files if file.reader.message_count]

    @cached_property
    def _topics(self) -> list[TopicInfo]:
        found: dict[str, TopicInfo] = {}
        for file in self._files:
            spans = file.spans()
            for connection in file.connections:
                first, last = spans.get(connection.id, (None, None))
                fields = fields_of(connection)
                info = TopicInfo(connection.topic, connection.msgtype, connection.msgcount, first, last, fields)
                before = found.get(info.topic)
                found[info.topic] = _joined(before, info) if before else info
        return [found[topic] for topic in sorted(found)]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals, in receipt order; raises SourceError as the interface says."""
        wanted: dict[str, list[tuple[str, str]]] = {}
        for signal in sorted(set(signals)):
            topic, field = split_signal(signal)
            wanted.setdefault(topic, []).append((signal, field))
        return self._samples(self._raw(wanted))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, Heard]]:
        """The samples of these signals, straight from the files; what of a file is damaged is in the notes."""
        from robophm.transports.columns.columns import by_signal, read_columns  # which ask here what a recording is

        with closing(read_columns(self._paths, signals, since or None)) as columns:
            self.notes = columns.notes
            yield from map(by_signal, columns)

    def messages(self, topics: Collection[str], longest: int) -> Iterator[tuple[int, str, Any]]:
        """Receipt time [ns], topic and message, as rosbags decodes it, of these topics, in receipt order.

        In place of a message that does not decode, or is more than ``longest`` bytes long, comes None.

        Raises SourceError where a topic is not in the recording, and on the way where it is damaged.
        """
        return self._messages(self._raw({topic: [] for topic in topics}), longest)

    def _messages(
        self, messages: Iterable[tuple[int, _Reading, bytes]], longest: int
    ) -> Iterator[tuple[int, str, Any]]:
        for receipt, reading_, raw in messages:
            if len(raw) > longest:
                self.notes[f"message on {reading_.topic} longer than {longest} bytes"] += 1
                yield receipt, reading_.topic, None
            else:
                yield receipt, reading_.topic, self._decoded(reading_, raw)

    def _decoded(self, reading_: _Reading, raw: bytes) -> Any:
        """The message, or None where it cannot be decoded."""
        try:
            return reading_.decode(raw)
        except Exception:  # rosbags lets struct, NumPy and memory errors of damaged messages through
            self.notes[f"unreadable message on {reading_.topic}"] += 1
            return None

    def _raw(self, wanted: Mapping[str, list[tuple[str, str]]]) -> Iterator[tuple[int, _Reading, bytes]]:
        """The messages of these topics, in receipt order, and how they become samples."""
        known = {connection.topic for file in self._files for connection in file.connections}
        for topic in wanted:
            if topic not in known:
                name = self._name if self._files else "closed recording"
                raise SourceError(f"{name}: no topic '{topic}'{nearest(topic, known)}")
        self.notes.clear()
        streams = [file.messages(file.readings(wanted, self.notes)) for file in self._files]
        # merge() looks at every message; one file is in order already
        return streams[0] if len(streams) == 1 else merge(*streams, key=itemgetter(0))

    def _samples(self, messages: Iterable[tuple[int, _Reading, bytes]]) -> Iterator[Sample]:
        notes = self.notes
        latest = 0
        for receipt, reading_, raw in messages:
            message = self._decoded(reading_, raw)
            if message is None:
                continue
            if receipt < latest:
                notes[f"receipt time goes backwards on {reading_.topic}"] += 1
            latest = receipt
            time = 0
            if reading_.stamp:
                seconds, nanoseconds = reading_.stamp(message)
                time = seconds * SECOND + nanoseconds
            if time == 0 or abs(time - receipt) > STAMP_LIMIT:
                notes[f"receipt time used for {reading_.topic}"] += 1
                time = receipt
            for signal, value_of in reading_.values:
                try:
                    value = float(value_of(message))
                except IndexError:
                    notes[f"no element for {signal}"] += 1
                else:
                    yield Sample(time, signal, value)


class _Reader(Protocol):
    """What the readers of rosbags have in common."""

    @property
    def connections(self) -> list[Connection]: ...
    @property
    def message_count(self) -> int: ...
    @property
    def start_time(self) -> int: ...
    @property
    def end_time(self) -> int: ...
    def open(self) -> None: ...
    def close(self) -> None: ...
    def messages(
        self, connections: Collection[Connection] = (), start: int | None = None, stop: int | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]: ...


@dataclass(frozen=True)
class _Reading:
    """How the messages of one connection become samples."""

    topic: str
    decode: Callable[[bytes], Any]
    stamp: Callable[[Any], tuple[int, int]] | None
    values: list[tuple[str, Callable[[Any], Any]]]


class _File:
    """One opened file, or one rosbag2 folder."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with reading(path):
            self.fingerprint = fingerprint_of(path)
            self.reader = open_reader(path)
            self.connections = list(self.reader.connections)

    def close(self) -> None:
        self.reader.close()

    def readings(self, wanted: Mapping[str, list[tuple[str, str]]], notes: Counter[str]) -> dict[int, _Reading]:
        """What to read of each connection that carries a wanted topic."""
        readings = {}
        for connection in self.connections:
            if connection.topic in wanted:
                with reading(self.path):
                    type_ = message_type(connection)
                    if type_.borrowed:
                        notes[f"definition of {type_.name} taken from ROS 2 Humble"] += 1
                    values = []
                    for signal, field in wanted[connection.topic]:
                        try:
                            values.append((signal, field_getter(type_.definitions, type_.name, field)))
                        except SourceError as error:
                            raise SourceError(f"{self.path}: topic '{connection.topic}' {error}") from None
                readings[connection.id] = _Reading(connection.topic, type_.decode, type_.stamp, values)
        return readings

    def messages(self, readings: Mapping[int, _Reading]) -> Iterator[tuple[int, _Reading, bytes]]:
        """Receipt time, reading and bytes of the messages to read."""
        with reading(self.path):
            connections = [connection for connection in self.connections if connection.id in readings]
            if connections:
                for connection, receipt, raw in self.reader.messages(connections):
                    yield receipt, readings[connection.id], raw

    def spans(self) -> dict[int, tuple[int, int]]:
        """First and last receipt time of every connection that has messages.

        Looked for from both ends in windows that widen, so that the middle of a long file is not read.
        """
        first: dict[int, int] = {}
        last: dict[int, int] = {}
        used = [connection for connection in self.connections if connection.msgcount]
        begin, end = self.reader.start_time, self.reader.end_time
        window = SECOND
        with reading(self.path):
            while used:
                if missing := [connection for connection in used if connection.id not in first]:
                    for connection, receipt, _ in self.reader.messages(missing, stop=begin + window):
                        first.setdefault(connection.id, receipt)
                if missing := [connection for connection in used if connection.id not in last]:
                    last |= {c.id: t for c, t, _ in self.reader.messages(missing, start=end - window)}
                if len(first) == len(last) == len(used) or window > end - begin:
                    break
                window *= 16
        return {id_: (first[id_], last[id_]) for id_ in first.keys() & last.keys()}


class _ForeignMcap:
    """An MCAP file without the ROS 2 profile, read through mcap, in the words of rosbags' readers."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.connections: list[Connection] = []
        self.message_count = self.start_time = self.end_time = 0

    def open(self) -> None:
        from mcap.reader import make_reader
        from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition
        from rosbags.interfaces import MessageDefinitionFormat as Format
        from rosbags.typesys.msg import normalize_msgtype

        formats = {"ros1msg": Format.MSG, "ros2msg": Format.MSG, "ros2idl": Format.IDL, "omgidl": Format.IDL}
        self._file = self._path.open("rb")
        try:
            self._reader = make_reader(self._file, validate_crcs=True)
            summary = self._reader.get_summary()
            if summary is None or summary.statistics is None:
                raise SourceError(f"{self._path}: has no summary section; expected one, as `mcap recover` writes")
            statistics = summary.statistics
            self.message_count = statistics.message_count
            self.start_time = statistics.message_start_time
            self.end_time = statistics.message_end_time + 1
            for channel in summary.channels.values():
                schema = summary.schemas.get(channel.schema_id)
                format_ = formats.get(schema.encoding, Format.NONE) if schema else Format.NONE
                self.connections.append(
                    Connection(
                        channel.id,
                        channel.topic,
                        normalize_msgtype(schema.name) if schema and format_ is not Format.NONE else "",
                        MessageDefinition(format_, schema.data.decode() if schema and format_.value else ""),
                        "",
                        statistics.channel_message_counts.get(channel.id, 0),
                        ConnectionExtRosbag2(channel.message_encoding, []),
                        self,
                    )
                )
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._file.close()

    def messages(
        self, connections: Collection[Connection] = (), start: int | None = None, stop: int | None = None
    ) -> Iterator[tuple[Connection, int, bytes]]:
        wanted = {connection.id: connection for connection in connections}
        topics = {connection.topic for connection in connections}
        for _, channel, message in self._reader.iter_messages(topics=topics):
            if stop is not None and message.log_time >= stop:
                return
            if channel.id in wanted and (start is None or message.log_time >= start):
                yield wanted[channel.id], message.log_time, message.data


def parts_of(path: Path) -> list[Path]:
    """The files to open: a rosbag2 folder is opened as one, a folder without its metadata file by file."""
    if not path.is_dir():
        if path.suffix not in SUFFIXES:
            raise SourceError(f"{path}: not a recording; expected {', '.join(SUFFIXES)} or a folder with metadata.yaml")
        return [path]
    if (path / "metadata.yaml").exists():
        return [path]
    parts = sorted(
        part
        for part in path.iterdir()
        if (part.suffix in SUFFIXES and part.is_file()) or (part / "metadata.yaml").is_file()
    )
    if not parts:
        raise SourceError(f"{path}: holds no recording; expected metadata.yaml or {', '.join(SUFFIXES)} files")
    return parts


def open_reader(path: Path) -> _Reader:
    """The reader of a file or rosbag2 folder, opened."""
    from rosbags.rosbag1 import Reader as BagReader
    from rosbags.rosbag2 import Reader as Rosbag2Reader

    for database in path.glob("*.db3") if path.is_dir() else [path] * (path.suffix == ".db3"):
        check_whole(database)
    reader: _Reader
    if path.suffix == ".bag" and not path.is_dir():
        reader = cast(_Reader, BagReader(path))
    elif path.suffix == ".mcap" and not path.is_dir() and _profile(path) != "ros2":
        reader = _ForeignMcap(path)
    else:
        reader = cast(_Reader, Rosbag2Reader(path))
    reader.open()
    return reader


def check_whole(path: Path) -> None:
    """SQLite opens a database that was cut or not closed, and passes over what is missing: refuse it here."""
    unsaved = path.with_name(path.name + "-wal")
    if unsaved.exists() and unsaved.stat().st_size:
        raise SourceError(f"{unsaved}: holds messages that the recorder did not save; expected a closed one")
    page, pages = pages_of(path)
    if path.stat().st_size < page * pages:
        raise SourceError(f"{path}: is cut short: {path.stat().st_size} bytes; expected {page * pages}")


def pages_of(path: Path) -> tuple[int, int]:
    """Bytes of a page of an SQLite file, and how many it says to have: sqlite.org/fileformat2.html, bytes 16 and 28."""
    with path.open("rb") as file:
        head = file.read(100)
    page = int.from_bytes(head[16:18], "big")
    return 65536 if page == 1 else page, int.from_bytes(head[28:32], "big")


def _profile(path: Path) -> str:
    from mcap.reader import make_reader

    with path.open("rb") as file:
        return str(make_reader(file).get_header().profile)


def fingerprint_of(path: Path) -> str:
    """Digest of the size and the first, middle and last 64 KiB of each file of messages, names left out."""
    files = [path]
    if path.is_dir():
        files = [part for part in path.iterdir() if part.suffix in (".db3", ".mcap", ".zstd")]
    digests = []
    for each in files:
        size = each.stat().st_size
        digest = hashlib.sha256(str(size).encode())
        with each.open("rb") as file:
            for offset in (0, size // 2, size - _EDGE):
                file.seek(max(0, offset))
                digest.update(file.read(_EDGE))
        digests.append(digest.hexdigest())
    return hashlib.sha256("".join(sorted(digests)).encode()).hexdigest()


def _joined(one: TopicInfo, other: TopicInfo) -> TopicInfo:
    """Two parts of one topic, from two publishers or two files."""
    starts = [time for time in (one.first, other.first) if time is not None]
    ends = [time for time in (one.last, other.last) if time is not None]
    return TopicInfo(
        one.topic,
        one.type,
        one.messages + other.messages,
        min(starts, default=None),
        max(ends, default=None),
        tuple(dict.fromkeys(one.fields + other.fields)),
    )
