"""Read a file of damaged messages that are not of ROS, and say what is not as their own library reads them."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from robophm.core.errors import SourceError
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source

from .messages import Numbers, Told
from .seeds import SECOND, T0


def read(path: Path, fields: tuple[str, ...]) -> tuple[dict[int, Numbers], Counter[str]]:
    """The numbers of each message by its place, and notes; in columns and one by one the same."""
    signals = [f"/a.{field}" for field in fields]
    columns, found = read_columns(path, signals), dict[int, Numbers]()
    for block in columns:
        part = block["/a"]
        for row, at in enumerate(part.received.tolist()):
            found[(at - T0) // SECOND] = [float(part.values[field][row]) for field in fields]
    with open_source(path) as source:
        samples = Counter(one.signal for one in source.samples(signals) if not math.isnan(one.value))
    whole = {one: sum(not math.isnan(row[at]) for row in found.values()) for at, one in enumerate(signals)}
    assert samples == Counter({one: count for one, count in whole.items() if count}), "columns differ"
    return found, columns.notes


def verdict(told: Told, path: Path) -> tuple[str, str]:
    """What became of it, and what is not as it should be; raises SourceError where it is refused."""
    fields = told.of.fields if told.sound else readable(path, told.of.fields)
    found, notes = read(path, fields)
    if len(found) < len(told.raws) and not any("unreadable" in note for note in notes):
        return "fault", f"{len(told.raws) - len(found)} messages are lost without a word: {dict(notes)}"
    try:
        theirs = told.of.reader(told.schema)
    except Exception:
        theirs = None
    changed = False
    for place, raw in enumerate(told.raws):
        ours = found.get(place)
        changed = changed or (ours is not None and raw != told.of.sound[place])
        try:
            other = theirs(raw) if theirs else None
        except Exception as error:
            other = None
            if told.sound and ours and not all(map(math.isnan, ours)) and "unhashable" not in str(error):
                return "fault", f"message {place} is read, which its library refuses: {ours}, {error!r}, {raw.hex()}"
        if other is not None and (fault := _differs(told, dict(zip(told.of.fields, other, strict=True)), fields, ours)):
            return "fault", f"message {place}: {fault}, {raw.hex()}"
    return ("in part" if len(found) < len(told.raws) else "changed" if changed or not told.sound else "whole"), ""


def readable(path: Path, fields: tuple[str, ...]) -> tuple[str, ...]:
    """The fields that a damaged schema still names. Raises SourceError where there are none."""
    left = []
    for field in fields:
        try:
            read(path, (field,))
            left.append(field)
        except SourceError as error:
            refused = error
    if not left:
        raise refused
    return tuple(left)


def _differs(told: Told, other: dict[str, float], fields: tuple[str, ...], ours: Numbers | None) -> str:
    """Where numbers are others than those that the library reads; of a damaged schema where both read some."""
    wanted = [other[field] for field in fields]
    if ours is None:
        checked = told.of.encoding == "flatbuffer"  # whose readers check nothing
        lost = told.sound and not checked and not all(map(math.isnan, wanted))
        return f"is not read, by its library it is {wanted}" if lost else ""
    pairs = zip(map(repr, ours), map(repr, wanted), strict=True)
    if all(one == another or (not told.sound and "nan" in (one, another)) for one, another in pairs):
        return ""
    return f"reads {ours}, by its library it is {wanted}"
