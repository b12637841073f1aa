"""A log of failures: what failed, in which robot, how old it was, and what was done about it.

Every row is a part at a moment: it failed, or it still worked (``censored``). What was done then says how old the part
is that goes on: a new one begins at 0, a repaired one keeps a share of its age (Kijima 1989, model II: V ← q·V).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from robophm.core.errors import DataError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design.robot import CLOCK_UNITS, Component, FailureMode, Robot
from robophm.learning.rates.life_scale import Lived
from robophm.learning.table import YES, Row, date_of, read_table

COLUMNS: Mapping[str, Sequence[str]] = {
    "part": ("component", "failure mode", "mode"),
    "robot": ("unit", "serial", "vehicle"),
    "when": ("date", "time", "datetime"),
    "exposure": ("age", "at"),
    "since": (),
    "censored": ("suspended", "working"),
    "action": ("done", "service"),
    "remaining": ("q",),
    "count": ("quantity", "n"),
}
"""Columns of a log, and how else they may be headed."""

ACTIONS = {"replaced": ("replace", "new", "replacement"), "repaired": ("repair",), "none": ("-", "nothing")}
_DAY = 24.0

LONGEST = 1e15
"""The greatest age of a part, in the unit of its clock; the least above 0 is as far below 1."""


@dataclass
class Seen:
    """The experience of one failure mode in one robot, all its equal parts and all their lives together."""

    mode: FailureMode
    robot: str
    failures: float = 0.0
    expected: float = 0.0
    """Cumulative hazard by the design's rate, as it is."""
    exposure: float = 0.0
    """Exposure of all parts together [unit of its clock]."""
    lives: list[Lived] = field(default_factory=list)
    """Stretches of lives, where failures in an exposure say too little (``life_scale.py``)."""


def merged(seen: Iterable[Seen]) -> list[Seen]:
    """Return the experience added up for each failure mode and robot."""
    found: dict[tuple[str, str], Seen] = {}
    for one in seen:
        if (key := (one.mode.path, one.robot)) in found:
            there = found[key]
            found[key] = Seen(one.mode, one.robot, there.failures + one.failures, there.expected + one.expected,
                              there.exposure + one.exposure, there.lives + one.lives)  # fmt: skip
        else:
            found[key] = one
    return list(found.values())


@dataclass
class FailureLog:
    """The contents of a log, by failure mode and robot."""

    seen: list[Seen]
    notes: list[str]
    """Remarks on what the log leaves open."""


@dataclass
class _Item:
    """A part of a robot, as far as the log has been read."""

    went: dict[str, float] = field(default_factory=dict)
    """Advance of its clocks since it was put in, by unit."""
    virtual: dict[str, float] = field(default_factory=dict)
    """Age of each failure mode after its repairs, by path."""
    last: Row | None = None
    when: float | None = None
    """Time of the last row [h]."""
    begun: bool = False
    open: bool = False
    """Whether a part was put in of which nothing has been said since."""


def read_failure_log(path: Path, robot: Robot) -> FailureLog:
    """The exposures and failures of a log. Raises DataError, with the line, for what contradicts itself."""
    rows = read_table(path, COLUMNS, "failures")
    reader = _Reader(robot)
    for item, some in reader.in_order(rows).items():
        for row in some:
            reader.take(item, row)
    return FailureLog(list(reader.seen.values()), reader.notes())


