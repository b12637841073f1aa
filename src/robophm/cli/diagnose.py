"""``robophm diagnose``: what sees which failure, which it is, what more would tell."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli.shared.options import Design, Json, Store, time_option
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.stored_past import outlook_of
from robophm.cli.shared.unused import refuse_unused
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.effects import fault_chances
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import unknown_in_parts
from robophm.interface.faults import AddedSensors, added_sensors
from robophm.learning.diagnosis.coverage_matrix import coverage, read_sensors, undetected_modes
from robophm.learning.diagnosis.fault_isolation import Diagnosis, Sensor, suspects
from robophm.report.suspects import coverage_rows, nothing_failed, suspect_rows, unknown_suspects
from robophm.report.words import number_text, percent_text


@dataclass(frozen=True)
class Wishes:
    """The options of a diagnosis."""

    alarms: tuple[str, ...] | None
    """Names of the alarms that are on; None: it is not asked what they mean."""
    add: int
    hours: float
    after: float | None
    store: str | None
    function: str | None
    as_json: bool


def command(
    design: Design,
    sensors: Annotated[
        Path, typer.Argument(help="a table: sensor, part, detects, false alarm, price, fitted", metavar="SENSORS.CSV")
    ],
    alarm: Annotated[
        list[str] | None, typer.Option(metavar="SENSOR", help="a sensor whose alarm is on; the others are off")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="no alarm is on: what may have failed undetected")] = False,
    add: Annotated[int, typer.Option(help="number of sensors to add, of those with fitted: no", min=0, max=16)] = 0,
    hours: Annotated[
        float, time_option("--within", "time of operation in which the fault came, or for which the robot must work")
    ] = 100.0,
    after: Annotated[float | None, time_option("--at", "time of operation that a new robot has worked")] = None,
    store: Store = None,
    function: Annotated[str | None, typer.Option(help="function that must work; default: the whole robot")] = None,
    as_json: Json = False,
) -> None:
    """Which sensor detects which failure, what has failed given the alarms, and which sensor to add."""
    alarms = tuple(alarm) if alarm else () if quiet else None
    run(design, sensors, Wishes(alarms, add, hours, after, store, function, as_json))


def run(path: Path, table_of_sensors: Path, wishes: Wishes) -> None:
    """Print coverage, suspects, and the sensors that would tell most."""
    _only(wishes)
    robot = load(path)
    sensors = read_sensors(table_of_sensors, robot)
    plant = Plant(robot)
    outlook = _outlook(robot, plant, wishes)
    found = None
    if wishes.alarms is not None:
        found = suspects(fault_chances(outlook, wishes.hours), sensors, wishes.alarms)
    added = None
    if wishes.add:
        added = added_sensors(outlook, sensors, wishes.add, wishes.hours, wishes.function)
    if wishes.as_json:
        print_json(plain(_json(robot, sensors, found, added)))
    else:
        _print(robot, sensors, found, added, wishes)


def _only(wishes: Wishes) -> None:
    """Refuse what is not used for what is asked."""
    ahead = ("hours", "store", *["after"] * (wishes.store is None))
    if wishes.add:
        path, used = "sensors to add", ["add", "function", *ahead]
    elif wishes.alarms is not None:
        path, used = "what alarms mean", [*ahead]
    else:
        path, used = "what sees what", ["add"]
    path += " to a robot of a store, which says how old it is" if wishes.store and used != ["add"] else ""
    refuse_unused(path, (*used, "alarm", *["quiet"] * (not wishes.alarms)))


def _outlook(robot: Robot, plant: Plant, wishes: Wishes) -> Outlook:
    return outlook_of(wishes.store, robot) if wishes.store else as_designed(plant, after=wishes.after or 0.0)


def _print(
    robot: Robot, sensors: list[Sensor], found: Diagnosis | None, added: AddedSensors | None, wishes: Wishes
) -> None:
    out = console()
    columns, matrix = coverage_rows(sensors, coverage(robot, sensors))
    print_table(out, table(f"What sees what in {robot.name}: P(alarm | failure)", columns, matrix,
                           figures=range(1, len(columns))))  # fmt: skip
    if not all(sensor.fitted for sensor in sensors):
        out.print("(in brackets: not fitted)")
    if blind := undetected_modes(robot, sensors):
        some = ", ".join(blind[:10]) + (" …" if len(blind) > 10 else "")
        out.print(f"Nothing fitted sees: {some}", style="yellow", markup=False, soft_wrap=True)
    if found:
        _print_suspects(robot, found, wishes)
    if added:
        _print_choice(added, wishes)


def _print_suspects(robot: Robot, found: Diagnosis, wishes: Wishes) -> None:
    """The likeliest, and all that may be it though how likely is not known."""
    out, alarms = console(), wishes.alarms or ()
    columns, rows = suspect_rows(robot, found, wishes.hours)
    out.print()
    title = f"Suspects, {', '.join(alarms) or 'no alarm'} being on and all others off"
    print_table(out, table(title, columns, rows, figures=(1, 2, 3)))
    out.print(nothing_failed(robot, found, alarmed=bool(alarms)), markup=False)
    out.print("odds, times: how many times as large the alarms make the odds that it is there", markup=False)
    for words in unknown_suspects(robot, found):
        out.print(words, style="yellow", markup=False, soft_wrap=True)


def _print_choice(added: AddedSensors, wishes: Wishes) -> None:
    states, choice, left_out = added.states, added.choice, added.unknown
    out, share = console(), choice.share
    rows = []
    for one, gain in zip(added.chosen, choice.gains, strict=True):
        price = one.price
        per_price = "–" if price is None else percent_text(share(gain) / price)
        rows.append([one.name, percent_text(share(gain)), "–" if price is None else number_text(price), per_price])
    out.print()
    title = f"Sensors that tell most of whether it works through {number_text(wishes.hours)} h of operation"
    print_table(out, table(title, ["add", "doubt taken away", "price", "per price"], rows, figures=(1, 2, 3)))
    best = "No other choice of as many is better"
    if not choice.exhaustive:
        best = f"Chosen one by one: at least {percent_text(choice.at_least)} of what the best choice takes away"
    out.print(
        f"Of the doubt that comes from what may have failed unseen ({len(states.units)} units); what is fitted takes "
        f"away {percent_text(share(choice.before))}. {best}; all candidates together would take away at most "
        f"{percent_text(share(choice.most))}.",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    if left_out:
        out.print(left_out.aside, style="yellow", markup=False, soft_wrap=True)
    if states.missed > 1e-6:
        out.print(f"Combinations of failures with a chance of {number_text(states.missed, 2)} were not looked at",
                  style="yellow", markup=False)  # fmt: skip


def _json(robot: Robot, sensors: list[Sensor], found: Diagnosis | None, added: AddedSensors | None) -> dict[str, Any]:
    document: dict[str, Any] = {
        "robot": robot.name, "coverage": coverage(robot, sensors), "unseen": undetected_modes(robot, sensors),
    }  # fmt: skip
    if found:
        document["suspects"] = [one._asdict() for one in found.suspects]
        document["no_fault"], document["evidence"] = found.no_fault, found.evidence
        if left_out := unknown_in_parts(robot.all_components()):
            document["unknown"] = {**asdict(left_out), "rivals": found.rivals}
    if added:
        states, choice, unrated = added.states, added.choice, added.unknown
        document["sensors"] = {
            "chosen": [one.name for one in added.chosen], "gains": list(choice.gains),
            "variance": choice.variance, "fitted": choice.before, "all_candidates": choice.most, "bound": choice.bound,
            "exhaustive": choice.exhaustive, "at_least": choice.at_least,
            "missed": states.missed,
            **({"unknown": asdict(unrated)} if unrated else {}),
        }  # fmt: skip
    return document
