"""The log of one robot's alarms, as a store keeps it: begin, end, cause, and by whom it was acknowledged."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from robophm.stores.events import Event, events_of_alarms, latest_events

MOST_ALARMS = 10_000
"""The most alarms that are kept of a robot; of more the oldest that have ended are forgotten."""

ACKNOWLEDGED = ("acknowledged_by", "acknowledged_at")
"""Names of what a person says of an alarm; what is kept of it later never changes it."""


class AlarmLog(ABC):
    """Alarms as plain values, each told from the others by ``what`` it is and when it ``begin``s [ns since the epoch].

    What is kept is there at once, and after a crash; people acknowledge from elsewhere while it is written.
    """

    @abstractmethod
    def alarms(self, *, open_only: bool = False, most: int = MOST_ALARMS) -> list[dict[str, Any]]:
        """Return alarms, the latest first, each with its ``number``; those alone that go on where ``open_only``.

        Raises StoreError where they cannot be read.
        """

    @abstractmethod
    def keep(self, alarms: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Keep alarms that have begun, ended or changed; return them with their numbers. Raises StoreError."""

    @abstractmethod
    def acknowledge(self, number: int, by: str, time: int) -> bool:
        """Note who has taken note of an alarm, and when [ns]; say whether there is one of this number.

        Who did it first stays. Raises StoreError.
        """

    def events(self, start: int, end: int, most: int) -> list[Event]:
        """Return the begins and ends from a time until before another [ns], oldest first: so many, the latest.

        Raises StoreError where they cannot be read.
        """
        return latest_events(events_of_alarms(self.alarms()), start, end, most)


class AlarmsInMemory(AlarmLog):
    """A log that lasts as long as the process."""

    def __init__(self) -> None:
        self._texts: dict[tuple[str, int], str] = {}
        self._count = 0

    def alarms(self, *, open_only: bool = False, most: int | None = MOST_ALARMS) -> list[dict[str, Any]]:
        """Return alarms, the latest first."""
        found = [json.loads(text) for text in list(self._texts.values())]
        found = [one for one in found if one["end"] is None or not open_only]
        return sorted(found, key=lambda one: (one["begin"], one["number"]), reverse=True)[:most]

    def keep(self, alarms: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Keep alarms in place of what they were."""
        kept = []
        for one in alarms:
            key = one["what"], one["begin"]
            before = json.loads(self._texts[key]) if key in self._texts else None
            if before is None:
                self._count += 1
            said = {name: before[name] for name in ACKNOWLEDGED} if before else {}
            kept.append({**one, **said, "number": before["number"] if before else self._count})
            self._texts[key] = json.dumps(kept[-1])
        if len(self._texts) > MOST_ALARMS:
            self._forget(self.alarms(most=None)[MOST_ALARMS:])
        return kept

    def _forget(self, alarms: Sequence[Mapping[str, Any]]) -> None:
        for one in alarms:
            if one["end"] is not None:
                del self._texts[one["what"], one["begin"]]

    def acknowledge(self, number: int, by: str, time: int) -> bool:
        """Note who has taken note of an alarm."""
        for key, text in list(self._texts.items()):
            one = json.loads(text)
            if one["number"] == number:
                if not one["acknowledged_by"]:
                    self._texts[key] = json.dumps({**one, "acknowledged_by": by, "acknowledged_at": time})
                return True
        return False
