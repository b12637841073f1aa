"""The wear of one failure mode by its readings: trend, change against its start, and when its threshold is reached."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robophm.core.errors import DataError
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.learning.failure_mode_edits import named_mode
from robophm.learning.wear.cusum import Cusum, design
from robophm.learning.wear.readings_table import Readings, read_readings
from robophm.learning.wear.wiener_and_gamma import FEWEST, Array, Process, Wear, at_load, wear


@dataclass(frozen=True)
class WearOptions:
    """How readings are taken."""

    process: Process = "wiener"
    baseline: int = 100
    """Readings at the start that were sound."""
    between_false_alarms: float = 1000.0
    """Readings, in the mean."""
    shift: float = 1.0
    """That shall be seen [deviations]."""
    seed: int = 0
    """Of what is drawn."""


@dataclass(frozen=True)
class WornMode:
    """What readings say of a failure mode."""

    mode: FailureMode
    source: str
    """Where the readings are from, in words."""
    readings: Readings
    values: Array
    """The readings, as they would be at the load at which they are compared; shape (readings,)."""
    wear: Wear
    detector: Cusum
    alarms: tuple[int, ...]
    """Which readings say that something has changed."""

    @property
    def unit(self) -> str:
        """Of the time of the readings."""
        return "h" if self.readings.dated else CLOCK_UNITS[self.mode.clock]

    @property
    def alarmed(self) -> list[float]:
        """When something had changed [``unit``]."""
        return [float(self.readings.times[i]) for i in self.alarms]


_USUAL = WearOptions()


def worn_mode(
    mode: FailureMode, source: str, readings: Readings, threshold: float, *, load: float | None = None,
    options: WearOptions = _USUAL,
) -> WornMode:  # fmt: skip
    """Of readings that begin below or above the threshold, and so rise or fall to it.

    ``load`` is that at which readings are compared, where they come with their loads. Raises DataError, with the
    source, where they are too few or say nothing of a trend.
    """
    values, baseline = readings.values, options.baseline
    if len(values) <= baseline:
        raise DataError(f"{source}: {len(values)} readings, and a baseline of {baseline} (--baseline); expected more")
    try:
        if readings.load is not None and load is not None:
            values = at_load(values, readings.load, baseline, load)
        begun = float(np.median(values[:FEWEST]))
        if threshold == begun:
            raise DataError(f"the signal begins at its threshold, {threshold:g}; expected one that it has yet to reach")
        found = wear(
            readings.times, values, threshold, process=options.process, falls=threshold < begun,
            width=readings.width, seed=options.seed,
        )  # fmt: skip
        detector = design(values[:baseline], options.between_false_alarms, options.shift)
    except DataError as error:
        raise DataError(f"{source}: {error}") from None
    alarms = tuple(baseline + i for i in detector.alarms(values[baseline:])[1])
    return WornMode(mode, source, readings, values, found, detector, alarms)


def worn_mode_of_table(
    robot: Robot, path: Path, part: str, *, threshold: float | None = None, load: float | None = None,
    options: WearOptions = _USUAL,
) -> WornMode:  # fmt: skip
    """Of a table of readings of one part, or failure mode, by its path; the threshold is the design's unless given.

    Raises DataError where the table is none, the part is several, or what would be needed is not said.
    """
    mode = named_mode(robot, part)
    if (several := next(one.quantity for one in robot.all_components() if mode in one.modes)) > 1:
        raise DataError(
            f"'{mode.path}' is {several} equal parts, and one signal shows the wear of one; expected them as "
            "components of their own"
        )
    if threshold is None and mode.wear:
        threshold = mode.wear.threshold
    if threshold is None:
        raise DataError(f"{path}: at which value is '{mode.path}' worn out? expected --threshold")
    readings = read_readings(path, CLOCK_UNITS[mode.clock])
    if (readings.load is None) != (load is None):
        raise DataError(f"{path}: a column 'load' and --load, the load at which readings are compared: expected both")
    return worn_mode(mode, str(path), readings, threshold, load=load, options=options)
