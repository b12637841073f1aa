"""Entries of a design put in, changed or taken away in its text: all other lines stay letter for letter.

To write a document of thousands of parts anew takes longer than to build the robot that it describes.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

from robophm.core.yaml_values import Lines

_ANCHOR = re.compile(r"(?:^|[\s\[{,:-])[&*][^\s\[\]{},]", re.MULTILINE)

Dump = Callable[[Any], str]
"""Writes a document, comments attached, as text."""

_Splice = tuple[int, int, str]
"""The lines from one on until before another, counted from 0, and what is put in their place."""


def with_entries(text: str, lines: Lines, before: Mapping[str, Any], after: Any, dump: Dump) -> str | None:
    """Return a text with those entries of its mappings that differ written anew, with their comments.

    ``before``: the plain values of the text, whose lines ``lines`` are; ``after``: the document as it is to be. None
    where that takes more than entries: another order, another indent, braces around all, or a text with anchors.
    Whether the text means what it should is for the caller to see.
    """
    if _ANCHOR.search(text) or "\r" in text or not text.endswith("\n"):
        return None
    all_lines = text.splitlines(keepends=True)
    end = len(all_lines)
    while end and all_lines[end - 1].lstrip()[:1] in ("", "#"):  # remarks at the end are of the whole
        end -= 1
    found = _Splices(lines, after, dump, "".join(all_lines[end:]))
    if not found.collect((), before, after, end):
        return None
    ordered = sorted(((begin, end, n, said) for n, (begin, end, said) in enumerate(found.all)), reverse=True)
    for begin, end, _, written in ordered:
        all_lines[begin:end] = [written]
    return "".join(all_lines)


def same(one: Any, other: Any) -> bool:
    """Whether two values of documents are equal, in the same order; whole numbers, truths and others told apart."""
    if isinstance(one, str):
        return isinstance(other, str) and one == other
    if isinstance(one, Mapping):
        return (
            isinstance(other, Mapping)
            and len(one) == len(other)
            and all(a == b and same(one[a], other[b]) for a, b in zip(one, other, strict=True))
        )
    if isinstance(one, list):
        return isinstance(other, list) and len(one) == len(other) and all(map(same, one, other))
    return bool(one == other) and all(isinstance(one, kind) == isinstance(other, kind) for kind in (bool, int, float))


class _Splices:
    """The entries that a document has otherwise than a text, one below the other."""

    def __init__(self, lines: Lines, document: Any, dump: Dump, tail: str) -> None:
        self.lines, self.document, self.dump, self.tail = lines, document, dump, tail
        self.all: list[_Splice] = []

    def collect(self, place: tuple[str, ...], before: Mapping[str, Any], after: Any, end: int) -> bool:
        """Take down what is other in a mapping, whose text ends before a line; whether entries are all it takes."""
        places = [(*place, key) for key in before]
        kept = [key for key in before if key in after]
        starts = [self.lines.get(one, 0) - 1 for one in places]
        edges = [*starts, end]
        if (
            not kept or kept != [key for key in after if key in before] or after.fa.flow_style()
            or any(begin >= until for begin, until in pairwise(edges)) or starts[0] < 0
        ):  # fmt: skip
            return False
        column = self.lines.columns[places[0]]
        spans = dict(zip(before, pairwise(edges), strict=True))
        last = starts[0]
        for key in after:
            begin, last = spans.get(key, (last, last))
            if key in before and self._settled(place, key, before[key], after[key], last):
                continue
            written = self._written((*place, key))
            if len(written) - len(written.lstrip(" ")) != column - 1:
                return False
            self.all.append((begin, last, written))
        self.all.extend((*spans[key], "") for key in before if key not in after)
        return True

    def _settled(self, place: tuple[str, ...], key: str, before: Any, after: Any, end: int) -> bool:
        """Whether nothing more is to be done for an entry: it is the same, or what differs in it is taken down."""
        if isinstance(before, Mapping) and hasattr(after, "ca") and isinstance(after, Mapping):
            count = len(self.all)
            if self.collect((*place, key), before, after, end):
                return True
            del self.all[count:]
        return same(before, after)

    def _written(self, place: tuple[str, ...]) -> str:
        """An entry as it stands within all that is around it, with its comments."""
        around = [self.document]
        for key in place[:-1]:
            around.append(around[-1][key])
        entry = around[-1][place[-1]]
        for level, key in zip(reversed(around), reversed(place), strict=True):
            alone = type(level)()
            alone[key] = entry
            if level is around[-1] and key in level.ca.items:
                alone.ca.items[key] = level.ca.items[key]
            entry = alone
        return "".join(self.dump(entry).splitlines(keepends=True)[len(place) - 1 :]).removesuffix(self.tail or "\0")
