"""The log of what was changed: by whom, when, from where, and of a design each value before and after."""

from __future__ import annotations

import json
import logging
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any

from robophm.web.access.file import AccessFile

MOST_KEPT = 20_000
"""Changes that are kept, the latest."""

MOST_VALUES = 50
"""Values of one change that are kept; how many more there were is too."""

LONGEST_VALUE = 200
"""Characters that are kept of a value."""

Value = tuple[str, str | None, str | None]
"""Place in the design, and the value before and after as JSON; None where there was none."""


@dataclass
class Change:
    """One change, as it is made: by a request, or by whoever wrote the design's file."""

    who: str
    role: str
    address: str
    what: str
    values: list[Value] = field(default_factory=list)
    more: int = 0
    """Values that were changed beside those."""
    time: float = 0.0
    """When it was made [s since the epoch]."""

    def design_changed(self, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        """Take note of each value in which two designs differ."""
        for one in differences(before, after):
            if len(self.values) < MOST_VALUES:
                self.values.append(one)
            else:
                self.more += 1


CHANGE: ContextVar[Change | None] = ContextVar("change", default=None)
"""The change that the request under way makes."""


class ChangeLog:
    """The latest changes, in an access file."""

    def __init__(self, file: AccessFile) -> None:
        self._file = file

    def add(self, change: Change) -> None:
        """Keep a change; what cannot be kept is said in the log of the process."""
        values = json.dumps({"values": change.values, "more": change.more}, ensure_ascii=False)
        row = (time.time(), change.who, change.role, change.address, change.what, values)
        try:
            self._file.run("INSERT INTO change VALUES (NULL, ?, ?, ?, ?, ?, ?)", row)
            self._file.run("DELETE FROM change WHERE id <= (SELECT max(id) FROM change) - ?", (MOST_KEPT,))
        except sqlite3.Error as error:
            logging.getLogger("robophm").error("a change is missing in the log: %s", error)

    def design_changed(self, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        """Take note of a changed design: of the request under way, else of whoever changed its file."""
        if change := CHANGE.get():
            change.design_changed(before, after)
            return
        change = Change("", "", "", "file changed outside")
        change.design_changed(before, after)
        self.add(change)

    def latest(self, most: int) -> list[Change]:
        """Return the latest changes, the latest first."""
        query = "SELECT time, who, role, address, what, values_ FROM change ORDER BY id DESC LIMIT ?"
        found = []
        for when, who, role, address, what, text in self._file.run(query, (most,)):
            kept = json.loads(text)
            values = [(place, old, new) for place, old, new in kept["values"]]
            found.append(Change(who, role, address, what, values, kept["more"], when))
        return found


def differences(before: object, after: object, place: str = "") -> Iterator[Value]:
    """Give each value in which two documents differ, with its place."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in [*before, *(key for key in after if key not in before)]:
            if (old := before.get(key, _NONE)) != (new := after.get(key, _NONE)):
                yield from differences(old, new, f"{place}/{key}" if place else str(key))
    elif before != after:
        yield place[:1000], _text(before), _text(after)


_NONE = object()


def _text(value: object) -> str | None:
    return None if value is _NONE else json.dumps(value, ensure_ascii=False, default=str)[:LONGEST_VALUE]
