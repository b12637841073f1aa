"""``robophm wear``: the trend of signals that show wear, when they changed, and what remains of parts and robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import typer

from robophm.cli import BREACHED
from robophm.cli.shared.options import Design, Json, Store
from robophm.cli.shared.output import console, print_json, print_table, print_unknown, progress_console, table, warn
from robophm.cli.shared.progress import counted
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import DataError
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.unknown_rates import marked, marks
from robophm.learning.wear.trend_bend import FALSE_ALARMS
from robophm.learning.wear.worn_mode import WearOptions, WornMode, worn_mode_of_table
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_history import wear_history, worn_in, worn_modes
from robophm.monitoring.worn_life import Life, WornLife, worn_lives
from robophm.report.curve import sparkline
from robophm.report.words import duration_text, moment_text, number_text

TABLES = (".csv", ".tsv", ".yaml", ".yml")
"""Suffixes of tables of readings; all else is recordings."""


@dataclass(frozen=True)
class Wishes:
    """What is asked."""

    part: str | None
    threshold: float | None
    load: float | None
    options: WearOptions
    store: Path | None
    skip_missing: bool
    as_json: bool


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
    options = WearOptions(process, baseline, false_alarms, shift, seed)
    wishes = Wishes(part, threshold, load, options, store, skip_missing, as_json)
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
    lives = worn_lives(outlook, found)
    if wishes.as_json:
        print_json(_json(robot, found, lives))
    else:
        _print(robot, found, lives, wishes)
    return any(one.wear.worn_out for one in found)


def _of_table(robot: Robot, signals: Sequence[Path], wishes: Wishes) -> WornMode:
    if len(signals) > 1:
        (signal, *_) = [one for one in signals if one.suffix.lower() in TABLES]
        raise DataError(f"{signal} is a table, of one signal; expected it alone, or recordings")
    (signal,) = signals
    if wishes.part is None:
        raise DataError(f"{signal}: whose wear is it? expected --part, the path of a part or of its failure mode")
    return worn_mode_of_table(
        robot, signal, wishes.part, threshold=wishes.threshold, load=wishes.load, options=wishes.options
    )


def _of_recordings(robot: Robot, signals: Sequence[Path], wishes: Wishes) -> tuple[list[WornMode], Monitor]:
    """What the signals say that the design names; where one of several says too little, the others are told."""
    modes = worn_modes(robot, wishes.part)
    with counted(progress_console(), "reading") as advance:
        history = wear_history(robot, signals, modes, skip_missing=wishes.skip_missing, advance=advance)
    for what, count in sorted(history.notes.items()):
        warn(f"{what} ({count:,} times)" if count > 1 else what)
    found, missed = worn_in(history, modes, wishes.options)
    for one in missed:
        warn(f"{one}; it is left out")
    return found, history.monitor


def _print(robot: Robot, found: Sequence[WornMode], lives: Mapping[str, WornLife], wishes: Wishes) -> None:
    out = console()
    for one in found:
        _print_one(one, wishes.options)
        out.print()
    rows = []
    for name, both in lives.items():
        with_wear = "with its wear" if both.holds else "with its wear, as if it did not bend"
        for what, (life, left_out) in (("by hazard alone", both.by_hazard), (with_wear, both.with_wear)):
            mark = marks(left_out)[2]
            times = (life.early, life.median, life.late)
            rows.append([f"{name} {what}", *(marked(mark, duration_text(time)) for time in times)])
    columns = ["", "5 % by", "median", "95 % by"]
    print_table(out, table("Remaining life, calendar time", columns, rows, figures=(1, 2, 3)))
    of_robot = lives[robot.name]
    print_unknown(of_robot.by_hazard.unknown, robot)
    if of_robot.by_hazard.unknown and not of_robot.with_wear.unknown:
        out.print("With the wear nothing is left out: it says what no rate does", markup=False)


def _print_one(found: WornMode, options: WearOptions) -> None:
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
    never, threshold = found.wear.never, found.wear.signal_threshold
    or_never = f"; never with {number_text(100 * never, 2)} %" if never > 0.005 else ""
    if found.wear.worn_out:
        say(f"Has reached {threshold:g}", "bold red")
    else:
        say(f"Reaches {threshold:g} in {median} {unit}, 90 % between {low} and {high}{or_never}")
    bend = found.wear.bend
    if bend.direction:
        say(
            f"The trend bends, it is {bend.direction} (p = {number_text(bend.p_value, 2)}): what is said of life is of "
            f"a straight one, {bend.life_is}, and does not hold", "bold yellow",
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
        f"Change against the first {options.baseline} readings: {at} (CUSUM for shifts of {options.shift:g} "
        f"deviations: falsely once in {found.detector.between_false_alarms:g} readings, such a shift seen after "
        f"{number_text(found.detector.delay, 2)})"
    )
    if found.detector.correlated:
        correlation = number_text(found.detector.correlation, 2)
        say(f"Readings of the baseline follow one another (correlation {correlation}): false alarms come more often "
            "than that", "yellow")  # fmt: skip


def _json(robot: Robot, found: Sequence[WornMode], lives: Mapping[str, WornLife]) -> dict[str, Any]:
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
                "never": one.wear.never,
                "bend": {
                    "direction": one.wear.bend.direction,
                    "p": one.wear.bend.p_value,
                    "false_alarms": FALSE_ALARMS,
                    "life_is": one.wear.bend.life_is,
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
            name: {"hazard": life(one.by_hazard), "fused": {**life(one.with_wear), "holds": one.holds}}
            for name, one in lives.items()
        },
    }
