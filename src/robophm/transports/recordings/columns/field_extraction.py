"""Many messages of one type walked side by side: each step is one NumPy operation over all of them.

A message is bytes of a shared buffer. The steps of its type lead past its strings and sequences, whose lengths are
gathered from every message at once, to the numbers that are wanted. What does not fit into its message is left out
and named, so that nothing is ever read outside a message.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

LONGEST_LOOP = 1000
"""Elements of varying size in one sequence, beyond which a message is better decoded by itself."""

MOST_ORDERS = 16
"""Different labels in a batch, beyond which those of each message are read."""

MOST_ATTEMPTS = 20
"""Walks through a batch, each without the messages that did not fit in the one before."""

Ints = NDArray[np.int64]
Bytes = NDArray[np.uint8]


class Step(ABC):
    """One step on the way through a message; ``skip`` bytes of fixed size come before it."""

    skip: int

    @abstractmethod
    def walk(self, at: Position) -> None:
        """Take this step in all messages at once. Raises DoubtfulError where some do not fit."""


@dataclass(frozen=True)
class Take(Step):
    """A step to a number that is wanted; the position stays."""

    skip: int
    slot: int
    type: str
    """Type of the number as NumPy spells it, without the byte order."""

    def walk(self, at: Position) -> None:
        """Note where the wanted number lies in each message."""
        at.taken.append((self, at.rows, at.origin + (at.offset + self.skip)))


@dataclass(frozen=True)
class Align(Step):
    """A step over padding to a multiple of ``to`` bytes from the origin."""

    skip: int
    to: int

    def walk(self, at: Position) -> None:
        """Go on to the next multiple of ``to`` bytes."""
        at.offset = (at.offset + (self.skip + self.to - 1)) & -self.to


@dataclass(frozen=True)
class Text(Step):
    """A step over a string: its length and its bytes, in CDR with a zero at the end that counts."""

    skip: int
    terminated: bool

    def walk(self, at: Position) -> None:
        """Go on behind the string."""
        length = at.length(self.skip)
        at.offset = at.offset + length
        at.expect(at.offset <= at.limit)
        if self.terminated:
            at.expect(length > 0)
            at.expect(at.buffer[at.origin + (at.offset - 1)] == 0)


@dataclass(frozen=True)
class Labels(Step):
    """A sequence of strings that name the elements of another, as the joints of a JointState.

    As a rule all messages have the same: those are found at once, and a string is read in one message of many.
    """

    skip: int
    terminated: bool

    def walk(self, at: Position) -> None:
        """Go on behind the sequence, and note which names each message has."""
        count = at.length(self.skip)
        offset = np.broadcast_to(at.offset, at.origin.shape)
        ids, behind = np.full(len(at.rows), -1), np.empty(len(at.rows), np.int64)
        left, bad = np.arange(len(at.rows)), list[int]()
        known: dict[tuple[str, ...], int] = {}
        while len(left):
            row = int(left[0])
            try:
                names, texts, size = self._read(at, row, int(count[row]), int(offset[row]))
            except DoubtfulError:
                bad.append(row)
                left = left[1:]
                continue
            alike = left[:1]
            if len(known) < MOST_ORDERS:
                alike = left[(count[left] == len(names)) & (offset[left] + size <= at.limit[left])]
                for start, length in texts:
                    alike = alike[_same(at.buffer, at.origin[alike] + offset[alike] + start, length)]
            ids[alike] = known.setdefault((*names,), len(at.labels))
            if ids[row] == len(at.labels):
                at.labels.append(names)
            behind[alike] = offset[alike] + size
            left = left[1:] if len(alike) == 1 else left[ids[left] < 0]
        if bad:
            raise DoubtfulError(at.rows[bad])
        at.ids = ids
        at.offset = int(behind[0]) if len(behind) and (behind == behind[0]).all() else behind

    def _read(self, at: Position, row: int, count: int, offset: int) -> tuple[list[str], list[tuple[int, int]], int]:
        """The strings of one message, where in the sequence each lies with its length, and the bytes of all."""
        begin, here = int(at.origin[row]) + offset, 0
        limit = int(at.limit[row]) - offset
        names: list[str] = []
        texts = []
        for _ in range(count):
            here += -(offset + here) % 4 if self.terminated else 0
            length = int(at.lengths[begin + here]) if here + 4 <= limit else limit
            content = at.buffer[begin + here + 4 : begin + here + 4 + length].tobytes()
            if here + 4 + length > limit or (self.terminated and content[-1:] != b"\0"):
                raise DoubtfulError(at.rows[[row]])
            try:
                names.append(content[: length - self.terminated].decode())
            except UnicodeDecodeError:
                raise DoubtfulError(at.rows[[row]]) from None
            texts.append((here, 4 + length))
            here += 4 + length
        return names, texts, here


def _same(buffer: Bytes, starts: Ints, length: int) -> NDArray[np.bool_]:
    """Whether each run of bytes, at least four long, is the same as the first."""
    size = 8 if length >= 8 else 4
    words = everywhere(buffer, f"u{size}")
    same = np.ones(len(starts), np.bool_)
    for start in (*range(0, length - size, size), length - size):
        here = words[starts + start]
        same &= here == here[0]
    return same


@dataclass(frozen=True)
class Elements(Step):
    """A sequence whose elements all take ``size`` bytes; some numbers in some of them may be wanted."""

    skip: int
    size: int
    align: int
    wanted: Mapping[int, Sequence[Step]]
    by_name: Mapping[str, Sequence[Step]] = field(default_factory=dict)
    labelled: int | None = None
    """The mark to set to which labels name its elements, in messages in which they do."""

    def walk(self, at: Position) -> None:
        """Go on behind the sequence, with the steps of its wanted elements."""
        count = at.length(self.skip)
        start: int | Ints = at.offset
        if self.align > 4:  # the length before it is aligned to 4; no element, no padding
            start = np.where(count > 0, (start + (self.align - 1)) & -self.align, start)
        at.offset = start + count * self.size
        at.expect(at.offset <= at.limit)
        for index, steps in self.wanted.items():
            rows = np.flatnonzero(count > index)
            if len(rows):
                some = at.part(rows, start + index * self.size)
                for step in steps:
                    step.walk(some)
        if self.labelled is None:
            return
        many = np.array([len(names) for names in at.labels])
        ids = np.where(many[at.ids] == count, at.ids, -1) if len(many) else at.ids
        at.marks.append((self.labelled, at.rows, ids))
        for name, steps in self.by_name.items():
            place = np.array([names.index(name) if name in names else -1 for names in at.labels] or [-1])[ids]
            rows = np.flatnonzero((ids >= 0) & (place >= 0))
            if len(rows):
                some = at.part(rows, start + place * self.size)
                for step in steps:
                    step.walk(some)


@dataclass(frozen=True)
class Loop(Step):
    """A sequence whose elements take as many bytes as is in them: element by element."""

    skip: int
    element: Sequence[Step]
    wanted: Mapping[int, Sequence[Step]]
    last: bool
    """Whether nothing behind the wanted elements is of interest."""

    def walk(self, at: Position) -> None:
        """Go behind the sequence, or the last wanted element."""
        count = at.length(self.skip)
        at.expect(count <= LONGEST_LOOP)
        offset = np.broadcast_to(at.offset, at.origin.shape).copy()
        longest = int(count.max(initial=0))
        for index in range(min(longest, max(self.wanted) + 1) if self.last else longest):
            rows = np.flatnonzero(count > index)
            some = at.part(rows, offset)
            for step in self.wanted.get(index, self.element):
                step.walk(some)
            offset[rows] = some.offset
        at.offset = offset


@dataclass(frozen=True)
class End(Step):
    """The end: all that was passed by must lie in the message, and where its end is known, it must be the message's."""

    skip: int
    slack: int | None
    """Bytes that may follow; None where more of the message does."""

    def walk(self, at: Position) -> None:
        """Check that each message ends here."""
        at.offset = at.offset + self.skip
        at.expect(at.offset <= at.limit)
        if self.slack is not None:
            at.expect(at.limit - at.offset <= self.slack)


