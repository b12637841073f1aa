"""Ledgers as earlier versions kept them become those of now; those of a later version are refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from robophm.core.errors import StoreError
from robophm.core.signal import HOUR

VERSION = 2
"""Version of a ledger as JSON has it."""


def up_to_date(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return a kept ledger in the form of now. Raises StoreError where it is of no version that is known."""
    version = data.get("version")
    if version == VERSION:
        return data
    if version == 1:
        return _of_version_1(data)
    later = isinstance(version, int) and version > VERSION
    more = f", of a newer robophm; this one knows up to version {VERSION}" if later else f"; expected {VERSION}"
    raise StoreError(f"ledger version {version}{more}")


def _of_version_1(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """One that kept the last ten minutes alone: what was before is one step of the past."""
    ends = [one[0] for one in data["recent"]]
    begins = [max(data["started"] or 0, ends[0] - round(data["recent"][0][1] * HOUR)), *ends[:-1]] if ends else []
    recent = [
        (end, (end - begin) / HOUR, operating, age, effective)
        for begin, (end, operating, age, effective) in zip(begins, data["recent"], strict=True)
    ]
    sums = {name: [high + low for high, low in zip(*both, strict=True)] for name, both in data["totals"].items()}
    operating, calendar = sums["clocks"][:2]
    end = data["integrated_to"]
    whole = [] if end is None else [(end, calendar, operating, sums["age"], sums["effective"])]
    kept = {"history_step": HOUR, "replaced": {}, "seen": {}}
    return {**data, **kept, "version": VERSION, "recent": _steps(recent), "history": _steps(whole)}


def _steps(some: Sequence[tuple[int, float, float, Sequence[float], Sequence[float]]]) -> dict[str, Any]:
    kinds = [row for *_, age, effective in some for row in (list(age), list(effective))]
    return {
        "steps": [[end, calendar, operating, {}] for end, calendar, operating, _, _ in some],
        "kinds": kinds,
        "of": list(range(len(kinds[0]))) if kinds else [],
    }
