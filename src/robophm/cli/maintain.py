"""``robophm maintain``: when to replace which part, with which spares, at what cost, and whether watching pays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console

from robophm.cli.shared.due_parts import print_upkeep, write_calendar
from robophm.cli.shared.options import Design, Json, stated_store
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.stored_past import kept
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import DataError, RobophmError, UnitError
from robophm.core.units import quantity
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS, UNKNOWN, Robot
from robophm.health.outlooks import as_designed
from robophm.health.part_due import RISK
from robophm.health.plant import Plant
from robophm.health.replacement import Worth, replacements
from robophm.health.unknown_rates import PartsOfUnknownRate, few, named, unknown_in_parts
from robophm.learning.maintenance.costs_table import MOST, read_costs
from robophm.learning.maintenance.life_cycle_costs import LifeCycle
from robophm.learning.maintenance.replacement_age import Visit
from robophm.learning.maintenance.upkeep import LifeCycles, PartPlan, UpkeepPlan
from robophm.monitoring.condition_upkeep import ByCondition, by_condition
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.upkeep_ahead import UpkeepAhead, upkeep_of
from robophm.report.words import duration_text, number_text, percent_text, share_text

MOST_FIRST = 20
"""Parts that are listed as what to replace first."""


@dataclass(frozen=True)
class Wishes:
    """The options of a maintenance plan."""

    store: str | None
    setup: float
    hour_down: float
    horizon: str
    robots: int
    level: float
    lead: str
    repetitions: int
    seed: int
    as_json: bool
    risk: float = RISK
    calendar: Path | None = None


@dataclass(frozen=True)
class _Answers:
    """The answers to print."""

    plan: UpkeepPlan
    left_out: PartsOfUnknownRate | None
    """The effect of those parts of unknown rate that were asked about."""
    visit: Visit | None
    cycles: LifeCycles | None
    spares: dict[str, tuple[int, float]]
    first: list[Worth] | None
    """Gain of replacing each part, and its cost; None without a past."""
    first_unknown: PartsOfUnknownRate | None
    """The effect of parts of unknown rate on that."""
    inspected: Mapping[str, ByCondition]
    """The parts that are best replaced by what an inspection finds."""
    uninspected: Mapping[str, str]
    """Why that cannot be said of other parts, by their path."""
    ahead: UpkeepAhead
    """What is due, and the replacements to come."""


def command(
    design: Design,
    costs: Annotated[
        Path | None,
        typer.Argument(
            help="a table: part, preventive, corrective, …; without it: only what is due", metavar="[COSTS.CSV]"
        ),
    ] = None,
    store: Annotated[
        str | None,
        typer.Option(
            "--store", help="store with the robot's past: what is due, and what to do first", callback=stated_store
        ),
    ] = None,
    setup: Annotated[float, typer.Option(help="cost of each visit, whatever is done", min=0)] = 0.0,
    downtime_cost: Annotated[float, typer.Option(help="cost of an hour for which the robot is down", min=0)] = 0.0,
    horizon: Annotated[str, typer.Option(help="time over which costs are simulated")] = "5 year",
    robots: Annotated[
        int, typer.Option(help="number of robots that share a stock of spares", min=1, max=1_000_000)
    ] = 1,
    level: Annotated[
        float, typer.Option(help="probability with which the spares are enough", min=0.001, max=0.99999)
    ] = 0.95,
    lead: Annotated[str, typer.Option(help="time that the spares must last")] = "90 day",
    repetitions: Annotated[int, typer.Option(help="number of simulated lives", min=2, max=1_000_000)] = 2000,
    seed: Annotated[int, typer.Option(help="random seed of the simulation", min=0)] = 0,
    risk: Annotated[float, typer.Option(help="accepted probability that a part fails before it is due")] = RISK,
    calendar: Annotated[
        Path | None, typer.Option(help="write the due replacements as a calendar", metavar="FILE.ics")
    ] = None,
    as_json: Json = False,
) -> None:
    """When to replace which part, with which spares, at what cost, and whether monitoring pays."""
    wishes = Wishes(
        store, setup, downtime_cost, horizon, robots, level, lead, repetitions, seed, as_json, risk, calendar
    )
    if costs is None:
        refuse_unused("what is due, without a table of costs", ("design", "costs", "store", "risk", "calendar"))
        look_ahead(design, wishes)
    else:
        run(design, costs, wishes)


def look_ahead(design: Path, wishes: Wishes) -> UpkeepAhead:
    """Print which parts are due, and what is to be replaced in the weeks to come; write the calendar."""
    robot = load(design)
    found = upkeep_of(robot, wishes.store, risk=wishes.risk)
    if wishes.calendar:
        write_calendar(wishes.calendar, design, found)
    if wishes.as_json:
        print_json({"robot": robot.name, "ahead": found.to_json()})
    else:
        print_upkeep(console(), found)
    return found


def run(design: Path, table_of_costs: Path, wishes: Wishes) -> None:
    """Plan, simulate and print the upkeep."""
    robot = load(design)
    for option, value in (("--setup", wishes.setup), ("--downtime-cost", wishes.hour_down)):
        if not value <= MOST:
            raise RobophmError(f"{option} {value:g}: expected a finite cost, at most {MOST:g}")
    horizon, lead = _hours(wishes.horizon, "--horizon"), _hours(wishes.lead, "--lead")
    costs = read_costs(table_of_costs, robot, wishes.hour_down)
    if all(one.part.unknown for one in costs.values()):
        raise DataError(
            f"{table_of_costs}: all parts in it are of unknown rate ({few(list(costs))}); expected one with a rate"
        )
    plant = Plant(robot)
    ledger = kept(wishes.store, robot) if wishes.store else None
    monitor = Monitor(robot, ledger)
    outlook = monitor.report(remaining_life=False).outlooks["sensor_based"] if ledger else as_designed(plant)
    plan = UpkeepPlan.of(
        robot, costs, outlook.future.pace(plant), age=outlook.age if wishes.store else None,
        hour_down=wishes.hour_down, seed=wishes.seed,
    )  # fmt: skip
    visit = plan.visit(wishes.setup) if wishes.setup else None
    cycles = plan.life_cycles(horizon, wishes.repetitions, wishes.seed)
    stock = plan.spares(lead, wishes.robots, wishes.level)
    gains = replacements(outlook, robot.diagram, robot.task) if wishes.store else None
    first = gains.for_their_cost({one.path: one.price for one in plan.parts}) if gains else None
    left_out = unknown_in_parts(costs[name].part for name in plan.unknown)
    unknown_gains = gains.unknown if gains else None
    inspected = by_condition(robot, plan, ledger)
    ahead = upkeep_of(robot, wishes.store, risk=wishes.risk)
    found = _Answers(plan, left_out, visit, cycles, stock, first, unknown_gains, *inspected, ahead)
    if wishes.calendar:
        write_calendar(wishes.calendar, design, ahead)
    if wishes.as_json:
        print_json(_json(found))
        return
    out = console()
    print_upkeep(out, ahead)
    out.print()
    _print_parts(out, found)
    _print_inspected(out, found)
    if visit:
        _print_visit(out, visit, wishes.setup)
    if cycles:
        title = f"Over {duration_text(horizon)} of one robot, {wishes.repetitions:,} times over (seed {wishes.seed})"
        _print_cycles(out, cycles, title, found.left_out)
    if stock:
        _print_spares(out, found, wishes, lead)
    if first:
        _print_first(out, first, robot)
    if found.first_unknown:
        out.print(f"What to replace first: {found.first_unknown.aside} ({named(robot)})", style="yellow", markup=False,
                  soft_wrap=True)  # fmt: skip


def _hours(text: str, option: str) -> float:
    try:
        hours = quantity(text, "h")
    except UnitError as error:
        raise RobophmError(f"{option}: {error}") from None
    if not 0 < hours < 1e9:
        raise RobophmError(f"{option} {text}: expected a time above 0, below 1e9 h")
    return hours


def _print_parts(out: Console, found: _Answers) -> None:
    plan, left_out, past = found.plan, found.left_out, found.first is not None
    columns = ["", "replace at", "that is every", "cost per 1000 h", "if never", "saved", *["due in"] * past]
    rows = [[*_part_row(one), *[_due(one)] * past] for one in plan.parts]
    rows += [[name, UNKNOWN, *["–"] * (len(columns) - 2)] for name in plan.unknown]
    title = f"When to replace the parts of {plan.robot.name}"
    print_table(out, table(title, columns, rows, figures=range(1, len(columns))))
    out.print("Costs of one part per 1000 h of calendar time. Never by age: it does not wear (β ≤ 1, or constant), or "
              "failing costs no more than replacing.", soft_wrap=True)  # fmt: skip
    if left_out:
        others = f"; all others are said as {left_out.if_never}" if any(one.redundant for one in plan.parts) else ""
        out.print(f"{left_out.left_out} ({few(plan.unknown)}): when to replace is not known{others}",
                  style="yellow", markup=False, soft_wrap=True)  # fmt: skip
    for one in plan.parts:
        if one.redundant:
            out.print(
                f"{one.path} is redundant: while it is down the robot stands still with "
                f"{share_text(one.stops, 2)}", markup=False, soft_wrap=True,
            )  # fmt: skip


def _print_inspected(out: Console, found: _Answers) -> None:
    rows = [
        [name, number_text(one.level, 4), duration_text(one.policy.interval / one.pace),
         *(number_text(1000 * rate * one.pace, 3)
           for rate in (one.policy.cost_rate, one.policy.by_age, one.policy.never)),
         share_text(one.policy.fails, 2),
         f"{number_text(100 * one.policy.saving, 2)} %" if one.policy.saving > 0 else "–"]
        for name, one in found.inspected.items()
    ]  # fmt: skip
    if rows:
        columns = [
            "by inspection", "replace at", "inspect every", "cost per 1000 h", "by age", "if never", "fail before",
            "saved",
        ]  # fmt: skip
        out.print()
        print_table(out, table("Replaced by the wear that is found", columns, rows, figures=range(1, 8)))
        out.print("All by the same paths of wear; a failure shows at once.", soft_wrap=True)
        for name, one in found.inspected.items():
            by = f"{one.known} of its kind that wore out" if one.known else "its own forecast alone"
            out.print(f"{name}: by {by}", markup=False, soft_wrap=True)
    for name, why in found.uninspected.items():
        out.print(f"{name}: when to replace it by inspection cannot be said: {why}", style="yellow", markup=False,
                  soft_wrap=True)  # fmt: skip


def _part_row(one: PartPlan) -> list[str]:
    policy = one.policy
    return [
        one.path,
        "never by age" if one.age is None else f"{number_text(one.age, 3)} {CLOCK_UNITS[one.mode.clock]}",
        "–" if policy.age is None else duration_text(policy.age),
        number_text(1000 * policy.cost_rate, 3), number_text(1000 * policy.never, 3),
        f"{number_text(100 * policy.saving, 2)} %" if policy.saving else "–",
    ]  # fmt: skip


def _due(plan: PartPlan) -> str:
    return "–" if plan.due is None else "now" if plan.due <= 0 else duration_text(plan.due)


def _print_visit(out: Console, visit: Visit, setup: float) -> None:
    if visit.interval is None:
        out.print(f"\nA visit that costs {setup:g} is worth nothing: replace what has failed.", markup=False)
        return
    groups: dict[int, list[str]] = {}
    for name, every in visit.every.items():
        if every:
            groups.setdefault(every, []).append(name)
    what = "; ".join(
        f"{', '.join(names)} at {'each' if every == 1 else f'one in {every}'}"
        for every, names in sorted(groups.items())
    )
    between, saved = duration_text(visit.interval), 1 - visit.cost_rate / visit.apart
    out.print(f"\nTogether, at {setup:g} a visit: one every {between}: {what}", markup=False, soft_wrap=True)
    out.print(
        f"That costs {number_text(1000 * visit.cost_rate, 3)} per 1000 h, where visits of their own cost "
        f"{number_text(1000 * visit.apart, 3)} ({number_text(100 * saved, 2)} % less)", markup=False, soft_wrap=True,
    )  # fmt: skip


def _print_cycles(out: Console, cycles: LifeCycles, title: str, left_out: PartsOfUnknownRate | None) -> None:
    policies, watched = [("only what fails", cycles.failures_only), ("by age", cycles.by_age)], cycles.watched
    policies += [("watched", watched.watched)] if watched else []
    rows = [[name, *_cycle_row(one, left_out)] for name, one in policies]
    columns = ["", "cost", "90 % between", "available", "failures", "precautions"]
    out.print()
    print_table(out, table(title, columns, rows, figures=range(1, 6)))
    if left_out:
        out.print(left_out.of_costs, style="yellow", soft_wrap=True)
    if watched:
        pays = "pays" if watched.ratio > 0 else "does not pay"
        out.print(
            f"Watching costs {number_text(watched.investment, 3)} and {pays}: return on it "
            f"{number_text(100 * watched.ratio, 3)} %, with {share_text(watched.chance)} it saves "
            "anything",
            markup=False, soft_wrap=True,
        )  # fmt: skip


def _cycle_row(one: LifeCycle, left_out: PartsOfUnknownRate | None) -> list[str]:
    """The row of a life cycle. Parts are upkept each for itself: one more only adds costs, failures and standstill."""
    least, most = ("≥ ", "≤ ") if left_out else ("", "")
    return [
        f"{least}{number_text(one.cost)} ± {number_text(one.error, 2)}",
        f"{least}{number_text(one.low)} … {number_text(one.high)}", f"{most}{percent_text(one.availability)}",
        least + number_text(one.failures, 3), least + number_text(one.replacements, 3),
    ]  # fmt: skip


def _print_spares(out: Console, found: _Answers, wishes: Wishes, lead: float) -> None:
    robots = f"{wishes.robots} robot{'s' * (wishes.robots > 1)}"
    share = f"{100 * wishes.level:g} %"
    out.print(f"\nSpares that are enough for {robots} of new parts over {duration_text(lead)} with {share}:")
    numbers = [f"{name} {number}" for name, (number, _) in found.spares.items()]
    out.print("  " + ", ".join([*numbers, *(f"{name} {UNKNOWN}" for name in found.plan.unknown)]),
              markup=False, soft_wrap=True)  # fmt: skip


def _print_first(out: Console, first: list[Worth], robot: Robot) -> None:
    of_task = bool(robot.task)
    columns = ["first, for what it costs", "cost", "mean life", "per cost", *["PoTC"] * of_task]
    rows = [
        [one.part, number_text(one.cost), _signed(one.mean_life), _signed(one.mean_life_per_cost),
         *([] if one.completion is None else [number_text(one.completion)])]
        for one in first[:MOST_FIRST]
    ]  # fmt: skip
    out.print()
    print_table(out, table("What to replace first, if replaced now", columns, rows, figures=range(1, len(columns))))


def _signed(hours: float) -> str:
    if not np.isfinite(hours):
        return number_text(hours)
    return ("+" if hours > 0 else "-" if hours < 0 else "") + duration_text(abs(hours))


def _json(found: _Answers) -> dict[str, Any]:
    def cycle(one: LifeCycle | None) -> dict[str, float] | None:
        names = ("cost", "low", "high", "error", "availability", "failures", "replacements")
        return None if one is None else {name: getattr(one, name) for name in names}

    plan, visit, cycles = found.plan, found.visit, found.cycles
    watched = cycles.watched if cycles else None
    return {
        "robot": plan.robot.name,
        "parts": [
            {"part": one.path, "clock": one.mode.clock, "age": one.age, "every_hours": one.policy.age,
             "cost_per_hour": one.policy.cost_rate, "never": one.policy.never, "due_in_hours": one.due,
             "stops_robot": one.stops}
            for one in plan.parts
        ],
        "unknown": {"parts": list(plan.unknown), "first": found.first_unknown and asdict(found.first_unknown)},
        "together": visit and {"interval_hours": visit.interval, "every": dict(visit.every),
                               "cost_per_hour": visit.cost_rate, "apart": visit.apart},
        "life_cycle": {"failures_only": cycle(cycles.failures_only if cycles else None),
                       "by_age": cycle(cycles.by_age if cycles else None),
                       "watched": watched and {**(cycle(watched.watched) or {}), "investment": watched.investment,
                                               "return": watched.ratio, "chance": watched.chance}},
        "spares": {name: {"spares": number, "enough_with": sure} for name, (number, sure) in found.spares.items()}
        | dict.fromkeys(plan.unknown),
        "inspected": {
            name: {"level": one.level, "every_hours": one.policy.interval / one.pace, "others": one.known,
                   "cost_per_hour": one.policy.cost_rate * one.pace, "by_age": one.policy.by_age * one.pace,
                   "never": one.policy.never * one.pace, "age": one.policy.age, "fail_before": one.policy.fails}
            for name, one in found.inspected.items()
        } | {name: {"why": why} for name, why in found.uninspected.items()},
        "first": None if found.first is None else [one._asdict() for one in found.first],
        "ahead": found.ahead.to_json(),
    }  # fmt: skip
