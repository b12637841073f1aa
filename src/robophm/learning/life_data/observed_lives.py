"""Life data: how long parts lived, exactly or within bounds, at which stresses; impossible data are refused."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError, UnitError, nearest
from robophm.core.units import conversion, quantity
from robophm.design.robot import CLOCK_UNITS
from robophm.learning.life_data.fate_words import FATE_COLUMNS, Fate, fate, fate_column
from robophm.learning.table import Row, read_table

Array = npt.NDArray[np.float64]

COLUMNS: Mapping[str, Sequence[str]] = {
    "time": (
        "life",
        "t",
        "x",
        "age",
        "failure",
        "failure time",
        "exposure",
        "hours",
        "cycles",
        "duration",
        "durations",
        "times",
        "event times",
        "survival",
        "survival time",
        "stop",
        "tstop",
    ),
    "from": ("left", "lower", "lower bound", "lower_bound", "after", "xl"),
    "to": ("right", "upper", "upper bound", "upper_bound", "before", "xr"),
    "since": ("entry", "late entry", "truncated", "tl", "start", "tstart"),
    **FATE_COLUMNS,
    "mode": ("failure mode", "failure_mode", "cause"),
    "count": ("n", "quantity", "number", "number of events", "weights"),
    "item": ("unit", "serial", "id", "i", "system"),
}
"""Columns of a table of lives; any other column is a stress, if its name is known or the user says that it is."""

STRESS_UNITS: Mapping[str, str] = {
    "temperature": "degC",
    "humidity": "percent",
    "voltage": "V",
    "load": "",
    "temperature_swing": "K",
}
"""The unit inside of each stress that an acceleration of a design knows."""

UNKNOWN_TRUNCATION: Collection[str] = ("tr", "right truncated", "right truncation")
"""Columns of the ages beyond which a failure would not be in the table, as SurPyval has them: no fit here knows it."""

_NO_MODE = ("none", "-", "na", "censored", "0")

LONGEST = 1e15
"""The longest life, in the unit of its clock; the shortest is as far below 1."""


@dataclass(frozen=True)
class LifeData:
    """Lives between ``low`` and ``high``, equal where a failure was seen; shapes (rows,). Times count from 0."""

    source: str
    low: Array
    """Lower bound of each life; 0: failed before ``high``."""
    high: Array
    """Upper bound of each life; infinite: still worked at ``low``."""
    count: Array
    unit: str
    """h, km, cycle or start; "" where the data state none."""
    stresses: Mapping[str, Array] = field(default_factory=dict)
    """Stresses by name, in the unit inside; shape (rows,)."""
    items: tuple[str, ...] = ()
    """The name of the part that each row is of; empty where the table has none."""
    since: Array = field(default_factory=lambda: np.empty(0))
    """Age at which each began to be watched: those that failed before it are not among them (left truncation). Shape
    (rows,), or empty where all are watched from 0 on."""
    modes: tuple[str, ...] = ()
    """The failure mode of each row, "" where the part still worked; empty where the table has none."""

    @property
    def failed(self) -> npt.NDArray[np.bool_]:
        """Whether each row is a failure, at a time known or not."""
        return np.isfinite(self.high)

    @property
    def failures(self) -> int:
        """Return the number of parts that failed."""
        return int(self.count[self.failed].sum())

    @property
    def parts(self) -> int:
        """Return the number of parts."""
        return int(self.count.sum())

    @property
    def longest(self) -> float:
        """Longest time that anything was seen at."""
        return float(np.where(np.isfinite(self.high), self.high, self.low).max())

    @property
    def began(self) -> Array:
        """``since`` of every row."""
        return self.since if len(self.since) else np.zeros(len(self.low))

    @property
    def items_repeat(self) -> bool:
        """Whether an item has several rows: its repairs, or steps of stress."""
        return len(set(self.items)) < len(self.items)

    def described(self) -> str:
        """Return the data in words: '10 failures and 10 that still worked'."""
        exact = self.low == self.high
        kinds = {
            "failure": exact,
            "failure before a time": self.failed & ~exact & (self.low == 0),
            "failure within an interval": self.failed & ~exact & (self.low > 0),
            "that still worked": ~self.failed,
        }
        texts = []
        for name, which in kinds.items():
            if number := int(self.count[which].sum()):
                texts.append(
                    f"{number} {name if number == 1 or 'worked' in name else name.replace('failure', 'failures', 1)}"
                )
        if late := int(self.count[self.began > 0].sum()):
            texts[-1] += f" ({late} not watched from new)"
        return " and ".join(filter(None, [", ".join(texts[:-1]), texts[-1]])) if texts else "nothing"


def read_life_data(path: Path, stresses: Collection[str] = ()) -> LifeData:
    """A table of lives, CSV or the list ``lives`` of a YAML file. Raises DataError, with the line.

    ``stresses``: columns that are such, beside those of known names (``STRESS_UNITS``).
    """
    rows = read_table(path, COLUMNS, "lives", free=True)
    unit = _unit(rows)
    names = dict.fromkeys(name for row in rows for name in row.cells if name not in COLUMNS)
    for name in [*names]:
        cells = {row.text(name).casefold() for row in rows}
        if name.casefold() in UNKNOWN_TRUNCATION:
            if cells <= {"inf", "+inf", "infinity", "na", ""}:  # truncates nothing
                del names[name]
                continue
            raise DataError(
                f"{path}: column '{name}': right truncation (lives that would not be in the table had they been "
                "longer) is known to no fit here; expected all that were watched, those that still worked as censored"
            )
        if name in stresses or name in STRESS_UNITS:
            continue
        hint = nearest(name, [*COLUMNS, *STRESS_UNITS])
        fate = (
            " If it says which failed, head it 'event' (1: it failed) or 'censored' (1: it still worked)."
            if cells <= {"0", "1", "0.0", "1.0", "true", "false", "yes", "no", ""} else ""
        )  # fmt: skip
        raise DataError(
            f"{path}: column '{name}' is not known{hint}{'' if hint.endswith('?') else '.'}{fate} If it is a stress, "
            f"at which {name} will parts be used? expected a stress of use, or no such column"
        )
    column = fate_column(str(path), rows)
    bounds = [_bounds(row, unit, column) for row in rows]
    counts = []
    for row in rows:
        number = row.number("count", 1.0)
        if number != int(number) or not 0 <= number <= 1e9:
            raise row.error(f"{row.text('count')}; expected a whole number", "count")
        counts.append(number)
    stresses = {name: np.array([_stress(row, name) for row in rows]) for name in names}
    items = tuple(row.text("item") for row in rows)
    modes = _modes(rows, bounds)
    low, high, since = (np.array(side) for side in zip(*bounds, strict=True))
    some = np.array(counts) > 0
    if not some.any():
        raise DataError(f"{path}: all counts are 0; expected parts")
    return LifeData(
        str(path), low[some], high[some], np.array(counts)[some], unit,
        {name: values[some] for name, values in stresses.items()},
        tuple(item for item, is_ in zip(items, some, strict=True) if is_) if any(items) else (),
        since[some] if since.any() else np.empty(0),
        tuple(mode for mode, is_ in zip(modes, some, strict=True) if is_) if modes else (),
    )  # fmt: skip


def life_data(
    failures: Sequence[float] = (), censored: Sequence[float] = (), *, unit: str = "h", source: str = "data",
    stresses: Mapping[str, Sequence[float]] | None = None,
) -> LifeData:  # fmt: skip
    """Life data of failures and of parts that still worked [unit]; stresses of the former, then of the latter."""
    low = np.array([*failures, *censored], dtype=float)
    high = np.array([*failures, *[math.inf] * len(censored)], dtype=float)
    return LifeData(source, low, high, np.ones(len(low)), unit,
                    {name: np.array(values, dtype=float) for name, values in (stresses or {}).items()})  # fmt: skip


def _unit(rows: Sequence[Row]) -> str:
    """The clock's unit in which all times can be said; "" where none is stated. Raises DataError for a mixture."""
    known: dict[str, Row] = {}
    for row in rows:
        for column in ("time", "from", "to", "since"):
            if column not in row.cells:
                continue
            written = row.text(column)
            bare = _is_number(written)
            stated = row.units.get(column, "") if bare else written.lstrip("+-.0123456789eE").strip()
            inside = ""
            if stated:
                inside = next((unit for unit in dict.fromkeys(CLOCK_UNITS.values()) if _converts(stated, unit)), "?")
                if inside == "?" and not bare and stated == written:
                    raise row.error(f"{written!r:.60} is no time; expected a number with its unit, e.g. 5 h", column)
                if inside == "?":
                    said = f"'{stated:.40}' in its heading" if bare else f"{written!r:.60}"
                    raise row.error(f"{said} is no unit of life; expected h, km, cycles or starts", column)
            known.setdefault(inside, row)
            if len(known) > 1:
                first, second = known
                raise row.error(
                    f"{written!r:.60} is in {second or 'no unit'}, but line {known[first].line} is in "
                    f"{first or 'no unit'}; expected one clock for all",
                    column,
                )
    if not known:
        headed = ", ".join(f"'{one:.40}'" for one in [*rows[0].headings.values()][:8])
        raise DataError(f"{rows[0].table}: has no times; expected a column 'time [h]', or 'from [h]' and 'to [h]', "
                        f"not {headed} alone")  # fmt: skip
    return next(iter(known))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _converts(written: str, unit: str) -> bool:
    try:
        conversion(written, unit)
    except UnitError:
        return False
    return True


