"""Tables of ``ros2 topic echo --csv``, behind a line that says of which type the messages are, and of which topic.

::

    sensor_msgs/msg/BatteryState,/battery
    1709553600,250000000,base_link,25.9,31.0,-2.0,5.0,9.0,10.0,0.5,2,1,2,True,4.2,4.1,30.5,slot,7

The program writes the fields of a message one after the other and neither their names nor how long an array is. So an
array of any length is read where a message has one such alone; with two of them what is before the first and behind
the last is read. Time is that of the header, without which messages have none.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, is_topic
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.rows import MOST_COLUMNS, RowSource
from robophm.transports.signals.message_type import MessageType, field_parts, message_type
from robophm.transports.signals.source import TopicInfo

_HEADING = re.compile(rb"(\xef\xbb\xbf)?[A-Za-z]\w*/msg/[A-Za-z]\w*[ \t]*(,[^,\r\n]*)?\r?\n")
_STAMP = ("header.stamp.sec", "header.stamp.nanosec")
_CUT = "..."
"""The cell behind an array of which the program writes the first elements alone."""
_SAYS = re.compile(r"A message was lost!!!|\s*total count")
"""Beginnings of lines in which the program tells of lost messages."""


_INTEGER, _FLOAT = re.compile(r"-?\d+"), re.compile(r"-?(\d+\.\d*(e[+-]?\d+)?|\d+e[+-]?\d+|nan|inf)")
_WRITTEN = {"bool": re.compile("True|False"), "float32": _FLOAT, "float64": _FLOAT, "char": _INTEGER}
_WRITTEN |= {f"{sign}int{bits}": _INTEGER for sign in ("", "u") for bits in (8, 16, 32, 64)}
"""How Python writes numbers of each type, by which a text that has a comma, and so moves what follows, is told."""


class Leaf(NamedTuple):
    """A field that is no message; ``[]`` in its path stands for the index in an array of any length."""

    path: str
    type: str


class _Row(NamedTuple):
    """The fields of a message before its first array of any length, that array, and those behind its last one."""

    before: tuple[Leaf, ...]
    each: tuple[Leaf, ...]
    """The fields of an element of the array, with ``[]``; none where there is no such array, or more than one."""
    behind: tuple[Leaf, ...]
    exact: bool
    """Whether there is no array of any length."""


class EchoedTopic(RowSource):
    """Messages of one topic as ``ros2 topic echo --csv`` prints them, a line each.

    Raises SourceError, with line, where they are not of the type that the first line says, or have no header.
    """

    def _signals(self) -> frozenset[str]:
        with_type = next(self._texts(), "").strip().split(",")
        self._type = with_type[0].strip()
        self._topic = with_type[1].strip() if len(with_type) > 1 else "/" + re.sub(r"[.\s]", "_", self.path.stem)
        if not is_topic(self._topic):
            raise SourceError(f"{self.path}, line 1: '{self._topic}' is not a topic; expected e.g. '/battery'")
        try:
            leaves = leaves_of(_type_of(self._topic, self._type))
        except SourceError as error:
            raise SourceError(f"{self.path}, line 1: {error}") from None
        if [leaf.path for leaf in leaves[:2]] != [*_STAMP]:
            says = (
                f"messages of {self._type} do not begin with a header, so that `ros2 topic echo --csv` writes no time"
            )
            raise SourceError(f"{self.path}: {says}; expected a recording of them, `ros2 bag record {self._topic}`")
        self._row = _row_of(leaves)
        columns: set[str] = set()
        for _, row in self._values():
            columns |= row.keys()
            if len(columns) > MOST_COLUMNS:
                raise SourceError(f"{self.path}: over {MOST_COLUMNS} numbers in a message; no more are read")
        if not columns:
            raise SourceError(f"{self.path}: holds no values")
        self._columns = sorted(columns)
        return frozenset(columns)

    def topics(self) -> list[TopicInfo]:
        """Return the topic as of every text, with the type of its messages."""
        return [replace(info, type=self._type) for info in super().topics()]

    def _values(self) -> Iterator[tuple[int, dict[str, float]]]:
        lines = enumerate(self._texts(), 1)
        next(lines)
        previous: int | None = None
        if not self._row.exact and not self._row.each:
            self.notes[f"{self._topic}: arrays left out, of which nothing says where one ends and the next begins"] += 1
        for line, text in lines:
            if _SAYS.match(text):
                self.notes[f"{self._topic}: lost by the subscriber, as `ros2 topic echo` says"] += "lost" in text
                continue
            if not text.strip():
                continue
            row = self._read(line, text.rstrip("\r\n").split(","))
            time = int(row.pop(_STAMP[0])) * SECOND + int(row.pop(_STAMP[1]))
            self._in_order(line, previous, time)
            previous = time
            yield time, {f"{self._topic}.{path}": row[path] for path in sorted(row)}

    def _read(self, line: int, cells: Sequence[str]) -> dict[str, float]:
        """The numbers of a line by their fields."""
        before, each, behind, exact = self._row
        known = len(before) + len(behind)
        between = len(cells) - known
        whole = between == 0 if exact else between >= 1
        if not whole:
            expected = f"{known} of {self._type}" if exact else f"at least {known + 1} of {self._type}"
            raise SourceError(f"{self.path}, line {line}: {len(cells)} cells; expected {expected}, each array in full")
        found = [*zip(before, cells, strict=False), *zip(behind, cells[len(cells) - len(behind) :], strict=True)]
        middle = cells[len(before) : len(before) + between]
        if middle and middle[-1] == _CUT:
            self.notes[f"{self._topic}: arrays cut by `ros2 topic echo`; `--full-length` has it write all"] += 1
            middle = middle[:-1]
        if each and middle != [""]:  # nothing but a comma, where it is empty
            if len(middle) % len(each):
                raise SourceError(
                    f"{self.path}, line {line}: {len(middle)} cells of the array '{each[0].path.partition('[')[0]}'; "
                    f"expected {len(each)} for each element"
                )
            found += zip(_elements(each, len(middle) // len(each)), middle, strict=True)
        row = {}
        for leaf, cell in found:
            if leaf.type not in _WRITTEN:
                continue
            if not _WRITTEN[leaf.type].fullmatch(cell):
                says = f"'{cell[:60]}' is no {leaf.type}, as '{leaf.path}' of {self._type} is"
                raise SourceError(f"{self.path}, line {line}: {says}; expected no text with a comma before it")
            row[leaf.path] = float({"True": "1", "False": "0"}.get(cell, cell))
        return row


def _type_of(topic: str, name: str) -> MessageType:
    """A type of ROS 2 by its name, as of a recording without definitions. Raises SourceError."""
    from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat

    unknown = MessageDefinition(MessageDefinitionFormat.NONE, "")
    return message_type(Connection(0, topic, name, unknown, "", 0, ConnectionExtRosbag2("cdr", []), None))


def leaves_of(type_: MessageType) -> list[Leaf]:
    """The fields of a message in order, those of messages in it and of each element of an array too."""

    def within(name: str, prefix: str) -> Iterator[Leaf]:
        for field, _, part, length in field_parts(type_.definitions, name):
            ends = ("",) if length is None else ("[]",) if not length else (f"[{one}]" for one in range(length))
            for end in ends:
                if part in type_.definitions:
                    yield from within(part, f"{prefix}{field}{end}.")
                else:
                    yield Leaf(f"{prefix}{field}{end}", part)

    return [*within(type_.name, "")]


@lru_cache(maxsize=16)
def _elements(each: tuple[Leaf, ...], count: int) -> tuple[Leaf, ...]:
    """The fields of so many elements of an array, of which ``each`` has ``[]``."""
    return tuple(
        leaf._replace(path=leaf.path.replace("[]", f"[{number}]", 1)) for number in range(count) for leaf in each
    )


def _row_of(leaves: Sequence[Leaf]) -> _Row:
    """The row that these fields make, of which those with ``[]`` are of arrays of any length."""
    arrays = [number for number, leaf in enumerate(leaves) if "[]" in leaf.path]
    if not arrays:
        return _Row(tuple(leaves), (), (), True)
    inner = leaves[arrays[0] : arrays[-1] + 1]
    names = {leaf.path.partition("[]")[0] for leaf in inner}
    alone = len(names) == 1 and all(leaf.path.count("[]") == 1 for leaf in inner)
    return _Row(tuple(leaves[: arrays[0]]), tuple(inner) if alone else (), tuple(leaves[arrays[-1] + 1 :]), False)


FORMAT = SampleFormat((), lambda head: _HEADING.match(head) is not None, EchoedTopic, in_folders=False)
