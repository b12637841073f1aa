"""Extraction from one message by itself, for messages that come one by one: fixed bytes with texts between."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import NamedTuple

from robophm.transports.recordings.columns.field_extraction import Align, End, Program, Step, Take, Text
from robophm.transports.recordings.columns.message_layout import NotCompilableError

_LITTLE_ENDIAN = b"\x00\x01"
"""The first bytes of CDR; the other order is left to the decoder."""

_LETTERS = {"?": "?", "u1": "B", "i1": "b", "u2": "H", "i2": "h", "u4": "I", "i4": "i", "u8": "Q", "i8": "q", "f4": "f",
            "f8": "d"}  # fmt: skip


class _Run(NamedTuple):
    """Fixed bytes, and what comes behind them."""

    numbers: struct.Struct
    """Numbers that are wanted, and last the length of a text."""
    size: int
    text: bool
    to: int
    """Multiple of bytes to which the end is aligned."""


class Single:
    """The wanted numbers of one message: those that a program finds side by side.

    Raises NotCompilableError where there are sequences on the way: what is behind them, a decoder finds as fast.
    """

    def __init__(self, program: Program) -> None:
        self._begin = 0 if program.packed else 4
        self._terminated = not program.packed
        self._slack: int | None = None
        self._runs: list[_Run] = []
        slots: list[int] = []
        taken: list[Take] = []
        for step in program.steps:
            if isinstance(step, Take):
                taken.append(step)
                slots.append(step.slot)
                continue
            if not isinstance(step, Align | Text | End):
                raise NotCompilableError
            if isinstance(step, End):
                self._slack = step.slack
            self._runs.append(_run(taken, step, program.types))
            taken = []
        self._place = [slots.index(slot) for slot in range(len(slots))]

    def read(self, raw: bytes) -> Sequence[float] | None:
        """Return the numbers by slot; None for a message that is not as its type says, or big-endian."""
        if self._begin and raw[:2] != _LITTLE_ENDIAN:
            return None
        begin = at = self._begin
        found: list[float] = []
        try:
            for numbers, size, text, to in self._runs:
                found += numbers.unpack_from(raw, at)
                at += size
                if text:
                    length = int(found.pop())
                    at += length
                    if self._terminated and (not length or raw[at - 1]):
                        return None
                elif to > 1:
                    at += (begin - at) % to
        except (struct.error, IndexError):
            return None
        if at > len(raw) or (self._slack is not None and len(raw) - at > self._slack):
            return None
        return [found[place] for place in self._place]


def _run(taken: Sequence[Take], step: Step, types: Sequence[str]) -> _Run:
    """The run of what is taken before a step, and the step."""
    form, at = "<", 0
    for take in taken:
        number = struct.Struct(f"<{_LETTERS[types[take.slot]]}")
        form += f"{take.skip - at}x{number.format[1:]}"
        at = take.skip + number.size
    text, to = isinstance(step, Text), step.to if isinstance(step, Align) else 1
    form += f"{step.skip - at}x" + "I" * text
    return _Run(struct.Struct(form), step.skip + 4 * text, text, to)
