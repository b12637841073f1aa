"""The wear of one failure mode by its readings: trend, change against its start, and when its threshold is reached."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from robophm.core.errors import DataError
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.learning.failure_mode_edits import named_mode
from robophm.learning.wear.among_others import Unit
from robophm.learning.wear.averaging import Forecast
from robophm.learning.wear.backtest import Backtest, backtest
from robophm.learning.wear.conditions import as_of_late, forecast_under
from robophm.learning.wear.cusum import Cusum, design
from robophm.learning.wear.index_backtest import LearnedIndex
from robophm.learning.wear.readings_table import Array, Readings, at_load, read_readings
from robophm.learning.wear.stated_life import StatedLife
from robophm.learning.wear.teachers import others_of_table, teachers_of

FIRST = 8
"""Readings, or a quarter of them if that is less, whose median says on which side of the threshold a signal begins."""


@dataclass(frozen=True)
class WearOptions:
    """Options of how readings are judged."""

    baseline: int = 100
    """Readings at the start that were sound."""
    between_false_alarms: float = 1000.0
    """Mean number of readings between false alarms."""
    shift: float = 1.0
    """Shift that is to be seen [deviations]."""
    seed: int = 0
    """Seed of all that is drawn."""
    changes: bool = True
    """Whether changes are looked for, which takes seconds."""


@dataclass(frozen=True)
class WornMode:
    """The wear of a failure mode, from its readings."""

    mode: FailureMode
    source: str
    """The source of the readings, in words."""
    readings: Readings
    values: Array
    """The readings, as they would be at the load at which they are compared; shape (readings,)."""
    deviation: float
    """Standard deviation of the threshold."""
    wear: Forecast
    detector: Cusum | None
    """The detector of changes; None where changes could not be looked for."""
    unlooked: str
    """The reason why changes could not be looked for; empty where they could."""
    alarms: tuple[int, ...]
    """Indices of the readings that say that something has changed."""
    others: tuple[Unit, ...] = ()
    """Units of its kind, as teachers."""
    to_come: Mapping[str, float] = field(default_factory=dict)
    """Conditions under which its life is foretold."""
    stated: StatedLife | None = None
    """Life that is stated of the mode; None where its age at the readings is not known."""
    index: LearnedIndex | None = None
    """The index of health of many signals that its readings are (``indexed_mode.py``); None: readings of one signal."""

    @property
    def unit(self) -> str:
        """Return the unit of the readings' time."""
        return "h" if self.readings.dated else CLOCK_UNITS[self.mode.clock]

    @property
    def alarmed(self) -> list[float]:
        """Return the times when something had changed [``unit``]."""
        return [float(self.readings.times[i]) for i in self.alarms]

    @property
    def critical(self) -> bool:
        """Whether its threshold is or was reached, or no model follows it."""
        return self.wear.worn_out or not self.wear.followed

    def backtested(self, seed: int = 0) -> Backtest:
        """Return the forecasts at earlier readings against what came.

        Raises DataError, with the source, where there can be none: of an index of health, see ``index.backtested()``.
        """
        if self.index:
            raise DataError(f"{self.source}: it has not failed; expected the backtest of the units that did")
        times, threshold = self.readings.times, self.wear.signal_threshold
        try:
            return backtest(
                times, self.values, threshold, falls=self.wear.turned, deviation=self.deviation, others=self.others,
                seed=seed, stated=self.stated, conditions=self.readings.conditions,
            )  # fmt: skip
        except DataError as error:
            raise DataError(f"{self.source}: {error}") from None

    def when(self, time: float) -> int | None:
        """The date of a time of its clock, between two readings evenly [ns since the epoch]; None without dates."""
        if self.readings.when is None:
            return None
        first = int(self.readings.when[0])
        return first + round(float(np.interp(time, self.readings.times, self.readings.when - first)))


_USUAL = WearOptions()


