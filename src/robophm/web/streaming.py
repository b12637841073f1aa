"""The stream of values that one browser watches, in binary frames.

A frame is: the length of its header (uint32, little-endian), the header as JSON in UTF-8 padded with blanks to a
multiple of 8 bytes together with that length, then for each series of the header its times [s since the epoch] and its
values, float64, little-endian. The header says ``series``: [[name, number of points], …]; of a ``history`` its ``id``;
and always the state of monitoring, how often its figures were made, and the revision of the design. A ``batch`` says
``gaps`` of the series watched, where they are others than were said last: {name: [[from, to], …]} [s since the epoch].
These are the silences of a signal, and of a figure when the robot was off; ``to`` is null while one lasts, and ``now``
is the time of the robot.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robophm.web.series import Gap, Points
from robophm.web.service import Service

PERIOD = 0.1
"""Seconds between two frames."""

HEARTBEAT = 2.0
"""Seconds after which a frame comes although nothing is new."""

MOST_WATCHED = 200
LONGEST_NAME = 1000
MOST_PIXELS = 4000
MOST_HISTORIES = 50


class Viewer:
    """The service's side of one WebSocket."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._board = service.monitoring.board
        self._seen: dict[str, int] = {}
        """Points of each watched series that have been sent."""
        self._first: dict[str, tuple[float, int]] = {}
        """Series that were never sent: seconds back, and pixels."""
        self._histories: list[tuple[int, str, float, float, int]] = []
        self._said: tuple[object, ...] = ()
        self._gaps: dict[str, list[Gap]] = {}
        """The silences of each watched series, as last said."""
        self._spoke = 0.0

    def hear(self, said: Any) -> None:
        """Take a client's wish: ``{"watch": [names], "seconds": 30, "pixels": 800}`` from now on, or once ``{"history":
        name, "id": 1, "from": s, "to": s, "pixels": 800}``. Raises ValueError, TypeError, KeyError.
        """
        if not isinstance(said, dict):
            raise TypeError("no object")
        if "watch" in said:
            names = [_name(name) for name in said["watch"]][:MOST_WATCHED]
            seconds, pixels = _number(said.get("seconds", 30.0), 0.0, 1e7), _pixels(said)
            self._seen = {name: seen for name, seen in self._seen.items() if name in names}
            self._first = {name: (seconds, pixels) for name in names if name not in self._seen}
            self._gaps = {name: gaps for name, gaps in self._gaps.items() if name in self._seen}
        if "history" in said:
            if len(self._histories) >= MOST_HISTORIES:
                raise ValueError("too many at once")
            span = _number(said["from"], -1e12, 1e12), _number(said["to"], -1e12, 1e12)
            self._histories.append((int(_number(said["id"], 0, 2**31)), _name(said["history"]), *span, _pixels(said)))

    def frame(self) -> bytes | None:
        """Return the next frame; None where there is nothing to say."""
        board = self._service.monitoring.board
        if board is not self._board:  # monitoring has begun anew
            self._board = board
            self._first |= dict.fromkeys(self._seen, (30.0, 800))
            self._seen, self._gaps = {}, {}
        if self._histories:
            number, name, start, end, pixels = self._histories.pop(0)
            series = board.get(name)
            points = series.between(start, end, pixels) if series else Points(np.empty(0), np.empty(0))
            return encode({"kind": "history", "id": number, **self._state()}, {name: points})
        found: dict[str, Points] = {}
        for name in list(self._first):
            if (series := board.get(name)) and series.count:
                seconds, pixels = self._first.pop(name)
                self._seen[name] = series.count
                last = board.last([name])[name][0]
                found[name] = series.between(last - seconds, last, pixels)
        for name, seen in self._seen.items():
            series = board.get(name)
            last_count = series.count if series else 0
            if series and last_count > seen and name not in found:
                found[name] = series.since(seen, last_count)
                self._seen[name] = last_count
        gaps = {name: gaps for name in self._seen if (gaps := board.gaps(name)) != self._gaps.get(name, [])}
        self._gaps |= gaps
        state = self._state()
        said, now = tuple(state.values()), time.monotonic()
        if not found and not gaps and said == self._said and now - self._spoke < HEARTBEAT:
            return None
        self._said, self._spoke = said, now
        of_time = {"now": board.now} if math.isfinite(board.now) else {}
        return encode({"kind": "batch", **state, **of_time, "gaps": gaps}, found)

    def _state(self) -> dict[str, Any]:
        run = self._service.monitoring.run
        return {
            "monitoring": self._service.monitoring.state,
            "looks": run.looks if run else 0,
            "revision": self._service.workspace.revision,
            "outside": self._service.changed_outside,
        }


def encode(header: Mapping[str, Any], series: Mapping[str, Points]) -> bytes:
    """Return one frame of the stream: a header and the points of its series."""
    names: Sequence[Any] = [[name, len(points.times)] for name, points in series.items()]
    text = json.dumps({**header, "series": names}, separators=(",", ":")).encode()
    text += b" " * (-(len(text) + 4) % 8)
    arrays = (array.astype("<f8").tobytes() for points in series.values() for array in points)
    return b"".join((len(text).to_bytes(4, "little"), text, *arrays))


def _name(value: Any) -> str:
    if not isinstance(value, str) or len(value) > LONGEST_NAME:
        raise TypeError("no name")
    return value


def _number(value: Any, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError("no such number")
    return float(value)


def _pixels(said: Mapping[str, Any]) -> int:
    return int(_number(said.get("pixels", 800), 1, MOST_PIXELS))
