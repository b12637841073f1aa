"""Notes that are counted, as lines for people: what was said of a thousand files is one line."""

from __future__ import annotations

import re
from collections.abc import Mapping

_ORDINARY = ("receipt time used", "no element", "connected again", "order changed")
MOST_ALIKE = 3
"""Notes that differ in numbers alone and are told one by one."""

_FILE = re.compile(r"\S\.(bag|mcap|db3|active|zstd|zst|gz|ulg|csv|parquet|jsonl)\b")


def ordinary(what: str) -> bool:
    """Whether a note on a running robot tells of nothing that is lost, as that messages carry no time."""
    return what.startswith(_ORDINARY)


class FreshNotes:
    """Tells which notes to tell of while a robot is watched: each at first, and when it is ten times as many."""

    def __init__(self) -> None:
        self._told: dict[str, int] = {}

    def of(self, notes: Mapping[str, int]) -> dict[str, int]:
        """Return the notes that are to be told of now."""
        fresh = {}
        for what, count in notes.items():
            if not ordinary(what) and len(str(count)) > self._told.get(what, 0):
                self._told[what] = len(str(count))
                fresh[what] = count
        return fresh

    def lines(self, notes: Mapping[str, int]) -> list[str]:
        """Return the notes that are to be told of now, as lines."""
        return said(self.of(notes))


def said(notes: Mapping[str, int], of: str = "") -> list[str]:
    """Return notes as lines, each with how often, and with the name of what they are ``of`` where one is given.

    Of notes on files that differ in numbers alone, as splits of one drive do, the first stands for all.
    """
    alike: dict[str, list[str]] = {}
    for what in sorted(notes):
        alike.setdefault(re.sub(r"\d[\d,]*", "#", what) if _FILE.search(what) else what, []).append(what)
    lines = []
    for some in alike.values():
        few = len(some) <= MOST_ALIKE
        lines += [_line(what, notes[what], "") for what in (some if few else some[:1])]
        if not few:
            lines[-1] = _line(some[0], notes[some[0]], f", and {len(some) - 1:,} more like it")
    return [f"{of}: {line}" if of else line for line in lines]


def _line(what: str, count: int, more: str) -> str:
    return f"{what} ({count:,} times{more})" if count > 1 else f"{what} ({more[2:]})" if more else what
