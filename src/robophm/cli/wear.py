"""``robophm wear``: the trend of signals that show wear, when they changed, and what remains of parts and robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import typer

from robophm.blocks.diagram import Block
from robophm.cli import BREACHED
from robophm.cli.shared.options import Design, Json, Store
from robophm.cli.shared.output import console, print_json, print_table, print_unknown, progress_console, table, warn
from robophm.cli.shared.progress import counted
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import DataError, RobophmError
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS, FailureMode, Robot
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.unknown_rates import PartsOfUnknownRate, marked, marks, unknown
from robophm.health.worn import Worn, remaining_life
from robophm.learning.failure_mode_edits import named_mode
from robophm.learning.wear.cusum import CORRELATED, Cusum, design
from robophm.learning.wear.readings_table import Readings, read_readings
from robophm.learning.wear.trend_bend import FALSE_ALARMS
from robophm.learning.wear.wiener_and_gamma import FEWEST, Array, Process, Wear, at_load, wear
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_history import WearHistory, wear_history, worn_modes
from robophm.report.curve import sparkline
from robophm.report.words import duration_text, moment_text, number_text

TABLES = (".csv", ".tsv", ".yaml", ".yml")
"""Suffixes of tables of readings; all else is recordings."""


class Life(NamedTuple):
    """A remaining life, and what parts of unknown rate make of it."""

    hours: RemainingLife
    unknown: PartsOfUnknownRate | None


Lives = dict[str, tuple[Life, Life]]
"""By name: by hazards alone, and with the wear in the place of the failure modes' hazards."""


@dataclass(frozen=True)
class Wishes:
    """What is asked."""

    part: str | None
    threshold: float | None
    process: Process
    load: float | None
    baseline: int
    between_false_alarms: float
    shift: float
    store: Path | None
    skip_missing: bool
    seed: int
    as_json: bool


@dataclass(frozen=True)
class _Found:
    mode: FailureMode
    source: str
    readings: Readings
    values: Array
    wear: Wear
    detector: Cusum
    alarms: tuple[int, ...]
    """Which readings."""

    @property
    def unit(self) -> str:
        return "h" if self.readings.dated else CLOCK_UNITS[self.mode.clock]

    @property
    def alarmed(self) -> list[float]:
        """When."""
        return [float(self.readings.times[i]) for i in self.alarms]


def command(
    design: Design,
    signals: Annotated[
        list[Path],
        typer.Argument(
            help="recordings (.bag, .mcap, .db3, .journal, folders) with the signals that the design names at `wear`, "
            "or a table: time [h] or when, value",
            metavar="RECORDING…|SIGNAL.CSV",
        ),
    ],
    part: Annotated[
        str | None,
        typer.Option(help="path of the part, or its failure mode, whose wear it shows; default all with `wear`"),
    ] = None,
    threshold: Annotated[
        float | None, typer.Option(help="of a table: at which it has failed; of a signal that falls, below the first")
    ] = None,
    process: Annotated[Literal["wiener", "gamma"], typer.Option(help="gamma: it only grows")] = "wiener",
    load: Annotated[
        float | None, typer.Option(help="of a table: at which readings are compared, by their column load")
    ] = None,
    baseline: Annotated[int, typer.Option(help="readings at the start that were sound", min=30)] = 100,
    false_alarms: Annotated[float, typer.Option(help="one in so many readings", min=10)] = 1000.0,
    shift: Annotated[float, typer.Option(help="deviations that shall be seen", min=0.1, max=10)] = 1.0,
    store: Store = None,
    skip_missing: Annotated[
        bool, typer.Option("--skip-missing", help="signals that all recordings lack stay silent")
    ] = False,
    seed: Annotated[int, typer.Option(help="of what is drawn", min=0)] = 0,
    as_json: Json = False,
) -> None:
    """The wear that signals show: trend, change, and what remains of parts and robot; exit code 1 at a threshold."""
    wishes = Wishes(part, threshold, process, load, baseline, false_alarms, shift, store, skip_missing, seed, as_json)
    if run(design, signals, wishes):
        raise typer.Exit(BREACHED)


