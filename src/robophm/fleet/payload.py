"""The payload that a robot sends its fleet, versioned and compressed; docs/reference/fleet-wire.md specifies it."""

from __future__ import annotations

import json
import math
import re
import zlib
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

from robophm.core.errors import DataError
from robophm.stores.outbox import COLUMNS, Batch

VERSION = 1
"""Version of the payload."""

MOST_BYTES = 1_000_000
"""Largest payload, compressed."""

MOST_TEXT = 16_000_000
"""Largest payload, uncompressed [bytes]."""

MOST_REPORTS = 500
"""Reports in one payload, at most."""

MOST_HORIZONS, LONGEST_PATH = 10, 1000
"""Horizons of a report, and letters of a part's path, at most."""

_LARGEST = 2**63 - 1
_EPOCH = re.compile("[0-9a-f]{16}")


class Report(NamedTuple):
    """One report of a payload."""

    seq: int
    """Number of the report in its epoch, from 1."""
    time: int
    """Time of the report by the robot's clock [ns since the epoch of Unix]."""
    thinned: int
    """How many reports before it, since the last one that was kept, the robot let go of."""
    figures: tuple[float, ...]
    """Values in the order of COLUMNS; NaN where there is none."""


class Ahead(NamedTuple):
    """The probability of failing within a horizon, as the report states it, and what it is mostly of."""

    horizon: float
    """Time ahead [h]."""
    sensor_based_failure: float
    first: str | None
    """The part, or group, of which most of those failures would come."""
    share: float | None
    """Share of it in them."""


class PresentState(NamedTuple):
    """The robot's newest ledger and whole report."""

    revision: int
    ledger: str
    """Ledger as JSON, letter by letter as the robot keeps it."""
    report: Mapping[str, Any] | None
    ahead: tuple[Ahead, ...]


class Payload(NamedTuple):
    """One message of a robot to its fleet."""

    robot: str
    epoch: str
    """Name of the stretch of watching that reports and present state are of."""
    sent: int
    """Time of sending by the robot's clock [ns since the epoch of Unix]."""
    waiting: int
    """Reports that still wait at the robot behind these."""
    reports: tuple[Report, ...]
    present: PresentState | None
    size: int = 0
    """Length of its text, uncompressed [bytes]."""


def packed(robot: str, sent: int, batch: Batch) -> bytes:
    """Return the payload of a batch that is not empty. Raises DataError where it is too large."""
    said: dict[str, Any] = {
        "version": VERSION,
        "robot": robot,
        "epoch": batch.present.epoch if batch.present else batch.reports[0].epoch,
        "sent": sent,
        "waiting": batch.left,
        "columns": ["seq", "time", "thinned", *COLUMNS],
        "reports": [[one.seq, one.time, one.thinned, *one.figures] for one in batch.reports],
    }
    if present := batch.present:
        said["present"] = {"revision": present.revision, "ledger": present.ledger, "report": present.report}
    text = json.dumps(said, separators=(",", ":")).encode()
    body = zlib.compress(text)
    if len(text) > MOST_TEXT or len(body) > MOST_BYTES:
        raise DataError(f"{len(text) / 1e6:.1f} MB, compressed {len(body) / 1e6:.1f} MB; expected at most "
                        f"{MOST_TEXT / 1e6:g} and {MOST_BYTES / 1e6:g}")  # fmt: skip
    return body