class DoubtfulError(Exception):
    """Some messages are not as their type says; ``rows`` are their numbers in the batch."""

    def __init__(self, rows: Ints) -> None:
        super().__init__()
        self.rows = rows


@dataclass
class Position:
    """The place in each message of a batch at which its reading stands."""

    buffer: Bytes
    lengths: NDArray[np.uint32]
    """The buffer read as a length at every byte of it."""
    rows: Ints
    """Numbers of the messages."""
    origin: Ints
    """Begin of each message's fields in the buffer."""
    limit: Ints
    """Number of bytes of the fields."""
    offset: int | Ints
    """Bytes from the origin; one number as long as it is the same in all messages."""
    taken: list[tuple[Take, Ints, Ints]]
    labels: list[list[str]] = field(default_factory=list)
    """Labels that were found, each once."""
    ids: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    """Index of the labels that each message has."""
    marks: list[tuple[int, Ints, Ints]] = field(default_factory=list)

    def expect(self, true: NDArray[np.bool_]) -> None:
        """Raise DoubtfulError with the messages for which the condition does not hold."""
        if not true.all():
            raise DoubtfulError(self.rows[~true])

    def length(self, skip: int) -> Ints:
        """Return the length that comes after ``skip`` bytes; the position is then behind it."""
        here = self.offset + skip
        self.offset = here + 4
        self.expect(self.offset <= self.limit)
        lengths: Ints = self.lengths[self.origin + here].astype(np.int64)
        return lengths

    def part(self, rows: Ints, offset: int | Ints) -> Position:
        """Return the position in some of the messages, given by ``rows``, at another offset."""
        if len(rows) == len(self.rows):
            return Position(self.buffer, self.lengths, self.rows, self.origin, self.limit, offset, self.taken)
        if not isinstance(offset, int):
            offset = offset[rows]
        return Position(
            self.buffer, self.lengths, self.rows[rows], self.origin[rows], self.limit[rows], offset, self.taken
        )


