"""The wear of one failure mode by its readings: trend, change against its start, and when its threshold is reached."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from robophm.core.errors import DataError
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.learning.failure_mode_edits import named_mode
from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import Forecast
from robophm.learning.wear.backtest import Backtest, backtest
from robophm.learning.wear.cusum import Cusum, design
from robophm.learning.wear.readings_table import Array, Readings, at_load, read_readings, read_units

FIRST = 8
"""Readings, or a quarter of them if that is less, whose median says on which side of the threshold a signal begins."""


@dataclass(frozen=True)
class WearOptions:
    """How readings are taken."""

    baseline: int = 100
    """Readings at the start that were sound."""
    between_false_alarms: float = 1000.0
    """Readings, in the mean."""
    shift: float = 1.0
    """That shall be seen [deviations]."""
    seed: int = 0
    """Of what is drawn."""
    changes: bool = True
    """Whether changes are looked for, which takes seconds."""


@dataclass(frozen=True)
class WornMode:
    """What readings say of a failure mode."""

    mode: FailureMode
    source: str
    """Where the readings are from, in words."""
    readings: Readings
    values: Array
    """The readings, as they would be at the load at which they are compared; shape (readings,)."""
    deviation: float
    """How well the threshold is known."""
    wear: Forecast
    detector: Cusum | None
    """Of change; None where it could not be looked for."""
    unlooked: str
    """Why it could not; empty where it could."""
    alarms: tuple[int, ...]
    """Which readings say that something has changed."""
    others: tuple[Unit, ...] = ()
    """Units of its kind, as teachers."""

    @property
    def unit(self) -> str:
        """Of the time of the readings."""
        return "h" if self.readings.dated else CLOCK_UNITS[self.mode.clock]

    @property
    def alarmed(self) -> list[float]:
        """When something had changed [``unit``]."""
        return [float(self.readings.times[i]) for i in self.alarms]

    @property
    def critical(self) -> bool:
        """Whether its threshold is or was reached, or no model follows it."""
        return self.wear.worn_out or not self.wear.followed

    def backtested(self, seed: int = 0) -> Backtest:
        """What would have been foretold at earlier readings. Raises DataError, with the source, where nothing could."""
        times, threshold = self.readings.times, self.wear.signal_threshold
        try:
            return backtest(
                times, self.values, threshold, falls=self.wear.turned, deviation=self.deviation, others=self.others,
                seed=seed,
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
) -> WornMode:  # fmt: skip
    """Of readings that begin below or above the threshold, and so rise or fall to it.

    ``deviation``: how well the threshold is known; ``load``: that at which readings are compared, where they come with
    their loads; ``others``: units of its kind, as teachers. Raises DataError, with the source, where readings are too
    few or cannot be wear.
    """
    values = readings.values
    try:
        if readings.load is not None and load is not None:
            values = at_load(values, readings.load, options.baseline, load)
        begun = begins_at(values)
        if threshold == begun:
            raise DataError(f"the signal begins at its threshold, {threshold:g}; expected one that it has yet to reach")
        found = forecast_among(
            others, readings.times, values, threshold, falls=threshold < begun, deviation=deviation, seed=options.seed
        )
    except DataError as error:
        raise DataError(f"{source}: {error}") from None
    detector, unlooked, alarms = changes_in(values, options) if options.changes else (None, "not asked for", ())
    return WornMode(mode, source, readings, values, deviation, found, detector, unlooked, alarms, tuple(others))


def changes_in(values: Array, options: WearOptions) -> tuple[Cusum | None, str, tuple[int, ...]]:
    """What looks for changes, or why none are looked for, and which readings alarm."""
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
    """Which takes seconds, once for each baseline."""
    return design(np.frombuffer(baseline), options.between_false_alarms, options.shift, options.seed)


def worn_mode_of_table(
    robot: Robot, path: Path, part: str, *, threshold: float | None = None, deviation: float | None = None,
    load: float | None = None, options: WearOptions = _USUAL, fleet: Path | None = None,
) -> WornMode:  # fmt: skip
    """Of a table of readings of one part, or failure mode, by its path; the threshold is the design's unless given.

    ``fleet``: a table of the same signal of other units, with a column ``unit``. Raises DataError where a table is
    none, the part is several, or what would be needed is not said.
    """
    mode = named_mode(robot, part)
    if (several := next(one.quantity for one in robot.all_components() if mode in one.modes)) > 1:
        raise DataError(
            f"'{mode.path}' is {several} equal parts, and one signal shows the wear of one; expected them as "
            "components of their own"
        )
    if threshold is None and mode.wear:
        threshold = mode.wear.threshold
        deviation = mode.wear.threshold_deviation if deviation is None else deviation
    if threshold is None:
        raise DataError(f"{path}: at which value is '{mode.path}' worn out? expected --threshold")
    readings = read_readings(path, CLOCK_UNITS[mode.clock])
    if (readings.load is None) != (load is None):
        raise DataError(f"{path}: a column 'load' and --load, the load at which readings are compared: expected both")
    others = _others(fleet, CLOCK_UNITS[mode.clock], readings) if fleet else ()
    return worn_mode(
        mode, str(path), readings, threshold, deviation=deviation or 0.0, load=load, options=options, others=others
    )


def _others(path: Path, unit: str, readings: Readings) -> list[Unit]:
    """Units of a table, whose readings must be like those of the one that is asked about."""
    found = []
    for name, one in read_units(path, unit).items():
        if one.load is not None or readings.load is not None:
            raise DataError(f"{path}: readings that come with a load are not compared between units; expected none")
        if one.dated != readings.dated:
            raise DataError(
                f"{path}: unit {name!r:.40} has dates or ages where the other readings have not; expected alike"
            )
        if len(one.times) < 2:
            raise DataError(f"{path}: unit {name!r:.40} has one reading; expected at least two")
        found.append(Unit(one.times, one.values))
    return found