class _Reader:
    def __init__(self, robot: Robot) -> None:
        self.parts = {part.path: part for part in robot.all_components() if part not in robot.causes}
        self.modes = {mode.path: (part, mode) for part in self.parts.values() for mode in part.modes}
        self.items: dict[tuple[str, str], _Item] = {}
        self.seen: dict[tuple[str, str], Seen] = {}

    def in_order(self, rows: Sequence[Row]) -> dict[tuple[str, str], list[Row]]:
        """The rows of each part of each robot: in order of their dates where all have one, else of their lines."""
        found: dict[tuple[str, str], list[Row]] = {}
        for row in rows:
            part, index = self._named(row)[0], self._named(row)[2]
            alone = part.quantity == 1 or index
            where = f"{part.path}{index}" if alone else f"{part.path} {row.line}"  # each a life of its own
            found.setdefault((row.text("robot"), where), []).append(row)
        for item, some in found.items():
            if all("when" in row.cells for row in some):
                found[item] = sorted(some, key=lambda row: (_hours(row), row.line))
        return found

    def _named(self, row: Row) -> tuple[Component, FailureMode | None, str]:
        """The part, the failure mode if one is named, and which of the equal parts."""
        path = row.text("part")
        if not path:
            raise row.error("is empty; expected a part of the design", "part")
        if path in self.modes and path not in self.parts:
            part, mode = self.modes[path]
            return part, mode, ""
        stem, bracket, rest = path.partition("[")
        if stem in self.parts:
            part = self.parts[stem]
            number, _, mode_name = rest.partition("]")
            if bracket and not (number.isascii() and number.isdigit() and 1 <= int(number) <= part.quantity):
                raise row.error(f"'{path}'; there are [1] … [{part.quantity}]", "part")
            if mode_name and (named := f"{stem}{mode_name}") in self.modes:
                return part, self.modes[named][1], f"[{number}]"
            if not mode_name:
                return part, part.modes[0] if len(part.modes) == 1 else None, f"[{number}]" if bracket else ""
        raise row.error(f"no part '{path}' in the design{nearest(path, [*self.parts, *self.modes])}", "part")

    def take(self, key: tuple[str, str], row: Row) -> None:
        """Take in one row of a part."""
        part, mode, index = self._named(row)
        item = self.items.setdefault(key, _Item())
        censored = row.choice("censored", YES, "no") == "yes"
        action = row.choice("action", ACTIONS, "none" if censored else "replaced")
        if not censored and mode is None:
            names = ", ".join(f"'{one.path}'" for one in part.modes)
            raise row.error(f"'{part.path}' failed, but by which of its modes is not said; expected {names}", "part")
        if action == "none" and not censored:
            action = "replaced"  # and nothing follows, or what follows is another part
        if action == "repaired" and part.quantity > 1 and not index:
            raise row.error(f"which of {part.quantity} was repaired? expected '{part.path}[1]' or such", "part")
        count = self._count(row, part, index, censored)
        went = self._exposure(row, part, None if censored else mode)
        self._in_time(item, row, went)
        self._begin(item, row, part)
        for one in part.modes:
            unit = CLOCK_UNITS[one.clock]
            if unit not in went:
                continue
            before = item.went.get(unit, 0.0)
            step = went[unit] - before
            if step < 0:
                said = (
                    f"line {item.last.line} says {before:g} {unit}" if item.last else f"it began at {before:g} {unit}"
                )
                raise row.error(
                    f"{went[unit]:g} {unit} contradicts itself: {said}, and it was not replaced since", "exposure"
                )
            age = item.virtual[one.path]
            seen = self.seen.setdefault((one.path, key[0]), Seen(one, key[0]))
            seen.expected += count * float(one.life.increment(age, step))
            seen.exposure += count * step
            if one.life.degree is None:
                failed = count if not censored and one is mode else 0
                seen.lives.append(Lived(age, step, failed, count))
            item.virtual[one.path] = age + step
        if not censored and mode is not None:
            if not went[CLOCK_UNITS[mode.clock]] > 0:
                raise row.error("failed at an age of 0, before it worked, which says nothing of a rate; expected above "
                                "0, or no such row", "exposure")  # fmt: skip
            self.seen[mode.path, key[0]].failures += count
        item.went |= went
        item.last, item.begun, item.open = row, True, False
        self._serve(item, row, part, mode, action)

    def _begin(self, item: _Item, row: Row, part: Component) -> None:
        if "since" in row.cells and not (item.went or item.begun):
            item.went = self._exposure(row, part, None, "since")
        elif "since" in row.cells:
            raise row.error("is of the first row of a part alone", "since")
        for one in part.modes:
            item.virtual.setdefault(one.path, item.went.get(CLOCK_UNITS[one.clock], 0.0))

    def _serve(self, item: _Item, row: Row, part: Component, mode: FailureMode | None, action: str) -> None:
        if "remaining" in row.cells and action != "repaired":
            raise row.error("is of a repair; expected action: repaired", "remaining")
        if action == "replaced":
            item.went, item.virtual, item.open = {}, {one.path: 0.0 for one in part.modes}, True
        elif action == "repaired":
            left = row.number("remaining", 1.0)
            if not 0 <= left <= 1:
                raise row.error(f"{left:g}; expected 0 (as good as new) to 1 (as before the repair)", "remaining")
            for one in part.modes if mode is None else (mode,):
                item.virtual[one.path] *= left

    @staticmethod
    def _count(row: Row, part: Component, index: str, censored: bool) -> int:
        number = row.number("count", 1.0)
        if number != int(number) or not 1 <= number <= 1_000_000:
            raise row.error(f"{row.text('count')}; expected a whole number, 1 … 1,000,000", "count")
        if number > 1 and index:
            raise row.error(f"{number:g} of '{part.path}{index}', which is one part", "count")
        if number > 1 and part.quantity == 1 and row.text("robot"):
            raise row.error(f"{number:g}, but a robot has one '{part.path}'", "count")
        return int(number)

    @staticmethod
    def _exposure(row: Row, part: Component, failed: FailureMode | None, column: str = "exposure") -> dict[str, float]:
        """The advance of each clock of a part, by unit: '1200 h', or '1200 h; 340 km'."""
        if not row.text(column):
            raise row.error("is empty; expected how old the part was, e.g. 1200 h", column)
        units = dict.fromkeys(CLOCK_UNITS[mode.clock] for mode in part.modes)
        found: dict[str, float] = {}
        for written in row.text(column).split(";"):
            for unit in units:
                try:
                    quantity(f"{written} {row.units.get(column, '')}", unit)
                except UnitError:
                    try:
                        quantity(written, unit)
                    except UnitError:
                        continue
                value = row.quantity(column, unit, written.strip())
                if value < 0:
                    raise row.error(f"{written.strip()} is negative; expected the age of the part, at least 0", column)
                if value > LONGEST or 0 < value < 1 / LONGEST:
                    raise row.error(f"{written.strip()} is no age of a part; expected 0 … {LONGEST:g} {unit}", column)
                if unit in found:
                    raise row.error(f"states {unit} twice", column)
                found[unit] = value
                break
            else:
                row.quantity(column, next(iter(units)), written.strip())  # says why not
        if failed is not None and (unit := CLOCK_UNITS[failed.clock]) not in found:
            raise row.error(f"says nothing in {unit}, in which '{failed.path}' ages ({failed.clock} clock)", column)
        return found

    def _in_time(self, item: _Item, row: Row, went: Mapping[str, float]) -> None:
        """No clock goes faster than time does, but for the day within which a date may lie."""
        if "when" not in row.cells:
            return
        when = _hours(row)
        if item.when is not None and "h" in went:
            passed, step = when - item.when, went["h"] - item.went.get("h", 0.0)
            if step > passed + _DAY:
                raise row.error(
                    f"{step:,.0f} h since line {item.last.line if item.last else 0}, which is {max(passed, 0):,.0f} h "
                    "earlier by its date; expected at most that",
                    "exposure",
                )
        item.when = when

    def notes(self) -> list[str]:
        """Return remarks on what the log leaves open."""
        open_ = sum(item.open for item in self.items.values() if item.last and "robot" in item.last.cells)
        if not open_:
            return []
        return [
            f"of {open_} part{'s' * (open_ > 1)} the log ends with a replacement: what the new ones have worked since "
            "is not counted, and rates come out too high; add a row with censored: yes for each"
        ]


def _hours(row: Row) -> float:
    """A date, or seconds since the epoch, as hours since it."""
    try:
        return date_of(row, "when").timestamp() / 3600
    except DataError:
        with suppress(ValueError):
            if math.isfinite(seconds := float(row.text("when"))):
                return seconds / 3600
        raise
