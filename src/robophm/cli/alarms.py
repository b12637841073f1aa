"""``robophm alarms``: the log of a robot's alarms, and whoever takes note of one."""

from __future__ import annotations

import time
from typing import Annotated

import typer

from robophm.cli import BREACHED
from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.core.errors import RobophmError
from robophm.design.file import load
from robophm.health.alarms import Alarm
from robophm.monitoring.stored_past import stored_history
from robophm.report.words import moment_text

MOST_SHOWN = 50


def command(
    design: Design,
    store: Annotated[str, typer.Option("--store", help="store with the robot's past, written by watch or serve",
                                       callback=stated_store)],
    most: Annotated[int, typer.Option(min=1, max=10_000, help="number of alarms, the newest first")] = MOST_SHOWN,
    acknowledge: Annotated[int | None, typer.Option(metavar="NUMBER", help="acknowledge this alarm")] = None,
    by: Annotated[str | None, typer.Option(help="who acknowledges it")] = None,
    as_json: Json = False,
) -> None:  # fmt: skip
    """List a robot's alarms: which are on, since when, why, and who acknowledged them."""
    if (acknowledge is None) != (by is None):
        raise RobophmError("--acknowledge and --by: expected both, the number of an alarm and a name")
    robot = load(design)
    with stored_history(store, robot) as kept:
        log = kept.alarm_log(robot.identity)
        if acknowledge is not None and by and not log.acknowledge(acknowledge, by, time.time_ns()):
            raise RobophmError(f"there is no alarm {acknowledge} of {robot.name}")
        going_on = [Alarm.of(one) for one in log.alarms(open_only=True)]
        ended = [one for one in map(Alarm.of, log.alarms(most=most)) if one.end is not None]
    if as_json:
        print_json({"schema_version": 1, "robot": robot.name, "alarms": [one.to_json() for one in (*going_on, *ended)]})
    else:
        _print(robot.name, [*going_on, *ended], "limits" if robot.limited else "")
    if any(one.severity == "error" for one in going_on):
        raise typer.Exit(BREACHED)


def _print(name: str, alarms: list[Alarm], limits: str) -> None:
    out = console()
    if not alarms:
        why = "" if limits else "; the design states no limits (`thresholds`), so that no figure can begin one"
        out.print(
            f"{name}: no alarm so far; watch and serve begin them, replay does not{why}", markup=False, soft_wrap=True
        )
        return
    rows = [
        [
            str(one.number), one.severity, moment_text(one.begin), moment_text(one.end) if one.end else _state(one),
            one.cause, one.acknowledged_by or "–",
        ]
        for one in alarms
    ]  # fmt: skip
    columns = ("number", "severity", "began", "ended", "why", "acknowledged by")
    print_table(out, table(f"Alarms of {name}", columns, rows))


def _state(one: Alarm) -> str:
    return f"not known: {one.doubt}" if one.doubt else "active"