def _bounds(row: Row, unit: str, column: str) -> tuple[float, float, float]:
    """Between which a part failed, and since when it was watched. Raises DataError for times that cannot be."""
    became = fate(row, column)
    low, high = _seen_at(row, unit, became, column) if "time" in row.cells else _seen_within(row, unit, became, column)
    since = _time(row, unit, "since", 0.0)
    known = low == high or high == math.inf
    if since and (since >= high or (since >= low if known else since > low > 0)):
        raise row.error(f"{row.text('since')} is not before the part was last seen; expected when one began to watch",
                        "since")  # fmt: skip
    return max(low, since), high, since


def _time(row: Row, unit: str, column: str, missing: float) -> float:
    if column not in row.cells:
        return missing
    if column == "to" and row.text(column).casefold() in ("inf", "infinity", "na"):
        return math.inf
    if column in ("since", "from") and row.text(column).casefold() in ("-inf", "-infinity", "na"):
        return 0.0
    value = row.quantity(column, unit)
    if value < 0:
        raise row.error(f"{row.text(column)} is negative; expected a life, above 0", column)
    if value > LONGEST or 0 < value < 1 / LONGEST:
        raise row.error(f"{row.text(column)} is no life; expected {1 / LONGEST:g} … {LONGEST:g} {unit}", column)
    return value