def run(path: Path, signals: Sequence[Path], wishes: Wishes) -> bool:
    """Fit, look for a change, fuse with the hazards of all else, print; whether a threshold is reached."""
    robot = load(path)
    fitted = ("part", "process", "baseline", "false_alarms", "shift", "store", "seed")
    if any(signal.suffix.lower() in TABLES for signal in signals):
        refuse_unused("a table", (*fitted, "threshold", "load"))
        found, monitor = [_of_table(robot, signals, wishes)], Monitor(robot)
    else:
        refuse_unused(
            "recordings, whose threshold and load are in the design, at the part's `wear`", (*fitted, "skip_missing")
        )
        found, monitor = _of_recordings(robot, signals, wishes)
    if wishes.store:
        monitor = Monitor(robot, kept(wishes.store, robot))
    outlook = monitor.report(remaining_life=False).outlooks["sensor_based"]
    lives = _lives(robot, outlook, found)
    if wishes.as_json:
        print_json(_json(robot, found, lives))
    else:
        _print(robot, found, lives, wishes)
    return any(one.wear.remaining.median == 0 for one in found)


def _of_table(robot: Robot, signals: Sequence[Path], wishes: Wishes) -> _Found:
    if len(signals) > 1:
        (signal, *_) = [one for one in signals if one.suffix.lower() in TABLES]
        raise DataError(f"{signal} is a table, of one signal; expected it alone, or recordings")
    (signal,) = signals
    if wishes.part is None:
        raise DataError(f"{signal}: whose wear is it? expected --part, the path of a part or of its failure mode")
    mode = named_mode(robot, wishes.part)
    if (several := next(one.quantity for one in robot.all_components() if mode in one.modes)) > 1:
        raise DataError(
            f"'{mode.path}' is {several} equal parts, and one signal shows the wear of one; expected them as "
            "components of their own"
        )
    threshold = wishes.threshold
    if threshold is None and mode.wear:
        threshold = mode.wear.threshold
    if threshold is None:
        raise DataError(f"{signal}: at which value is '{mode.path}' worn out? expected --threshold")
    readings = read_readings(signal, CLOCK_UNITS[mode.clock])
    if (readings.load is None) != (wishes.load is None):
        raise DataError(f"{signal}: a column 'load' and --load, the load at which readings are compared: expected both")
    return _judged(mode, str(signal), readings, threshold, wishes)


def _of_recordings(robot: Robot, signals: Sequence[Path], wishes: Wishes) -> tuple[list[_Found], Monitor]:
    """What the signals say that the design names; where one of several says too little, the others are told."""
    modes = worn_modes(robot, wishes.part)
    with counted(progress_console(), "reading") as advance:
        history = wear_history(robot, signals, modes, skip_missing=wishes.skip_missing, advance=advance)
    for what, count in sorted(history.notes.items()):
        warn(f"{what} ({count:,} times)" if count > 1 else what)
    found: list[_Found] = []
    missed: list[DataError] = []
    for mode in modes:
        try:
            found.append(_of_history(mode, history, wishes))
        except DataError as error:
            missed.append(error)
    if not found:
        raise missed[0]
    for one in missed:
        warn(f"{one}; it is left out")
    return found, history.monitor


def _of_history(mode: FailureMode, history: WearHistory, wishes: Wishes) -> _Found:
    said = mode.wear
    if not said or mode.path not in history.readings:
        signal = said.gauge.signal if said else ""
        raise DataError(f"'{mode.path}': no sample of {signal} counts; expected some, as its `wear` says")
    source = f"{mode.path}, {said.reading} of {said.gauge.signal}"
    source += f" above {said.ambient.signal}" if said.ambient else ""
    source += f" at {said.load.signal} {said.load.low:g} … {said.load.high:g}" if said.load else ""
    return _judged(mode, source, history.readings[mode.path], said.threshold, wishes)


