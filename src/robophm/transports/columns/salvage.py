"""What can be read of a damaged recording: the messages that are whole, with notes of what is lost."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack, closing
from pathlib import Path

import numpy as np

from robophm.core.errors import SourceError
from robophm.core.signal import Sample
from robophm.transports.columns.columns import by_signal, opened, read_columns
from robophm.transports.columns.pieces import MOST_TIME
from robophm.transports.message_type import fields_of
from robophm.transports.source import Heard, SignalSource, TopicInfo


class Salvage(SignalSource):
    """One drive whose files readers of their format refuse, as one that was cut when the robot lost its power.

    ``damage`` is why they do. Raises SourceError where a file is missing or no recording, or no message can be found.
    """

    def __init__(self, *paths: str | Path, damage: str) -> None:
        self._paths = paths
        self._damage = damage
        self.notes = Counter()
        with ExitStack() as stack:
            files = opened(paths, self.notes, stack)
            begin = min(file.begin() for file in files)
            topics: dict[str, TopicInfo] = {}
            for connection in (connection for file in files for connection in file.connections):
                topic = connection.topic
                count = connection.msgcount + (topics[topic].messages if topic in topics else 0)
                topics[topic] = TopicInfo(topic, connection.msgtype, count, begin, None, fields_of(connection))
            self.fingerprint = hashlib.sha256("".join(sorted(file.fingerprint for file in files)).encode()).hexdigest()
        if begin == MOST_TIME or not topics:
            raise SourceError(f"{', '.join(map(str, paths))}: nothing in it can be read")
        self._topics = [topics[topic] for topic in sorted(topics)]

    def topics(self) -> list[TopicInfo]:
        """What there is to ask for. When a topic begins and ends is not known, and messages may be lost."""
        return list(self._topics)

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, Heard]]:
        """The samples of these signals that are whole."""
        with closing(read_columns(self._paths, signals, since or None)) as columns:
            self.notes = columns.notes
            self.notes[f"damaged, and read as far as it is whole: {self._damage}"] += 1
            yield from map(by_signal, columns)

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The same one by one, in order of receipt."""
        for block in self.columns(signals, 0):
            names = [*block]
            whose = np.repeat(np.arange(len(names)), [len(heard.times) for heard in block.values()])
            order = np.argsort(np.concatenate([heard.arrived for heard in block.values()]), kind="stable")
            times, values = (np.concatenate([heard[i] for heard in block.values()])[order].tolist() for i in (1, 2))
            for signal, time, value in zip(whose[order].tolist(), times, values, strict=True):
                yield Sample(time, names[signal], value)
