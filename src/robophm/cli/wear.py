"""``robophm wear``: the trend of signals that show wear, when they changed, and what remains of parts and robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.calibration.backtested_wear import lives_of
from robophm.calibration.predictions import lives_text
from robophm.cli import BREACHED
from robophm.cli.shared.health_output import observed_text, print_unknown
from robophm.cli.shared.options import Design, Json, Store
from robophm.cli.shared.output import console, may_write, print_json, progress_console, warn, write
from robophm.cli.shared.progress import counted
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.cli.shared.wear_words import (
    backtest_json,
    lives_json,
    print_backtest,
    print_index_backtest,
    print_lives,
    print_worn,
    worn_json,
)
from robophm.core.errors import DataError
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.worn import SeenWear
from robophm.learning.wear.backtest import Backtest
from robophm.learning.wear.indexed_mode import indexed_mode_of_tables
from robophm.learning.wear.teachers import others_of_table
from robophm.learning.wear.worn_mode import WearOptions, WornMode, one_mode, worn_mode_of_table
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.wear_from_recordings import holds_readings, seen_in, wear_history, worn_in, worn_modes
from robophm.monitoring.worn_life import WornLife, worn_lives


@dataclass(frozen=True)
class Wishes:
    """The options of a look at wear."""

    part: str | None
    threshold: float | None
    threshold_deviation: float | None
    load: float | None
    fleet: Path | None
    at: Mapping[str, float]
    index: bool
    settings: Sequence[str]
    options: WearOptions
    store: str | None
    skip_missing: bool
    backtest: bool
    predictions: Path | None
    as_json: bool


def command(
    design: Design,
    signals: Annotated[
        list[Path],
        typer.Argument(
            help="recordings (.bag, .mcap, .db3, .journal, .csv, folders) with the signals that the design names at "
            "`wear`, or a table: time [h] or when, value",
            metavar="RECORDING…|SIGNAL.CSV",
        ),
    ],
    part: Annotated[
        str | None,
        typer.Option(help="path of the part or failure mode whose wear the signal shows; default: all with `wear`"),
    ] = None,
    threshold: Annotated[
        float | None,
        typer.Option(help="of a table: value at which the part has failed; below the first one if the signal falls"),
    ] = None,
    threshold_deviation: Annotated[
        float | None, typer.Option(help="of a table: standard deviation of the threshold", min=0)
    ] = None,
    load: Annotated[
        float | None, typer.Option(help="of a table: load at which readings are compared, by the column load")
    ] = None,
    fleet: Annotated[
        Path | None,
        typer.Option(help="a table of the same signal of other units, worn out or still running: unit, time, value"),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--use",
            help="of a table with columns temperature, stress or depth_of_discharge: future conditions, "
            "e.g. temperature=40; default: as recently",
            metavar="CONDITION=VALUE",
        ),
    ] = None,
    index: Annotated[
        bool,
        typer.Option(
            "--index", help="of a table of many signals: combine them to an index of health, by a --fleet that failed"
        ),
    ] = False,
    settings: Annotated[
        str, typer.Option(help="of --index: columns with operating conditions, not signals", metavar="A,B,…")
    ] = "",
    baseline: Annotated[int, typer.Option(help="number of first readings at which the part was sound", min=30)] = 100,
    false_alarms: Annotated[float, typer.Option(help="accept one false alarm in this many readings", min=10)] = 1000.0,
    shift: Annotated[float, typer.Option(help="shift to be detected, in standard deviations", min=0.1, max=10)] = 1.0,
    store: Store = None,
    skip_missing: Annotated[
        bool,
        typer.Option("--skip-missing", help="continue without signals that no recording has; they count as silent"),
    ] = False,
    backtest: Annotated[
        bool, typer.Option("--backtest", help="also give the forecasts at earlier readings, and what happened")
    ] = False,
    predictions: Annotated[
        Path | None, typer.Option(help="write these forecasts to a CSV file, for robophm calibrate", metavar="FILE.CSV")
    ] = None,
    seed: Annotated[int, typer.Option(help="random seed", min=0)] = 0,
    as_json: Json = False,
) -> None:
    """Wear seen in signals: trend, changes, and the remaining life of parts and robot.

    Exit code 1 where a threshold is reached, or no model follows the wear.
    """
    options = WearOptions(baseline, false_alarms, shift, seed)
    may_write(predictions, design, *signals, *([fleet] if fleet else []))
    wishes = Wishes(
        part, threshold, threshold_deviation, load, fleet, _conditions(at or ()), index,
        [name.strip() for name in settings.split(",") if name.strip()], options, store, skip_missing,
        backtest or predictions is not None, predictions, as_json,
    )  # fmt: skip
    if run(design, signals, wishes):
        raise typer.Exit(BREACHED)


def run(path: Path, signals: Sequence[Path], wishes: Wishes) -> bool:
    """Foretell, look for a change, fuse with all other hazards, print; return whether anything is critical."""
    robot = load(path)
    fitted = ("part", "baseline", "false_alarms", "shift", "store", "backtest", "predictions", "seed")
    if any(map(holds_readings, signals)):
        if wishes.index:
            refuse_unused(
                "an index of health", ("part", "store", "backtest", "predictions", "seed", "fleet", "index", "settings")
            )
        else:
            refuse_unused("a table", (*fitted, "threshold", "threshold_deviation", "load", "fleet", "at"))
        found, seen, monitor = [_of_table(robot, signals, wishes)], list[SeenWear](), Monitor(robot)
    else:
        refuse_unused(
            "recordings, whose threshold and load are in the design, at the part's `wear`",
            (*fitted, "skip_missing", "fleet"),
        )
        found, seen, monitor = _of_recordings(robot, signals, wishes)
    if wishes.store:
        monitor, seen = Monitor(robot, kept(wishes.store, robot)), []
    report = monitor.report(remaining_life=False, wear=())
    lives = worn_lives(report.outlooks["sensor_based"], found, seen)
    done = _backtests(found, wishes) if wishes.backtest else {}
    if wishes.predictions:
        units = {name: one for of_mode in done.values() for name, one in of_mode.items()}
        write(wishes.predictions, lives_text(list(units), lives_of(list(units.values()))))
    if wishes.as_json:
        said = [
            worn_json(one) | (_backtest_json(one, done[one.mode.path]) if one.mode.path in done else {})
            for one in found
        ]
        print_json({"robot": robot.name, "signals": said, "remaining_life": lives_json(lives)})
    else:
        _print(robot, found, lives)
        if report.time is not None:
            console().print(observed_text(report), markup=False)
        for one in found:
            if one.mode.path in done:
                console().print()
                if one.index:
                    print_index_backtest(console(), one, done[one.mode.path])
                else:
                    print_backtest(console(), one, done[one.mode.path][one.mode.path])
    return any(one.critical for one in found)


def _backtests(found: Sequence[WornMode], wishes: Wishes) -> dict[str, dict[str, Backtest]]:
    """Backtests by failure mode, each by whose they are: the mode's own, or those of units that taught an index.

    Those that cannot be are told, and where none can the first is raised.
    """
    done: dict[str, dict[str, Backtest]] = {}
    missed: list[DataError] = []
    for one in found:
        try:
            own = one.index.backtested() if one.index else {one.mode.path: one.backtested(wishes.options.seed)}
            done[one.mode.path] = own
        except DataError as error:
            missed.append(error)
    if not done:
        raise missed[0]
    for why in missed:
        warn(f"{why}; it has no backtest")
    return done


def _backtest_json(one: WornMode, done: Mapping[str, Backtest]) -> dict[str, Any]:
    if one.index:
        return {"backtest_of_units": {name: backtest_json(of_unit) for name, of_unit in done.items()}}
    return {"backtest": backtest_json(done[one.mode.path])}


def _of_table(robot: Robot, signals: Sequence[Path], wishes: Wishes) -> WornMode:
    if len(signals) > 1:
        (signal, *_) = filter(holds_readings, signals)
        raise DataError(f"{signal} is a table, of one signal; expected it alone, or recordings")
    (signal,) = signals
    if wishes.part is None:
        raise DataError(f"{signal}: whose wear is it? expected --part, the path of a part or of its failure mode")
    if wishes.index:
        if wishes.fleet is None:
            raise DataError(f"{signal}: from whom is an index of health learned? expected --fleet, units that failed")
        mode = one_mode(robot, wishes.part)
        return indexed_mode_of_tables(mode, signal, wishes.fleet, wishes.settings, wishes.options.seed)
    return worn_mode_of_table(
        robot, signal, wishes.part, threshold=wishes.threshold, deviation=wishes.threshold_deviation,
        load=wishes.load, options=wishes.options, fleet=wishes.fleet, to_come=wishes.at,
    )  # fmt: skip


def _conditions(stated: Sequence[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    for text in stated:
        name, _, value = text.partition("=")
        try:
            found[name.strip()] = float(value)
        except ValueError:
            raise DataError(f"--use {text}: expected a condition and a number, e.g. temperature=40") from None
    return found


def _of_recordings(
    robot: Robot, signals: Sequence[Path], wishes: Wishes
) -> tuple[list[WornMode], list[SeenWear], Monitor]:
    """The wear by the signals that the design names; where one of several says too little, the others are told."""
    modes = worn_modes(robot, wishes.part)
    with counted(progress_console(), "reading") as advance:
        history = wear_history(robot, signals, modes, skip_missing=wishes.skip_missing, advance=advance)
    for what, count in sorted(history.notes.items()):
        warn(f"{what} ({count:,} times)" if count > 1 else what)
    if wishes.fleet and len(modes) > 1:
        raise DataError(f"{wishes.fleet}: of which part are these others? expected --part")
    others = others_of_table(wishes.fleet, modes[0].clock, dated=False) if wishes.fleet else None
    found, missed = worn_in(history, modes, wishes.options, others)
    for one in missed:
        warn(f"{one}; it is left out")
    return found, seen_in(history, found), history.monitor


def _print(robot: Robot, found: Sequence[WornMode], lives: Mapping[str, WornLife]) -> None:
    out = console()
    for one in found:
        print_worn(out, one)
        out.print()
    print_lives(out, lives)
    of_robot = lives[robot.name]
    print_unknown(of_robot.by_hazard.unknown, robot)
    if of_robot.by_hazard.unknown and not of_robot.with_wear.unknown:
        out.print("With the wear nothing is left out: it says what no rate does", markup=False)
