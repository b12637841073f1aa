"""Lists of numbers as Python writes them, ``[1, 2.5]`` or ``[(0, 1), (2, 3)]``, read and never evaluated.

The depth is the caller's, not the text's: no text makes the reader go deeper than two brackets.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import TypeVar

from robophm.core.errors import SourceError

LONGEST_LITERAL = 1 << 20
"""Characters of a text beyond which it is not read."""

MOST_NUMBERS = 100_000
"""Numbers in one text beyond which it is not read."""

_LONGEST_NUMBER = 100
_BLANK = re.compile(r"[ \t\r\n]*")
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_CLOSING = {"[": "]", "(": ")"}

_Item = TypeVar("_Item")


def numbers(text: str) -> list[float]:
    """The numbers of a list or tuple, all finite. Raises SourceError, with the place, where it is none."""
    reader = _Reader(text)
    return reader.whole(reader.sequence(reader.number))


def rows(text: str) -> list[list[float]]:
    """The numbers of a list of lists. Raises SourceError, with the place, where it is none."""
    reader = _Reader(text)
    return reader.whole(reader.sequence(lambda: reader.sequence(reader.number)))


class _Reader:
    """A place in the text that only moves forward."""

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST_LITERAL:
            raise SourceError(f"is {len(text)} characters long; expected at most {LONGEST_LITERAL}")
        self.text = text
        self.at = self.read = 0

    def sequence(self, item: Callable[[], _Item]) -> list[_Item]:
        items: list[_Item] = []
        begun = self.at
        closing = _CLOSING.get(self.next())
        if closing is None:
            raise self.error("a list, '[' or '('")
        self.at += 1
        comma = True
        while self.next() != closing:
            if not comma:
                raise self.error(f"',' or '{closing}'")
            items.append(item())
            if comma := self.next() == ",":
                self.at += 1
        self.at += 1
        if closing == ")" and len(items) == 1 and not comma:  # to Python (1) is no list
            self.at = begun
            raise self.error("a tuple of one to end in ',)'")
        return items

    def number(self) -> float:
        self.next()
        match = _NUMBER.match(self.text, self.at)
        if not match or match.end() - self.at > _LONGEST_NUMBER:
            raise self.error("a number")
        self.read += 1
        if self.read > MOST_NUMBERS:
            raise self.error(f"at most {MOST_NUMBERS} numbers")
        value = float(match[0])
        if not math.isfinite(value):
            raise self.error("a number that is not too large")
        self.at = match.end()
        return value

    def whole(self, found: list[_Item]) -> list[_Item]:
        if self.next():
            raise self.error("the end")
        return found

    def next(self) -> str:
        """The next character that is not blank, "" at the end; the place moves up to it."""
        blank = _BLANK.match(self.text, self.at)
        self.at = blank.end() if blank else self.at
        return self.text[self.at : self.at + 1]

    def error(self, expected: str) -> SourceError:
        found = repr(self.text[self.at : self.at + 20]) if self.at < len(self.text) else "the end"
        return SourceError(f"character {self.at + 1}: expected {expected}; found {found}")
