"""A live source whose topics have other names than where they are published."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping

from robophm.core.signal import CLOCK, Sample, WantedSignal, split_signal, wanted_unit
from robophm.transports.signals.source import LiveItem, LiveSource, Untimed


class RenamedSource(LiveSource):
    """Gives what another source does, by names that mean whole names of topics there. Closing it closes the source."""

    def __init__(self, source: LiveSource, whole: Callable[[str], str]) -> None:
        """``whole`` returns the topic that a name means."""
        self._source, self._whole = source, whole
        self.fingerprint = source.fingerprint
        self.announced, self.recorded, self.task_topics = source.announced, source.recorded, source.task_topics

    @property
    def notes(self) -> Counter[str]:  # type: ignore[override]  # the source begins new ones when it is listened to
        """Return the notes of the source, by the whole names of topics."""
        return self._source.notes

    @property
    def place(self) -> str:
        """Return where it listens."""
        return self._source.place

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        return self._source.hidden_by()

    def listen(self, signals: Collection[str], topics: Collection[str]) -> Iterator[LiveItem]:
        """Yield what the source gives, by the names that were asked for. Raises SourceError, by whole names."""
        self._source.known_to = self.known_to
        asked: dict[str, list[str]] = {CLOCK: [CLOCK]}
        whole: dict[str, list[str]] = {}
        for topic in topics:
            whole.setdefault(self._whole(topic), []).append(topic)
        for signal in signals:
            if signal != CLOCK:
                topic, field = split_signal(signal)
                meant = WantedSignal(f"{self._whole(topic)}.{self._meant(topic, field)}", wanted_unit(signal))
                asked.setdefault(meant, []).append(signal)
                whole.setdefault(self._whole(topic), [topic])  # where what is missing of it is told
        wanted = [signal for signal in asked if signal != CLOCK]
        heard = self._source.listen(wanted, [self._whole(topic) for topic in topics])
        if all([name] == names for name, names in (*asked.items(), *whole.items())):
            return heard  # each by its own name: nothing is made of every sample anew
        return _by_names(heard, asked, whole)

    def _meant(self, topic: str, field: str) -> str:
        """The field that a field of a topic means."""
        return field

    def stop(self) -> None:
        """End ``listen`` once all that has come so far has been taken."""
        self._source.stop()

    def close(self) -> None:
        """Close the source."""
        self._source.close()


def _by_names(
    heard: Iterator[LiveItem], signals: Mapping[str, list[str]], topics: Mapping[str, list[str]]
) -> Iterator[LiveItem]:
    for one in heard:
        if isinstance(one, Sample):
            for signal in signals.get(one.signal, ()):
                yield Sample(one.time, signal, one.value)
        elif isinstance(one, Untimed):
            yield one
        else:
            for topic in topics.get(one.topic, (one.topic,)):
                yield one._replace(topic=topic)
