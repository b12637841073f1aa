from __future__ import annotations

import logging

import pytest

from robophm.core.rate_limited_log import AT_ONCE, EVERY, MOST_KNOWN, RateLimit


@pytest.fixture
def log() -> logging.Logger:
    log = logging.Logger("faults")
    log.said = []  # type: ignore[attr-defined]

    class Said(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            log.said.append(record.getMessage())  # type: ignore[attr-defined]

    log.addHandler(Said())
    return log


@pytest.mark.full
def test_the_same_line_is_written_a_few_times_and_then_counted(log: logging.Logger) -> None:
    now = 0.0
    log.addFilter(RateLimit(lambda: now))
    for number in range(100_000):
        log.warning("request %s", number)
    log.warning("another")
    now = EVERY
    log.warning("request %s", "later")
    assert log.said == [  # type: ignore[attr-defined]
        *(f"request {number}" for number in range(AT_ONCE)), "another",
        f"request later (and {100_000 - AT_ONCE:,} more like it before)",
    ]  # fmt: skip


def test_what_is_remembered_is_bounded(log: logging.Logger) -> None:
    limit = RateLimit()
    log.addFilter(limit)
    for number in range(3 * MOST_KNOWN):
        log.warning(f"line {number}")
    assert len(log.said) == 3 * MOST_KNOWN  # type: ignore[attr-defined]
    assert len(limit._seen) <= MOST_KNOWN
