"""A store that lasts as long as the process."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from robophm.stores.store import Progress, Store


class MemoryStore(Store):
    """Keeps everything as text, so that what is read back is never what somebody still changes."""

    def __init__(self, where: str | os.PathLike[str] = "") -> None:
        self._ledgers: dict[str, str] = {}
        self._progress: dict[tuple[str, str], Progress] = {}
        self._reports: dict[str, dict[int, str]] = {}

    @classmethod
    def exists(cls, where: str) -> bool:
        """Whether there is something: never, it is always new."""
        return False

    def ledger(self, robot: str) -> Mapping[str, Any] | None:
        """Return the robot's ledger as it was saved, or None."""
        text = self._ledgers.get(robot)
        return json.loads(text) if text is not None else None

    def robots(self) -> list[str]:
        """Return the names of the robots whose ledgers are kept, sorted."""
        return sorted(self._ledgers)

    def progress(self, robot: str, recording: str) -> Progress:
        """Return how far a recording has been replayed into this robot's ledger."""
        return self._progress.get((robot, recording), Progress(recording))

    def history(self, robot: str) -> Iterator[Mapping[str, Any]]:
        """Yield the robot's reports, oldest first."""
        for _, text in sorted(self._reports.get(robot, {}).items()):
            yield json.loads(text)

    def save(
        self,
        robot: str,
        ledger: Mapping[str, Any],
        progress: Iterable[Progress] = (),
        reports: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        """Keep the robot's ledger, the progress of its recordings, and its reports."""
        texts = json.dumps(ledger), {int(report["time"]): json.dumps(report) for report in reports}
        self._ledgers[robot] = texts[0]
        self._reports.setdefault(robot, {}).update(texts[1])
        self._progress.update({(robot, one.recording): one for one in progress})
