"""The basis of a report: the sensors that are bound, and which design, data and programs it is made of."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version
from typing import Any

from robophm.core.signal import SECOND
from robophm.design.robot import Channel, MeasuredClock, Robot
from robophm.report.markup import Html
from robophm.report.page import table_html
from robophm.report.words import duration_text, number_text
from robophm.stores.figures import FigureSeries

_HOUR = 3600 * SECOND
_PROGRAMS = ("robophm", "numpy", "scipy")


def sensors(robot: Robot) -> Iterator[Html]:
    """Yield a table of every bound signal: what it drives, in which parts, which values count and for how long."""
    bound: dict[tuple[str, str, str, str, str, str], list[str]] = {}
    for path, drives, signal, source in _bindings(robot):
        bound.setdefault((signal, drives, *_terms(source)), []).append(path)
    if bound:
        rows = [
            (signal, drives, _whose(paths, robot.name), *terms) for (signal, drives, *terms), paths in bound.items()
        ]
        yield table_html(
            ["signal", "drives", "of", "unit", "believed", "holds", "then"],
            rows,
            "A value holds so long; after that the part is taken to be as the last column says",
        )


def _bindings(robot: Robot) -> Iterator[tuple[str, str, str, Channel | MeasuredClock | None]]:
    """Path of a part, what is driven, by which signal, and how."""
    if robot.powered:
        yield robot.name, "whether it is on", robot.powered, None
    for name, clock in robot.clocks.items():
        for signal in clock.signals:
            yield robot.name, f"{name} (clock)", signal, clock
    for part in robot.all_components():
        for mode in part.modes:
            for stress in mode.stresses:
                for name, channel in stress.channels.items():
                    yield part.path, name, channel.signal, channel
            if (own := mode.measured_clock) and own not in robot.clocks.values():
                for signal in own.signals:
                    yield part.path, f"{own.clock} (clock)", signal, own


def _terms(source: Channel | MeasuredClock | None) -> tuple[str, str, str, str]:
    if source is None:
        return "", "", "", ""
    holds = duration_text(source.max_age / _HOUR)
    if isinstance(source, MeasuredClock):
        return source.unit, "", holds, ""
    low, high = (number_text(bound) for bound in (source.low, source.high))
    return source.unit, f"{low} … {high}", holds, source.stale


def _whose(paths: Sequence[str], robot: str) -> str:
    """The paths of few parts; for many, how many of which level."""
    unique = list(dict.fromkeys(paths))
    if len(unique) <= 2:
        return ", ".join(unique)
    common: list[str] = []
    for steps in zip(*(path.split("/") for path in unique), strict=False):
        if len(set(steps)) > 1:
            break
        common.append(steps[0])
    return f"{len(unique)} parts of {'/'.join(common) or robot}"


def made_of(robot: Robot, ledger: Mapping[str, Any] | None, series: FigureSeries | None) -> Html:
    """The design and the data, each with its SHA-256, and the versions of what worked it out."""
    data = data_hash(ledger, series)
    rows = [
        ("design", robot.name, robot.design_hash),
        ("data", "the robot's past: its sums and its figures so far" if data else "none: as designed", data),
        *(("program", f"{name} {version(name)}", "") for name in _PROGRAMS),
        ("program", f"Python {platform.python_version()}", ""),
    ]
    caption = (
        "The same design, data and programs give the same bytes; a hash is of the content, not of how it is written"
    )
    return table_html(["", "what", "SHA-256"], rows, caption, "lll")


def data_hash(ledger: Mapping[str, Any] | None, series: FigureSeries | None) -> str:
    """SHA-256 of a robot's past, its ledger and the series of its figures as plain values; "" where it has none."""
    if (series is None or not len(series.times)) and (ledger is None or ledger["started"] is None):
        return ""
    content = json.dumps([ledger, series.to_json() if series else None], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(content.encode()).hexdigest()