def _judged(mode: FailureMode, source: str, readings: Readings, threshold: float, wishes: Wishes) -> _Found:
    values, baseline = readings.values, wishes.baseline
    if len(values) <= baseline:
        raise DataError(f"{source}: {len(values)} readings, and a baseline of {baseline} (--baseline); expected more")
    try:
        if readings.load is not None and wishes.load is not None:
            values = at_load(values, readings.load, baseline, wishes.load)
        begun = float(np.median(values[:FEWEST]))
        if threshold == begun:
            raise DataError(f"the signal begins at its threshold, {threshold:g}; expected one that it has yet to reach")
        found = wear(
            readings.times, values, threshold, process=wishes.process, falls=threshold < begun,
            width=readings.width, seed=wishes.seed,
        )  # fmt: skip
        detector = design(values[:baseline], wishes.between_false_alarms, wishes.shift)
    except DataError as error:
        raise DataError(f"{source}: {error}") from None
    alarms = tuple(baseline + i for i in detector.alarms(values[baseline:])[1])
    return _Found(mode, source, readings, values, found, detector, alarms)


def _lives(robot: Robot, outlook: Outlook, found: Sequence[_Found]) -> Lives:
    worn = {}
    for one in found:
        i = next(k for k, mode in enumerate(robot.modes) if mode.path == one.mode.path)
        future = outlook.future
        pace = 1.0 if one.readings.dated else float(future.advance[i, -1] / future.hours[-1])
        if not pace > 0:
            raise RobophmError(f"'{one.mode.path}' does not age by the design's usage; expected dates (column 'when')")
        worn[i] = lambda hours, wear=one.wear, pace=pace: wear.cumulative_hazard(np.asarray(hours) * pace)

    def both(diagram: Block, some: Worn) -> tuple[Life, Life]:
        seen = {robot.modes[i].path for i in some}
        return (
            Life(outlook.remaining_life(diagram), unknown(outlook, diagram)),
            Life(remaining_life(outlook, diagram, some), unknown(outlook, diagram, seen=seen)),
        )

    lives = {
        robot.modes[i].path: both(outlook.plant.alone[int(outlook.plant.part[i])], {i: one}) for i, one in worn.items()
    }
    return {**lives, robot.name: both(robot.diagram, worn)}


_WRONG = {None: "that of a straight trend", "accelerating": "too long", "slowing": "too short"}


def _holds(name: str, robot: Robot, found: Sequence[_Found]) -> bool:
    """Whether no wear that counts in a remaining life bends: of one failure mode, or by its name of the robot."""
    return not any(one.wear.bend.direction for one in found if name in (one.mode.path, robot.name))


def _print(robot: Robot, found: Sequence[_Found], lives: Lives, wishes: Wishes) -> None:
    out = console()
    for one in found:
        _print_one(one, wishes)
        out.print()
    rows = []
    for name, both in lives.items():
        with_wear = "with its wear" if _holds(name, robot, found) else "with its wear, as if it did not bend"
        for what, life in zip(("by hazard alone", with_wear), both, strict=True):
            mark = marks(life.unknown)[2]
            times = (life.hours.early, life.hours.median, life.hours.late)
            rows.append([f"{name} {what}", *(marked(mark, duration_text(time)) for time in times)])
    columns = ["", "5 % by", "median", "95 % by"]
    print_table(out, table("Remaining life, calendar time", columns, rows, figures=(1, 2, 3)))
    by_hazard, fused = lives[robot.name]
    print_unknown(by_hazard.unknown, robot)
    if by_hazard.unknown and not fused.unknown:
        out.print("With the wear nothing is left out: it says what no rate does", markup=False)


