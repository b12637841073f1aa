"""Health as it is published, in a file: MCAP as ROS 2 records it, with the definition of each type in it."""

from __future__ import annotations

import threading
import time
from collections import Counter
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.health_topics.definitions import typestore
from robophm.transports.health_topics.outlet import Outlet

CHUNK = 1 << 16
"""Bytes of messages that are packed together: the most that is lost where the recording is killed."""


class HealthRecording(Outlet):
    """The outlet to a new file, which ends with it; each message is of the machine's time.

    A disk that is full is no reason to end a watch: what could not be written is counted in ``notes``. Raises
    SourceError where there is such a file already, or it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        from mcap.writer import Writer

        super().__init__(2, nullcontext, self._topic)
        try:
            self._file = path.open("xb")
        except FileExistsError:
            raise SourceError(f"{path}: exists; expected a new name: a recording is not gone on with") from None
        except OSError as error:
            raise SourceError(f"{path}: cannot be written: {error.strerror}") from None
        self._writer = Writer(self._file, chunk_size=CHUNK)
        self._writer.start(profile="ros2", library="robophm")
        self._schemas: dict[str, int] = {}
        self._lock = threading.Lock()
        self._failure = ""
        self._lost: Counter[str] = Counter()

    def _topic(self, node: object, topic: str, type_: str, definition: str, *, latched: bool) -> _Topic:
        with self._lock:
            if type_ not in self._schemas:
                self._schemas[type_] = self._writer.register_schema(type_, "ros2msg", definition.encode())
            return _Topic(self, self._writer.register_channel(topic, "cdr", self._schemas[type_]), type_)

    def write(self, channel: int, raw: bytes) -> None:
        """Write a message, from any thread."""
        now = time.time_ns()
        with self._lock:
            if not self._failure:
                try:
                    self._writer.add_message(channel, now, raw, now)
                    return
                except OSError as error:  # what the writer has begun would grow with all that comes
                    self._failure = f"not recorded: {error.strerror}"
            self._lost[self._failure] += 1

    @property
    def notes(self) -> Counter[str]:
        """Return how many messages could not be written, and why."""
        return self._lost.copy()

    def close(self) -> None:
        """End the file; twice does no harm."""
        with self._lock:
            if self._file.closed:
                return
            try:
                with self._file:
                    if not self._failure:
                        self._writer.finish()  # type: ignore[no-untyped-call]
            except OSError as error:
                self._lost[f"recording not ended: {error.strerror}"] += 1


class _Topic:
    """A topic in the file."""

    def __init__(self, recording: HealthRecording, channel: int, type_: str) -> None:
        self._recording, self._channel, self._type = recording, channel, type_

    def publish(self, message: Any) -> None:
        """Write a message."""
        self._recording.write(self._channel, bytes(typestore(2).serialize_cdr(message, self._type)))