@dataclass(frozen=True)
class Program:
    """The way to the wanted numbers of one type of message."""

    steps: Sequence[Step]
    types: Sequence[str]
    """Type of each wanted number, as NumPy spells it, ``f4``."""
    packed: bool
    marks: Sequence[str] = ()
    """Sequences whose elements are told by labels."""

    def run(self, buffer: Bytes, starts: Ints, ends: Ints) -> Numbers:
        """Return the wanted numbers of the messages that lie at ``starts`` to ``ends`` of the buffer."""
        count = len(starts)
        numbers = Numbers(
            [np.zeros(count, type_) for type_ in self.types],
            [np.zeros(count, np.bool_) for _ in self.types],
            np.zeros(count, np.bool_),
            [np.full(count, -1) for _ in self.marks],
        )
        if self.packed:
            self._run("<", buffer, np.arange(count), starts, ends - starts, numbers)
            return numbers
        rows = np.flatnonzero(ends - starts >= 4)
        head = everywhere(buffer, "<u2")[starts if len(rows) == count else starts[rows]]
        for order, mark in (("<", 0x100), (">", 0)):  # encapsulation: CDR, little-endian or big-endian
            this = head == mark
            if len(rows) == count and this.all():
                self._run(order, buffer, rows, starts + 4, ends - starts - 4, numbers)
                return numbers
            some = rows[this]
            self._run(order, buffer, some, starts[some] + 4, ends[some] - starts[some] - 4, numbers)
        numbers.doubtful[np.setdiff1d(np.arange(count), rows[(head == 0x100) | (head == 0)])] = True
        return numbers

    def _run(self, order: str, buffer: Bytes, rows: Ints, origin: Ints, limit: Ints, numbers: Numbers) -> None:
        for _ in range(MOST_ATTEMPTS):
            at = Position(buffer, everywhere(buffer, order + "u4"), rows, origin, limit, 0, [])
            at.labels = numbers.labels
            try:
                for step in self.steps:
                    step.walk(at)
            except DoubtfulError as error:
                numbers.doubtful[error.rows] = True
                kept = ~np.isin(rows, error.rows)
                rows, origin, limit = rows[kept], origin[kept], limit[kept]
            else:
                numbers.collect(order, buffer, rows, at.taken)
                for mark, found, ids in at.marks:
                    numbers.marks[mark][found] = ids
                return
        numbers.doubtful[rows] = True


@dataclass(frozen=True)
class Numbers:
    """The numbers found in a batch: of each slot its values, and in which messages it has none."""

    values: list[NDArray[Any]]
    absent: list[NDArray[np.bool_]]
    doubtful: NDArray[np.bool_]
    """Messages that are not as their type says: neither numbers nor absence hold for them."""
    marks: list[Ints] = field(default_factory=list)
    """Index of each message's labels, for each labelled sequence; −1 where there are not as many."""
    labels: list[list[str]] = field(default_factory=list)

    def collect(self, order: str, buffer: Bytes, rows: Ints, taken: Sequence[tuple[Take, Ints, Ints]]) -> None:
        """Gather the numbers of these messages from where they lie."""
        for absent in self.absent:
            absent[rows] = True
        for take, found, places in taken:
            here = slice(None) if len(found) == len(self.doubtful) else found
            self.values[take.slot][here] = everywhere(buffer, order + take.type)[places]
            self.absent[take.slot][here] = False


def everywhere(buffer: Bytes, type_: str) -> NDArray[Any]:
    """Return the buffer read as this type at every byte of it."""
    size = np.dtype(type_).itemsize
    return np.ndarray((max(0, len(buffer) - size + 1),), type_, buffer, strides=(1,))