def _print_one(found: _Found, wishes: Wishes) -> None:
    out, unit, values, times = console(), found.unit, found.values, found.readings.times

    def say(text: str, style: str = "") -> None:
        out.print(text, style=style, markup=False, soft_wrap=True)

    first, last = (number_text(float(values[i])) for i in (0, -1))
    span = number_text(float(np.ptp(times)))
    say(f"{found.source}: {len(values)} readings over {span} {unit}, {first} to {last}", "bold")
    say(sparkline(values, 60))
    low, median, high = (number_text(1000 * one, 3) for one in found.wear.trend)
    noise = f"; noise of a reading {number_text(found.wear.noise, 2)}" if found.wear.noise else ""
    say(f"Trend: {median} per 1000 {unit}, 90 % between {low} and {high}{noise}")
    low, median, high = (number_text(one, 3) for one in found.wear.remaining)
    never = float(np.mean(np.isinf(found.wear.passage)))
    or_never = f"; never with {number_text(100 * never, 2)} %" if never > 0.005 else ""
    threshold = found.wear.threshold * (-1 if found.wear.turned else 1)
    if found.wear.remaining.median == 0:
        say(f"Has reached {threshold:g}", "bold red")
    else:
        say(f"Reaches {threshold:g} in {median} {unit}, 90 % between {low} and {high}{or_never}")
    bend = found.wear.bend
    if bend.direction:
        say(
            f"The trend bends, it is {bend.direction} (p = {number_text(bend.p_value, 2)}): what is said of life is of "
            f"a straight one, {_WRONG[bend.direction]}, and does not hold", "bold yellow",
        )  # fmt: skip
    else:
        say(
            f"No bend of the trend is told (p = {number_text(bend.p_value, 2)}; of straight ones 1 in "
            f"{1 / FALSE_ALARMS:g} is taken for bent): what is said of life holds of a straight one alone"
        )
    at = "none"
    if found.alarms:
        at = f"at {number_text(found.alarmed[0])} {unit}"
        if found.readings.when is not None:
            at += f", {moment_text(int(found.readings.when[found.alarms[0]]))[:19]}"
    say(
        f"Change against the first {wishes.baseline} readings: {at} (CUSUM for shifts of {wishes.shift:g} deviations: "
        f"falsely once in {found.detector.between_false_alarms:g} readings, such a shift seen after "
        f"{number_text(found.detector.delay, 2)})"
    )
    if abs(found.detector.correlation) > CORRELATED:
        correlation = number_text(found.detector.correlation, 2)
        say(f"Readings of the baseline follow one another (correlation {correlation}): false alarms come more often "
            "than that", "yellow")  # fmt: skip


def _json(robot: Robot, found: Sequence[_Found], lives: Lives) -> dict[str, Any]:
    def life(one: Life) -> Any:
        life, left_out = one
        return {"early": life.early, "median": life.median, "late": life.late, "mean": life.mean,
                **({"unknown": asdict(left_out)} if left_out else {})}  # fmt: skip

    return {
        "robot": robot.name,
        "signals": [
            {
                "mode": one.mode.path,
                "unit": one.unit,
                "readings": len(one.values),
                "trend": one.wear.trend._asdict(),
                "noise": one.wear.noise,
                "remaining": one.wear.remaining._asdict(),
                "never": float(np.mean(np.isinf(one.wear.passage))),
                "bend": {
                    "direction": one.wear.bend.direction,
                    "p": one.wear.bend.p_value,
                    "false_alarms": FALSE_ALARMS,
                    "life_is": _WRONG[one.wear.bend.direction],
                },
                "change": {
                    "mean": one.detector.mean,
                    "deviation": one.detector.deviation,
                    "limit": one.detector.limit,
                    "between_false_alarms": one.detector.between_false_alarms,
                    "delay": one.detector.delay,
                    "correlation": one.detector.correlation,
                    "alarms": one.alarmed,
                },
            }
            for one in found
        ],
        "remaining_life": {
            name: {"hazard": life(a), "fused": {**life(b), "holds": _holds(name, robot, found)}}
            for name, (a, b) in lives.items()
        },
    }
