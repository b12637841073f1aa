"""Counts of live transports, and errors about others that do not do as they should."""

from __future__ import annotations

from collections import Counter
from threading import Lock

from robophm.core.errors import SourceError

MOST_KINDS = 2000
"""Kinds of incidents that are counted each by itself: others name topics and what is wrong with them as they like."""

LONGEST_KIND = 500
"""Letters of one."""

OTHER_KINDS = f"of more than {MOST_KINDS} kinds, not told one by one"


class PeerError(SourceError):
    """Another process of the ROS graph does not do as it should; ``kind`` is how it is counted."""

    def __init__(self, text: str, kind: str) -> None:
        super().__init__(text)
        self.kind = kind


class TypeRefusedError(PeerError):
    """A type that cannot be read: one without a definition, or without a field that is wanted."""


class UnknownTypeError(SourceError):
    """A type of message that the ROS that is installed here does not know, so that it cannot be published."""


class Incidents(Counter[str]):
    """Counts that several threads add to; to go through them meanwhile, go through a ``copy()``."""

    def __init__(self) -> None:
        super().__init__()
        self.lock = Lock()

    def add(self, text: str, count: int = 1) -> None:
        """Count once more, or several times."""
        text = text[:LONGEST_KIND]
        with self.lock:
            self[text if text in self or len(self) < MOST_KINDS else OTHER_KINDS] += count

    def once(self, text: str) -> None:
        """Count once, and no more."""
        if text not in self:
            self.add(text)

    def copy(self) -> Counter[str]:  # type: ignore[override]
        """Return the counts so far, as a plain Counter."""
        with self.lock:
            return Counter(self)
