"""Thousands of hostile messages by number of the seed, good ones between them: what any transport has to endure."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import pytest

from .listener import PATIENCE

SEED = 23

EACH = 50
"""Hostile messages before each good one."""

LONGEST = 5.0
"""Seconds within which a good message counts, whatever came before it."""

MOST = 200_000
"""Kilobytes by which memory may grow."""

FEW_AND_MANY = pytest.mark.parametrize("many", [200, pytest.param(10_000, marks=pytest.mark.full)])
"""How many hostile messages are sent: in a second or two, and by ``make test-full``."""

ODD: list[Any] = [None, True, -1, 1e308, 2**70, "", "x" * 10_000, [], {}, [[[]]], {"data": {"data": 1}}]


class Endured(NamedTuple):
    """What came of it."""

    good: int
    """Good messages, all of which were heard."""
    longest: float
    """Seconds that one of them took at most."""
    grown: int
    """Kilobytes by which memory grew, at its peak."""


def endured(
    many: int, hostile: Callable[[random.Random], None], good: Callable[[int], None], heard: Callable[[int], bool]
) -> Endured:
    """Send so many hostile messages, a good one with its number after some each, and wait until that is heard."""
    draw, longest, before = random.Random(SEED), 0.0, _memory(peak=False)
    for number in range(many // EACH):
        for _ in range(EACH):
            hostile(draw)
        begun = time.monotonic()
        good(number)
        while not heard(number):
            assert time.monotonic() - begun < LONGEST * PATIENCE, f"good message {number} was not heard"
            time.sleep(0.001)
        longest = max(longest, time.monotonic() - begun)
    found = Endured(many // EACH, longest, _memory(peak=True) - before)
    print(f"{many:,} hostile messages, {found.good} good ones heard, each within {longest:.3f} s; "
          f"memory grew by {found.grown // 1024} MiB to {_memory(peak=True) // 1024} MiB")  # fmt: skip
    assert found.grown < MOST
    return found


def _memory(*, peak: bool) -> int:
    """Kilobytes of this process: now, from where a new peak begins to count, or at the peak."""
    if not peak:
        with suppress(OSError):  # where it is not allowed, an older peak hides a lower one
            Path("/proc/self/clear_refs").write_text("5")
    name = "VmHWM:" if peak else "VmRSS:"
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(name))


Frame = TypeVar("Frame", str, bytes)


def damaged(frame: Frame, draw: random.Random) -> Frame:
    """A frame with pieces of it changed, doubled or left out, or something else altogether."""
    for _ in range(draw.randint(1, 4)):
        begin, end = sorted(draw.randrange(len(frame) + 1) for _ in range(2))
        if isinstance(frame, bytes):
            new: Any = draw.choice([draw.randbytes(end - begin), b"\xff" * 4, b"", frame[begin:end] * 2])
        else:
            new = draw.choice([json.dumps(draw.choice(ODD)), draw.choice('{}[]",:\\\0é'), "", frame[begin:end] * 2])
        frame = frame[:begin] + new + frame[end:]
    return frame


def deep(draw: random.Random) -> str:
    """Brackets within brackets, by the thousand, or a number of as many digits."""
    many = draw.choice([100, 10_000, 100_000])
    return draw.choice(["[" * many, '{"op":' * many, "[" * many + "]" * many, '{"op": ' + "9" * many + "}"])
