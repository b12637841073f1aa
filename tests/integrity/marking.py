"""What a process says of how far it is, whatever becomes of it: to strace, or in memory that outlives it."""

from __future__ import annotations

import mmap
import os
import struct
from typing import Literal

Word = Literal["heard", "flushed", "kept"]
"""Samples, or saves, that were begun; that a kill cannot take any more; that a cut of power cannot."""
WORDS: tuple[Word, ...] = ("heard", "flushed", "kept")


class Marks:
    """The numbers that a process has said last, in memory that it shares with the one that forked it."""

    def __init__(self) -> None:
        self._memory = mmap.mmap(-1, 8 * len(WORDS))

    def __getitem__(self, word: Word) -> int:
        found: int = struct.unpack_from("q", self._memory, 8 * WORDS.index(word))[0]
        return found

    def say(self, word: Word, number: int) -> None:
        """Say how far it is."""
        struct.pack_into("q", self._memory, 8 * WORDS.index(word), number)


class TracedMarks(Marks):
    """Numbers that strace sees in their place among all that is written."""

    def say(self, word: Word, number: int) -> None:
        """Say how far it is."""
        super().say(word, number)
        os.write(1, f"mark {word} {number}\n".encode())
