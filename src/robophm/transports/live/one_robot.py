"""One of several robots that share a system: its topics are those below its namespace, and are named from there."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import replace

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import CLOCK, Sample
from robophm.transports.signals.source import LiveItem, LiveSource, TopicInfo

_NAME = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*\Z", re.ASCII)


def namespace_of(robot: str) -> str:
    """Return the namespace of a robot, ``/amr_7`` for ``amr_7``. Raises SourceError where that can be none."""
    name = robot.strip("/")
    if not _NAME.match(name):
        raise SourceError(f"'{robot}' is not the namespace of a robot; expected e.g. amr_7")
    return f"/{name}"


class OneRobot(LiveSource):
    """A live source as one robot's own: of ``/amr_7/motor`` the topic ``/motor``. What is not below is not heard.

    Closing it closes the source. Raises SourceError where the name is no namespace.
    """

    def __init__(self, source: LiveSource, robot: str) -> None:
        self.root = namespace_of(robot)
        self._source = source
        self.fingerprint = source.fingerprint
        self.announced, self.task_topics = source.announced, source.task_topics

    @property
    def notes(self) -> Counter[str]:  # type: ignore[override]  # the source begins new ones when it is listened to
        """Return the notes of the source, by the whole names of topics."""
        return self._source.notes

    @property
    def place(self) -> str:
        """Return where it listens, and below what."""
        return f"{self._source.place}, below {self.root}"

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard: another name, which is told, or what hides any."""
        first = {info.topic.split("/")[1] for info in self._source.topics() if info.topic.count("/") > 1}
        if not first:
            return self._source.hidden_by()
        return [f"there are topics of others{nearest(self.root.strip('/'), sorted(first))}"]

    def topics(self) -> list[TopicInfo]:
        """Return the topics of the robot, named from its namespace."""
        below = f"{self.root}/"
        found = (info for info in self._source.topics() if info.topic.startswith(below))
        return [replace(info, topic=info.topic.removeprefix(self.root)) for info in found]

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield what the source gives below the namespace. Raises SourceError as the source does, by whole names."""
        self._source.known_to = self.known_to
        wanted = [f"{self.root}{signal}" for signal in signals if signal != CLOCK]
        return map(self._own, self._source.listen(wanted, [f"{self.root}{topic}" for topic in topics]))

    def _own(self, heard: LiveItem) -> LiveItem:
        if isinstance(heard, Sample):
            return heard._replace(signal=heard.signal.removeprefix(self.root))
        return heard._replace(topic=heard.topic.removeprefix(self.root))

    def stop(self) -> None:
        """End ``listen`` once all that has come so far has been taken."""
        self._source.stop()

    def close(self) -> None:
        """Close the source."""
        self._source.close()