def begins_at(values: Array) -> float:
    """The level at which readings begin: the median of the first few."""
    return float(np.median(values[: min(FIRST, max(len(values) // 4, 1))]))


def worn_mode(
    mode: FailureMode, source: str, readings: Readings, threshold: float, *, deviation: float = 0.0,
    load: float | None = None, options: WearOptions = _USUAL, others: Sequence[Unit] = (),
    to_come: Mapping[str, float] | None = None, stated: StatedLife | None = None,
) -> WornMode:  # fmt: skip
    """Judge the wear of a mode by readings that begin below or above the threshold, and so rise or fall to it.

    ``deviation``: how well the threshold is known; ``load``: that at which readings are compared, where they come with
    their loads; ``others``: units of its kind, as teachers; ``to_come``: conditions under which it goes on, where
    readings come with some, else as recently; ``stated``: the life that the design states. Raises DataError, with the
    source, where readings are too few or cannot be wear.
    """
    values, to_come = readings.values, _to_come(readings.conditions, to_come or {})
    try:
        if readings.load is not None and load is not None:
            values = at_load(values, readings.load, options.baseline, load)
        begun = begins_at(values)
        if threshold == begun:
            raise DataError(f"the signal begins at its threshold, {threshold:g}; expected one that it has yet to reach")
        found = forecast_under(
            to_come, Unit(readings.times, values, conditions=readings.conditions), threshold, others,
            falls=threshold < begun, deviation=deviation, seed=options.seed, stated=stated,
        )  # fmt: skip
    except DataError as error:
        raise DataError(f"{source}: {error}") from None
    detector, unlooked, alarms = changes_in(values, options) if options.changes else (None, "not asked for", ())
    return WornMode(
        mode, source, readings, values, deviation, found, detector, unlooked, alarms, tuple(others), to_come,
        stated=stated,
    )  # fmt: skip


def _to_come(conditions: Mapping[str, Array], stated: Mapping[str, float]) -> dict[str, float]:
    """Conditions as stated, else as recently."""
    return as_of_late(conditions) | dict(stated)


def changes_in(values: Array, options: WearOptions) -> tuple[Cusum | None, str, tuple[int, ...]]:
    """Return the detector of changes, or why there is none, and the readings that alarm."""
    baseline = options.baseline
    if len(values) <= baseline:
        return None, f"{len(values)} readings, and a baseline needs {baseline} before the first one judged", ()
    try:
        detector = _designed(values[:baseline].tobytes(), options)
    except DataError as error:
        return None, str(error), ()
    return detector, "", tuple(baseline + i for i in detector.alarms(values[baseline:])[1])


@lru_cache(maxsize=64)
def _designed(baseline: bytes, options: WearOptions) -> Cusum:
    """A detector for this baseline, whose design takes seconds."""
    return design(np.frombuffer(baseline), options.between_false_alarms, options.shift, options.seed)


def one_mode(robot: Robot, part: str) -> FailureMode:
    """A failure mode by its path, of one part alone. Raises DataError where the part is several."""
    mode = named_mode(robot, part)
    if (several := next(one.quantity for one in robot.all_components() if mode in one.modes)) > 1:
        raise DataError(
            f"'{mode.path}' is {several} equal parts, and one signal shows the wear of one; expected them as "
            "components of their own"
        )
    return mode


def worn_mode_of_table(
    robot: Robot, path: Path, part: str, *, threshold: float | None = None, deviation: float | None = None,
    load: float | None = None, options: WearOptions = _USUAL, fleet: Path | None = None,
    to_come: Mapping[str, float] | None = None,
) -> WornMode:  # fmt: skip
    """The wear of a failure mode, or of a part with one, from a table of readings.

    The threshold is the design's unless given. ``fleet``: a table of the same signal of other units, with a column
    ``unit``; else those that the design names, where the table has nothing that theirs have not. Raises DataError where
    a table is none, the part is several, or what would be needed is not said.
    """
    mode = one_mode(robot, part)
    if threshold is None and mode.wear:
        threshold = mode.wear.threshold
        deviation = mode.wear.threshold_deviation if deviation is None else deviation
    if threshold is None:
        raise DataError(f"{path}: at which value is '{mode.path}' worn out? expected its threshold")
    readings = read_readings(path, CLOCK_UNITS[mode.clock])
    if (readings.load is None) != (load is None):
        raise DataError(f"{path}: a column 'load', and the load at which readings are compared: expected both")
    others: Sequence[Unit] = ()
    if fleet:
        others = others_of_table(fleet, mode.clock, dated=readings.dated, load=load)
    elif not (readings.dated or readings.conditions or load is not None):
        others = teachers_of(robot).get(mode.path, ())
    stated = None if readings.dated else StatedLife(mode.life, 0.0)
    return worn_mode(
        mode, str(path), readings, threshold, deviation=deviation or 0.0, load=load, options=options, others=others,
        to_come=to_come, stated=stated,
    )  # fmt: skip
