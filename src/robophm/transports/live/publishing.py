"""Publishing, as far as it is alike over all transports."""

from __future__ import annotations

from typing import Any, Self

from robophm.core.errors import SourceError
from robophm.core.signal import signal_name
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.message_type import MessageType, serialized


class NodeOfConnection:
    """A name under which topics are published over one connection that knows no nodes; a context manager."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.notes = Incidents()  # the connection has its own

    def close(self) -> None:
        """Do nothing: whoever made the connection ends it."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def refuse_no_topic(topic: str) -> None:
    """Raise SourceError where this is no name of a topic."""
    if not topic.startswith("/"):
        raise SourceError(f"'{topic}' is not a topic; expected it to begin with '/'")
    signal_name(topic, "data")


def bytes_of(type_: MessageType, topic: str, name: str, message: Any) -> bytes:
    """Return the bytes of a message for a topic, whose type has this name. Raises SourceError where it is not of it."""
    try:
        return serialized(type_, message)
    except Exception as error:  # struct, NumPy, attribute errors …
        raise SourceError(f"message on {topic} is no {name}: {error}") from error
