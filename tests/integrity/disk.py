"""What a disk may hold after power was cut while a process wrote to it."""

from __future__ import annotations

import random
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from .recorded_writes import Cut, Deed, Marked, Named, Recorded, Synced, Write

SECTOR = 512
"""Bytes that a disk writes as a whole."""

Fate = Literal["all", "synced", "some", "torn"]
"""What became of what had not been synced: all is there, nothing, some of the writes in any order, some sectors."""
FATES: Sequence[Fate] = ("all", "synced", "some", "torn")


def left(recorded: Recorded, cut: int, fate: Fate, chance: random.Random) -> dict[str, bytes]:
    """Return the files that are left where power was cut after so many deeds.

    Names become lasting in the order in which they were given, as journals of file systems have it; of what they name
    all, nothing or parts may be there.
    """
    deeds = recorded.deeds[:cut]
    sure: dict[int | None, int] = {}
    for deed in deeds:
        if isinstance(deed, Synced):
            sure[deed.file] = max(sure.get(deed.file, 0), deed.began)
    return _named(recorded, deeds, sure.get(None, 0), fate, chance, _contents(recorded, deeds, sure, fate, chance))


def _contents(
    recorded: Recorded, deeds: Sequence[Deed], sure: dict[int | None, int], fate: Fate, chance: random.Random
) -> dict[int, bytearray]:
    files = {number: bytearray(content) for number, content in enumerate(recorded.files)}
    for number, deed in enumerate(deeds):
        if not isinstance(deed, Write | Cut):
            continue
        lasting = number < sure.get(deed.file, 0)
        if not lasting and (fate == "synced" or (fate != "all" and chance.random() < 0.4)):
            continue
        content = files.setdefault(deed.file, bytearray())
        if isinstance(deed, Cut):
            del content[deed.size :]
            content.extend(bytes(deed.size - len(content)))
        else:
            _write(content, deed, chance if fate == "torn" and not lasting else None)
    return files


def _write(content: bytearray, deed: Write, torn: random.Random | None) -> None:
    """Put a write into a file; of one that is torn some sectors."""
    end = deed.at + len(deed.data)
    content.extend(bytes(max(0, end - len(content))))
    if torn is None:
        content[deed.at : end] = deed.data
        return
    for begin in range(deed.at // SECTOR * SECTOR, end, SECTOR):
        if torn.random() < 0.6:
            first, last = max(begin, deed.at), min(begin + SECTOR, end)
            content[first:last] = deed.data[first - deed.at : last - deed.at]


def _named(
    recorded: Recorded, deeds: Sequence[Deed], sure: int, fate: Fate, chance: random.Random,
    files: dict[int, bytearray],
) -> dict[str, bytes]:  # fmt: skip
    open_ = [number for number, deed in enumerate(deeds) if isinstance(deed, Named) and number >= sure]
    kept = {"all": len(open_), "synced": 0}.get(fate, chance.randint(0, len(open_)))
    last = open_[kept] if kept < len(open_) else len(deeds)
    names: dict[str, int | None] = dict(recorded.names)
    for deed in deeds[:last]:
        if isinstance(deed, Named):
            names.update(deed.names)
    return {name: bytes(files.get(file, b"")) for name, file in names.items() if file is not None}


def marks(deeds: Sequence[Deed]) -> dict[str, int]:
    """Return the latest number that the process said of each word."""
    return {deed.word: deed.number for deed in deeds if isinstance(deed, Marked)}


def lay(files: dict[str, bytes], folder: Path) -> None:
    """Make a folder hold these files and no others."""
    folder.mkdir(exist_ok=True)
    for path in folder.iterdir():
        path.unlink()
    for name, content in files.items():
        (folder / name).write_bytes(content)