def _seen_at(row: Row, unit: str, became: Fate, column: str) -> tuple[float, float]:
    if "from" in row.cells or "to" in row.cells:
        raise row.error("states a time and an interval too; expected one of the two")
    at = _time(row, unit, "time", math.nan)
    if at == 0:
        raise row.error("a life of 0; expected above 0: what never worked is counted apart, not fitted", "time")
    if became == "within":
        raise row.error("failed within an interval, but states one time; expected from and to", column)
    return {"failed": (at, at), "worked": (at, math.inf), "left": (0.0, at)}[became]


def _seen_within(row: Row, unit: str, became: Fate, column: str) -> tuple[float, float]:
    low, high = _time(row, unit, "from", 0.0), _time(row, unit, "to", math.inf)
    if low == 0 and high == math.inf:
        raise row.error("says nothing: neither time nor from nor to; expected one")
    if low > high:
        raise row.error(f"from {low:g} to {high:g} contradicts itself; expected the lower end first", "from")
    if high == 0:
        raise row.error("a life of 0; expected above 0", "to")
    if became == "worked" and high not in (low, math.inf):
        raise row.error(f"still worked, and failed before {high:g}: contradicts itself", column)
    return (low, math.inf) if became == "worked" else (0.0, high) if became == "left" else (low, high)


def _modes(rows: Sequence[Row], bounds: Sequence[tuple[float, float, float]]) -> list[str]:
    """In which way each failed, where the table says it of any. Raises DataError where it does not of all."""
    if not any("mode" in row.cells for row in rows):
        return []
    for row, (_, high, _) in zip(rows, bounds, strict=True):
        if high < math.inf and "mode" not in row.cells:
            raise row.error("failed, but in which way is not said; expected it of every failure, or of none", "mode")
        if high < math.inf and row.text("mode").casefold() in _NO_MODE:
            raise row.error(f"failed, with '{row.text('mode'):.40}' as the way in which it did; expected the mode, or "
                            "that it still worked (censored: yes)", "mode")  # fmt: skip
        if high == math.inf and "mode" in row.cells and row.text("mode").casefold() not in _NO_MODE:
            raise row.error(f"'{row.text('mode'):.40}' of a part that still worked; expected none", "mode")
    return [row.text("mode") if high < math.inf else "" for row, (_, high, _) in zip(rows, bounds, strict=True)]


def _stress(row: Row, name: str) -> float:
    if name not in row.cells:
        raise row.error(f"has no {name}; expected it in every row", name)
    inside = STRESS_UNITS.get(name)
    if inside is None or (not row.units.get(name) and _is_number(row.text(name)) and not inside):
        return row.number(name)
    value = row.quantity(name, inside)
    if name == "temperature" and value <= -273.15:
        raise row.error(f"{row.text(name)} is below absolute zero", name)
    return value


def written_quantity(text: str, name: str) -> float:
    """A stress as a user writes it, in the unit inside. Raises DataError."""
    inside = STRESS_UNITS.get(name)
    try:
        return float(text) if inside is None else quantity(text, inside)
    except (UnitError, ValueError) as error:
        raise DataError(f"{name} '{text:.40}': {error}") from None