def unpacked(body: bytes) -> Payload:
    """Return a payload. Raises DataError, in words for whoever sent it, where it is none, or too large."""
    said, size = _json(body)
    version = said.get("version")
    if version != VERSION:
        raise DataError(f"version {version!r:.40} of the payload; this service knows version {VERSION}")
    columns, rows = said.get("columns"), said.get("reports")
    if not isinstance(columns, list) or columns[:3] != ["seq", "time", "thinned"]:
        raise DataError("columns: expected seq, time, thinned and the names of figures")
    if not isinstance(rows, list) or len(rows) > MOST_REPORTS:
        raise DataError(f"reports: expected a list of at most {MOST_REPORTS}")
    at = {name: place for place, name in enumerate(columns) if isinstance(name, str)}
    places = [at.get(name) for name in COLUMNS]
    reports = tuple(_report(row, len(columns), places) for row in rows)
    if any(one.seq >= other.seq for one, other in pairwise(reports)):
        raise DataError("reports: expected ascending seq")
    epoch = _text(said, "epoch")
    if not _EPOCH.fullmatch(epoch):
        raise DataError(f"epoch {epoch!r:.40}: expected 16 hexadecimal digits")
    present = said.get("present")
    if not reports and present is None:
        raise DataError("neither reports nor a present state; expected one of them")
    return Payload(
        _text(said, "robot"), epoch, _whole(said.get("sent"), "sent"), _whole(said.get("waiting"), "waiting"), reports,
        None if present is None else _present(present), size,
    )  # fmt: skip


def _json(body: bytes) -> tuple[dict[str, Any], int]:
    """What a body says, and the length of its text."""
    opened = zlib.decompressobj()
    try:
        text = opened.decompress(body, MOST_TEXT)
        if opened.unconsumed_tail:
            raise DataError(f"more than {MOST_TEXT // 1_000_000} MB uncompressed; expected less")
        if not opened.eof or opened.unused_data:
            raise DataError("the compressed text has no end, or something behind it")
        said = json.loads(text, parse_constant=_no_number)
    except (zlib.error, ValueError, RecursionError) as error:
        raise DataError(f"cannot be read: {error}; expected JSON compressed by zlib") from None
    if not isinstance(said, dict):
        raise DataError("expected a JSON object")
    return said, len(text)


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is no JSON")


def _report(row: object, width: int, places: Sequence[int | None]) -> Report:
    if not isinstance(row, list) or len(row) != width:
        raise DataError(f"reports: expected rows of {width} values, one for each column")
    seq, time, thinned = (_whole(value, name) for value, name in zip(row, ("seq", "time", "thinned"), strict=False))
    if seq < 1:
        raise DataError("seq: expected at least 1")
    return Report(seq, time, thinned, tuple(math.nan if at is None else _figure(row[at]) for at in places))


def _figure(value: object) -> float:
    if value is None:
        return math.nan
    if value == "Infinity":
        return math.inf
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300:
        return float(value)
    raise DataError(f"reports: {value!r:.40}; expected a number, null or 'Infinity'")


def _present(said: object) -> PresentState:
    if not isinstance(said, dict):
        raise DataError("present: expected an object")
    ledger, report = _text(said, "ledger"), said.get("report")
    try:
        found = json.loads(ledger)
    except (ValueError, RecursionError) as error:
        raise DataError(f"ledger: {error}; expected the text of a JSON object") from None
    if not isinstance(found, dict) or not isinstance(report, dict | None):
        raise DataError("present: expected the ledger and the report as objects")
    if report is not None:
        _text(report, "robot"), _text(report, "design_hash")
        if report.get("time") is not None:
            _whole(report["time"], "time of the report")
    ahead = (report or {}).get("failure_within", [])
    if not isinstance(ahead, list) or len(ahead) > MOST_HORIZONS:
        raise DataError(f"failure_within: expected a list of at most {MOST_HORIZONS}")
    return PresentState(_whole(said.get("revision"), "revision"), ledger, report, tuple(map(_ahead, ahead)))


def _ahead(said: object) -> Ahead:
    if not isinstance(said, dict):
        raise DataError("failure_within: expected objects")
    first, share = said.get("first"), said.get("share")
    if not isinstance(first, str | None) or len(first or "") > LONGEST_PATH:
        raise DataError(f"first: expected the path of a part, of at most {LONGEST_PATH} letters, or null")
    share = None if share is None else _figure(share)
    return Ahead(_figure(said.get("horizon")), _figure(said.get("sensor_based_failure")), first, share)


def _text(said: Mapping[str, Any], name: str) -> str:
    value = said.get(name)
    if not isinstance(value, str):
        raise DataError(f"{name}: expected a text")
    return value


def _whole(value: object, name: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= _LARGEST:
        raise DataError(f"{name} {value!r:.40}: expected a whole number from 0 on")
    return value
