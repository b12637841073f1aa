"""What a source knows of a topic."""

from __future__ import annotations

import pytest

from robophm.core.signal import SECOND
from robophm.transports.signals.source import TopicInfo


@pytest.mark.parametrize(
    ("messages", "first", "last", "rate"),
    [
        (11, 5 * SECOND, 10 * SECOND, 2.0),
        (2, 0, 4 * SECOND, 0.25),
        (1, 0, 0, None),
        (0, None, None, None),
        (3, 7, 7, None),
    ],
)
def test_messages_a_second(messages: int, first: int | None, last: int | None, rate: float | None) -> None:
    assert TopicInfo("/t", "", messages, first, last, ()).rate == rate
