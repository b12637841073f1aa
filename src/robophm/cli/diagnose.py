"""``robophm fmeca`` and ``robophm diagnose``: what failures do, what sees them, which it is, what more would tell."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from robophm.cli.output import console, may_make, print_json, print_table, table, write
from robophm.cli.past import kept
from robophm.cli.unused import refuse_unused
from robophm.core.errors import DataError, RobophmError, nearest
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.health.effects import SEVERITY, Effect, SilentStates, alarm_chances, effects, fault_chances, silent_states
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook, as_designed, nominal_outlook
from robophm.health.report import plain
from robophm.health.unknown_rates import PartsOfUnknownRate, alone, marks, named, unknown
from robophm.learning.diagnosis.coverage_matrix import coverage, read_sensors, seen
from robophm.learning.diagnosis.fault_isolation import Diagnosis, Sensor, suspects
from robophm.learning.diagnosis.sensor_choice import Choice, choose, explained
from robophm.monitoring.monitor import Monitor
from robophm.report.fmeca_page import effect_text, fmeca_csv, fmeca_page, unknown_words
from robophm.report.words import more_text, number_text, percent_text

MOST_SUSPECTS = 15
"""That are listed, of those whose rate is known, and of those whose rate is unknown."""


def fmeca(
    path: Path, table_of_sensors: Path | None, hours: float, severities: tuple[str, ...], to: Path | None, *,
    force: bool, as_json: bool,
) -> None:  # fmt: skip
    """Effects of every failure mode, printed or written."""
    may_make(to, path, *([table_of_sensors] if table_of_sensors else []), force=force, suffixes=(".csv", ".html"))
    if to is None:
        refuse_unused("effects that are not written (--to)", ("sensors", "hours", "severity"))
    robot = load(path)
    sensors = read_sensors(table_of_sensors, robot) if table_of_sensors else []
    sees = coverage(robot, [sensor for sensor in sensors if sensor.fitted])
    outlook = as_designed(Plant(robot))
    found = effects(outlook, hours, seen(robot, sensors), _severities(severities, robot))
    if to:
        write(to, fmeca_csv(found, sees) if to.suffix == ".csv" else fmeca_page(robot.name, found, sees, hours))
    if as_json:
        modes = [{**asdict(one), "rpn": one.rpn, "criticality": one.criticality} for one in found]
        print_json({"robot": robot.name, "hours": hours, "modes": plain(modes), "coverage": sees})
        return
    _print_effects(robot, found, hours, to)


def _severities(texts: tuple[str, ...], robot: Robot) -> dict[str, int]:
    known = [*SEVERITY, *robot.functions, *(part.path for part in robot.all_components()),
             *(mode.path for mode in robot.modes)]  # fmt: skip
    found = {}
    for text in texts:
        name, _, value = text.rpartition("=")
        if not value.strip().isascii() or not value.strip().isdigit() or not 1 <= int(value) <= 10:
            raise RobophmError(f"--severity {text[:60]!r}; expected e.g. drive=9, from 1 to 10")
        if name.strip() not in known:
            raise RobophmError(f"--severity: no function or part '{name.strip()[:60]}'{nearest(name.strip(), known)}")
        found[name.strip()] = int(value)
    return found


def _print_effects(robot: Robot, found: list[Effect], hours: float, to: Path | None) -> None:
    out = console()
    columns = ["failure mode", "end effect", "within", "seen", "S", "O", "D", "RPN", "criticality"]
    rows = [
        [one.mode, effect_text(one)[1], number_text(one.probability, 3), f"{number_text(100 * one.detected, 3)} %",
         str(one.severity), str(one.occurrence), str(one.detection), str(one.rpn), number_text(one.criticality, 3)]
        for one in found[:40]
    ]  # fmt: skip
    title = f"What failures do to {robot.name}, within {number_text(hours)} h of operation"
    print_table(out, table(title, columns, rows, figures=range(2, len(columns))))
    if len(found) > len(rows):
        out.print(f"{more_text(len(found) - len(rows), 'listed')}; --to FMECA.CSV has all")
    for words in unknown_words(found):
        out.print(words, style="yellow", markup=False)
    out.print("S severity, O occurrence, D detection (10: nothing sees it), RPN their product")
    if to:
        out.print(f"Written to {to}", markup=False, soft_wrap=True)


@dataclass(frozen=True)
class Wishes:
    """What is asked of a diagnosis."""

    alarms: tuple[str, ...] | None
    """None: no question of what they mean."""
    add: int
    hours: float
    after: float | None
    store: Path | None
    function: str | None
    as_json: bool


def diagnose(path: Path, table_of_sensors: Path, wishes: Wishes) -> None:
    """Coverage, suspects, and the sensors that would tell most."""
    _only(wishes)
    robot = load(path)
    sensors = read_sensors(table_of_sensors, robot)
    plant = Plant(robot)
    outlook = _outlook(robot, plant, wishes)
    unseen = [mode for mode, p in seen(robot, sensors).items() if p == 0]
    found = None
    if wishes.alarms is not None:
        found = suspects(fault_chances(outlook, wishes.hours), sensors, wishes.alarms)
    added: _Added | None = None
    if wishes.add:
        added = _added(robot, outlook, sensors, wishes)
    if wishes.as_json:
        print_json(plain(_json(robot, sensors, unseen, found, added)))
    else:
        _print(robot, sensors, unseen, found, added, wishes)


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
    if wishes.store:
        return Monitor(robot, kept(wishes.store, robot)).report(remaining_life=False).outlooks["sensor_based"]
    if wishes.after is None:
        return as_designed(plant)
    return nominal_outlook(plant, plant.initial + plant.pace * wishes.after / robot.usage.operating)


class _Added(NamedTuple):
    """Sensors to add."""

    states: SilentStates
    choice: Choice
    now: float
    """What is fitted takes away."""
    spread: float
    unknown: PartsOfUnknownRate | None


def _added(robot: Robot, outlook: Outlook, sensors: list[Sensor], wishes: Wishes) -> _Added:
    if wishes.function is not None and wishes.function not in robot.functions:
        raise RobophmError(f"no function '{wishes.function}'{nearest(wishes.function, robot.functions)}")
    if all(sensor.fitted for sensor in sensors):
        raise DataError("every sensor is fitted already; expected some with fitted: no, to choose from")
    diagram = outlook.plant.diagram(wishes.function or "")
    states = silent_states(outlook, diagram, wishes.hours)
    units = {mode.path: part.units for part in robot.all_components() for mode in part.modes}
    share = _mode_shares(outlook)
    columns = []
    for sensor in sensors:
        by_unit: dict[str, float] = {}
        for mode, p in sensor.detects.items():  # a unit has failed by one of its modes, each as likely as its hazard
            for unit in units[mode]:
                by_unit[unit] = by_unit.get(unit, 0.0) + share[mode] * p
        columns.append(alarm_chances(states.states, by_unit, sensor.false_alarm))
    alarms = np.stack(columns, axis=1)
    base = [i for i, sensor in enumerate(sensors) if sensor.fitted]
    choice = choose(states.weights, states.outcome, alarms, wishes.add, base=base)
    now = explained(states.weights, states.outcome, alarms, (), base)
    spread = float(states.weights @ (states.outcome - states.weights @ states.outcome) ** 2)
    return _Added(states, choice, now, spread, unknown(outlook, diagram))


def _mode_shares(outlook: Outlook) -> dict[str, float]:
    """Of the hazard that a part has gathered, the share of each of its modes."""
    found = {}
    at = {mode.path: i for i, mode in enumerate(outlook.plant.robot.modes)}
    for part in outlook.plant.robot.all_components():
        gathered = [float(outlook.cumulative_hazard[at[mode.path]]) for mode in part.modes]
        total = math.fsum(gathered)
        for mode, one in zip(part.modes, gathered, strict=True):
            found[mode.path] = one / total if total > 0 else 1 / len(part.modes)
    return found


def _print(
    robot: Robot, sensors: list[Sensor], unseen: list[str], found: Diagnosis | None,
    added: _Added | None, wishes: Wishes,
) -> None:  # fmt: skip
    out = console()
    names = [sensor.name for sensor in sensors]
    matrix = [
        [mode, *(number_text(sees[n], 3) if n in sees else "" for n in names), "yes" * ("monitored" in sees)]
        for mode, sees in coverage(robot, sensors).items()
    ]
    columns = ["failure mode", *(s.name if s.fitted else f"({s.name})" for s in sensors), "monitored"]
    print_table(out, table(f"What sees what in {robot.name}: P(alarm | failure)", columns, matrix,
                           figures=range(1, len(columns))))  # fmt: skip
    if not all(sensor.fitted for sensor in sensors):
        out.print("(in brackets: not fitted)")
    if unseen:
        some = ", ".join(unseen[:10]) + (" …" if len(unseen) > 10 else "")
        out.print(f"Nothing fitted sees: {some}", style="yellow", markup=False, soft_wrap=True)
    if found:
        _print_suspects(robot, found, wishes)
    if added:
        _print_choice(sensors, added, wishes)


def _print_suspects(robot: Robot, found: Diagnosis, wishes: Wishes) -> None:
    """The likeliest, and all that may be it though how likely is not known."""
    out = console()
    left_out = alone(robot.all_components())
    mark = marks(left_out if found.rivals else None)[2]
    shown = [one for one in found.suspects if math.isnan(one.before)][:MOST_SUSPECTS]
    unrated = len(shown)
    shown += [one for one in found.suspects if not math.isnan(one.before)][:MOST_SUSPECTS]
    rows = [
        [one.fault,
         "unknown" if math.isnan(one.probability) else mark + percent_text(one.probability),
         "unknown" if math.isnan(one.before) else number_text(one.before, 3),
         "–" if math.isnan(one.odds) else number_text(one.odds, 3)]
        for one in shown
    ]  # fmt: skip
    on = ", ".join(wishes.alarms or ()) or "no alarm"
    columns = ["", "now", f"before, in {number_text(wishes.hours)} h", "odds, times"]
    out.print()
    title = f"Suspects, {on} being on and all others off"
    print_table(out, table(title, columns, rows, figures=(1, 2, 3)))
    nothing = f"Nothing has failed{', and it is a false alarm' if wishes.alarms else ''}"
    most = marks(left_out)[1] if found.no_fault else ""
    out.print(f"{nothing}: {most}{percent_text(found.no_fault)}", markup=False)
    out.print("odds, times: how many times as large the alarms make the odds that it is there", markup=False)
    if left_out:
        says = left_out.aside if found.rivals else f"{left_out.words} may have failed as well: how likely is not known"
        out.print(f"{says} ({named(robot)})", style="yellow", markup=False, soft_wrap=True)
        if more := sum(math.isnan(one.before) for one in found.suspects) - unrated:
            out.print(f"of unknown rate {more_text(more, 'listed')}", style="yellow", markup=False)


def _print_choice(sensors: list[Sensor], added: _Added, wishes: Wishes) -> None:
    states, choice, now, spread, left_out = added
    out = console()
    rows = []

    def share(variance: float) -> float:
        return max(variance / spread, 0.0) if spread > 0 and variance > 1e-12 * spread else 0.0

    for i, gain in zip(choice.chosen, choice.gains, strict=True):
        price = sensors[i].price
        per_price = "–" if price is None else percent_text(share(gain) / price)
        rows.append(
            [sensors[i].name, percent_text(share(gain)), "–" if price is None else number_text(price), per_price]
        )
    out.print()
    title = f"Sensors that tell most of whether it works through {number_text(wishes.hours)} h of operation"
    print_table(out, table(title, ["add", "doubt taken away", "price", "per price"], rows, figures=(1, 2, 3)))
    best = "No other choice of as many is better"
    if not choice.exhaustive:
        best = f"Chosen one by one: at least {percent_text(choice.at_least)} of what the best choice takes away"
    out.print(
        f"Of the doubt that comes from what may have failed unseen ({len(states.units)} units); what is fitted takes "
        f"away {percent_text(share(now))}. {best}; all candidates together would take away at most "
        f"{percent_text(share(choice.most))}.",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    if left_out:
        out.print(left_out.aside, style="yellow", markup=False, soft_wrap=True)
    if states.missed > 1e-6:
        out.print(f"Combinations of failures with a chance of {number_text(states.missed, 2)} were not looked at",
                  style="yellow", markup=False)  # fmt: skip


def _json(
    robot: Robot, sensors: list[Sensor], unseen: list[str], found: Diagnosis | None,
    added: _Added | None,
) -> dict[str, Any]:  # fmt: skip
    document: dict[str, Any] = {"robot": robot.name, "coverage": coverage(robot, sensors), "unseen": unseen}
    if found:
        document["suspects"] = [one._asdict() for one in found.suspects]
        document["no_fault"], document["evidence"] = found.no_fault, found.evidence
        if left_out := alone(robot.all_components()):
            document["unknown"] = {**asdict(left_out), "rivals": found.rivals}
    if added:
        states, choice, now, spread, unrated = added
        document["sensors"] = {
            "chosen": [sensors[i].name for i in choice.chosen], "gains": list(choice.gains), "variance": spread,
            "fitted": now, "all_candidates": choice.most, "bound": choice.bound,
            "exhaustive": choice.exhaustive, "at_least": choice.at_least,
            "missed": states.missed,
            **({"unknown": asdict(unrated)} if unrated else {}),
        }  # fmt: skip
    return document
