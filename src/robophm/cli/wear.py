"""``robophm wear``: the trend of a signal that shows wear, when it changed, and what remains of part and robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robophm.cli.output import console, print_json, print_table, table
from robophm.cli.past import kept
from robophm.core.errors import DataError, RobophmError
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.worn import remaining_life
from robophm.learning.change import CORRELATED, Cusum, design
from robophm.learning.evidence import named_mode
from robophm.learning.wear import Array, Process, Wear, at_load, wear
from robophm.learning.wear_data import Readings, read_readings
from robophm.monitor import Monitor
from robophm.report.curve import sparkline
from robophm.report.words import duration_text, number_text

Lives = dict[str, tuple[RemainingLife, RemainingLife]]
"""By name: by hazards alone, and with the wear in the place of its failure mode's."""


@dataclass(frozen=True)
class Wishes:
    """What is asked."""

    part: str
    threshold: float
    process: Process
    load: float | None
    baseline: int
    between_false_alarms: float
    shift: float
    store: Path | None
    seed: int
    as_json: bool


@dataclass(frozen=True)
class _Found:
    mode: FailureMode
    readings: Readings
    values: Array
    wear: Wear
    detector: Cusum
    alarms: list[float]
    """When."""
    lives: Lives

    @property
    def unit(self) -> str:
        return "h" if self.readings.dated else CLOCK_UNITS[self.mode.clock]


def run(path: Path, signal: Path, wishes: Wishes) -> None:
    """Fit, look for a change, fuse with the hazards of all else, print."""
    robot = load(path)
    mode = named_mode(robot, wishes.part)
    readings = read_readings(signal, CLOCK_UNITS[mode.clock])
    values = readings.values
    if (readings.load is None) != (wishes.load is None):
        raise DataError(f"{signal}: a column 'load' and --load, the load at which readings are compared: expected both")
    if len(values) <= wishes.baseline:
        raise DataError(
            f"{signal}: {len(values)} readings, and a baseline of {wishes.baseline} (--baseline); expected more"
        )
    if readings.load is not None and wishes.load is not None:
        values = at_load(values, readings.load, wishes.baseline, wishes.load)
    falls = wishes.threshold < values[0]
    found = wear(readings.times, values, wishes.threshold, process=wishes.process, falls=falls, seed=wishes.seed)
    detector = design(values[: wishes.baseline], wishes.between_false_alarms, wishes.shift)
    alarms = [float(readings.times[wishes.baseline + i]) for i in detector.alarms(values[wishes.baseline :])[1]]
    monitor = Monitor(robot, kept(wishes.store, robot) if wishes.store else None)
    outlook = monitor.report(remaining_life=False).outlooks["sensor_based"]
    lives = _lives(robot, outlook, mode, found, readings)
    all_of_it = _Found(mode, readings, values, found, detector, alarms, lives)
    if wishes.as_json:
        print_json(_json(robot, all_of_it))
    else:
        _print(signal, all_of_it, wishes)


def _lives(robot: Robot, outlook: Outlook, mode: FailureMode, found: Wear, readings: Readings) -> Lives:
    i = next(k for k, one in enumerate(robot.modes) if one.path == mode.path)
    pace = 1.0 if readings.dated else float(outlook.future.advance[i, -1] / outlook.future.hours[-1])
    if not pace > 0:
        raise RobophmError(f"'{mode.path}' does not age by the design's usage; expected dates (column 'when')")
    worn = {i: lambda hours: found.cumulative_hazard(np.asarray(hours) * pace)}
    diagrams = {mode.path: outlook.plant.alone[int(outlook.plant.part[i])], robot.name: robot.diagram}
    return {
        name: (outlook.remaining_life(diagram), remaining_life(outlook, diagram, worn))
        for name, diagram in diagrams.items()
    }


def _print(signal: Path, found: _Found, wishes: Wishes) -> None:
    out, unit, values, times = console(), found.unit, found.values, found.readings.times

    def say(text: str, style: str = "") -> None:
        out.print(text, style=style, markup=False, soft_wrap=True)

    first, last = (number_text(float(values[i])) for i in (0, -1))
    say(f"{signal}: {len(values)} readings over {number_text(float(np.ptp(times)))} {unit}, {first} to {last}", "bold")
    say(sparkline(values, 60))
    low, median, high = (number_text(1000 * one, 3) for one in found.wear.trend)
    noise = f"; noise of a reading {number_text(found.wear.noise, 2)}" if found.wear.noise else ""
    say(f"Trend: {median} per 1000 {unit}, 90 % between {low} and {high}{noise}")
    low, median, high = (number_text(one, 3) for one in found.wear.remaining)
    never = float(np.mean(np.isinf(found.wear.passage)))
    or_never = f"; never with {number_text(100 * never, 2)} %" if never > 0.005 else ""
    say(f"Reaches {wishes.threshold:g} in {median} {unit}, 90 % between {low} and {high}{or_never}")
    at = f"at {number_text(found.alarms[0])} {unit}" if found.alarms else "none"
    say(
        f"Change against the first {wishes.baseline} readings: {at} (CUSUM for shifts of {wishes.shift:g} deviations: "
        f"falsely once in {found.detector.between_false_alarms:g} readings, such a shift seen after "
        f"{number_text(found.detector.delay, 2)})"
    )
    if abs(found.detector.correlation) > CORRELATED:
        correlation = number_text(found.detector.correlation, 2)
        say(f"Readings of the baseline follow one another (correlation {correlation}): false alarms come more often "
            "than that", "yellow")  # fmt: skip
    rows = []
    for name, both in found.lives.items():
        for what, life in zip(("by hazard alone", "with its wear"), both, strict=True):
            rows.append([f"{name} {what}", *(duration_text(one) for one in (life.early, life.median, life.late))])
    out.print()
    columns = ["", "5 % by", "median", "95 % by"]
    print_table(out, table("Remaining life, calendar time", columns, rows, figures=(1, 2, 3)))


def _json(robot: Robot, found: _Found) -> dict[str, Any]:
    def finite(values: Any) -> Any:
        return {key: value if value is not None and math.isfinite(value) else None for key, value in values.items()}

    def life(one: RemainingLife) -> Any:
        return finite({"early": one.early, "median": one.median, "late": one.late, "mean": one.mean})

    detector = found.detector
    return {
        "robot": robot.name,
        "mode": found.mode.path,
        "unit": found.unit,
        "trend": finite(found.wear.trend._asdict()),
        "noise": found.wear.noise,
        "remaining": finite(found.wear.remaining._asdict()),
        "never": float(np.mean(np.isinf(found.wear.passage))),
        "change": {
            "mean": detector.mean,
            "deviation": detector.deviation,
            "limit": detector.limit,
            "between_false_alarms": detector.between_false_alarms,
            "delay": detector.delay,
            "correlation": detector.correlation,
            "alarms": found.alarms,
        },
        "remaining_life": {name: {"hazard": life(a), "fused": life(b)} for name, (a, b) in found.lives.items()},
    }
