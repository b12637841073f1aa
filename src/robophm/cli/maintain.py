"""``robophm maintain``: when to replace which part, with which spares, at what cost, and whether watching pays."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer

from robophm.cli.shared.options import Design, Json
from robophm.cli.shared.output import console, print_json, print_table, table
from robophm.cli.shared.stored_past import kept
from robophm.core.errors import DataError, RobophmError, UnitError
from robophm.core.units import quantity
from robophm.design.file import load
from robophm.design.robot import CLOCK_UNITS, UNKNOWN, FailureMode, Robot
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.replacement import replacements
from robophm.health.unknown_rates import PartsOfUnknownRate, alone, few, named
from robophm.learning.maintenance.costs_table import PartCosts, read_costs
from robophm.learning.maintenance.life_cycle_costs import (
    TOGETHER,
    LifeCycle,
    Return,
    Upkept,
    return_on_watching,
    simulate,
)
from robophm.learning.maintenance.replacement_age import Costs, Policy, Visit, best_age, rescaled, together
from robophm.learning.maintenance.spares import spares
from robophm.learning.maintenance.standstill import Standstill
from robophm.life.distribution import LifeDistribution
from robophm.monitoring.monitor import Monitor
from robophm.report.words import duration_text, number_text

MOST_LIVES = 2e9
"""Of parts, in all repetitions."""

MOST_TOGETHER = 1e7
"""Of parts, in the repetitions that are in memory at a time."""

_SURE = 0.99999
"""Below it a part that is down may leave the robot working."""


@dataclass(frozen=True)
class Wishes:
    """What is asked."""

    store: Path | None
    setup: float
    hour_down: float
    horizon: str
    robots: int
    level: float
    lead: str
    repetitions: int
    seed: int
    as_json: bool


@dataclass(frozen=True)
class _Plan:
    """One part: its life in calendar hours, what it costs, when it is best replaced."""

    mode: FailureMode
    costs: PartCosts
    pace: float
    """How far its clock goes in a calendar hour."""
    upkept: Upkept
    policy: Policy
    """In calendar hours."""
    due: float | None
    """Calendar hours until it is best replaced, of a robot with a past."""
    stops: float
    """P(the robot stands still | it is down)."""
    standing: Costs
    """With what it costs that the robot may stand still meanwhile."""


def command(
    design: Design,
    costs: Annotated[Path, typer.Argument(help="a table: part, preventive, corrective, …", metavar="COSTS.CSV")],
    store: Annotated[
        Path | None, typer.Option("--store", help="the robot's past: what is due, and what to do first")
    ] = None,
    setup: Annotated[float, typer.Option(help="cost of a visit, whatever is done at it", min=0)] = 0.0,
    downtime_cost: Annotated[float, typer.Option(help="of an hour that the robot stands still", min=0)] = 0.0,
    horizon: Annotated[str, typer.Option(help="over which costs are simulated")] = "5 year",
    robots: Annotated[int, typer.Option(help="that share a stock of spares", min=1, max=1_000_000)] = 1,
    level: Annotated[float, typer.Option(help="with which spares are enough", min=0.001, max=0.99999)] = 0.95,
    lead: Annotated[str, typer.Option(help="time for which spares must do")] = "90 day",
    repetitions: Annotated[int, typer.Option(help="of the simulation", min=2, max=1_000_000)] = 2000,
    seed: Annotated[int, typer.Option(help="of the simulation", min=0)] = 0,
    as_json: Json = False,
) -> None:
    """When to replace which part, with which spares, at what cost; whether watching it pays."""
    run(design, costs, Wishes(store, setup, downtime_cost, horizon, robots, level, lead, repetitions, seed, as_json))


def run(design: Path, table_of_costs: Path, wishes: Wishes) -> None:
    """Plan, simulate, print."""
    robot = load(design)
    for option, value in (("--setup", wishes.setup), ("--downtime-cost", wishes.hour_down)):
        if not math.isfinite(value):
            raise RobophmError(f"{option} {value:g}: expected a finite cost")
    horizon, lead = _hours(wishes.horizon, "--horizon"), _hours(wishes.lead, "--lead")
    told = read_costs(table_of_costs, robot, wishes.hour_down)
    unrated = [name for name, one in told.items() if one.part.unknown]
    costs = {name: one for name, one in told.items() if name not in unrated}
    if not costs:
        raise DataError(
            f"{table_of_costs}: all parts in it are of unknown rate ({few(unrated)}); expected one with a rate"
        )
    plant = Plant(robot)
    outlook = None
    if wishes.store:
        outlook = Monitor(robot, kept(wishes.store, robot)).report(remaining_life=False).outlooks["sensor_based"]
    plans = _plans(robot, plant, costs, outlook, wishes)
    standing = Standstill(robot.diagram)
    repaired = [plan for plan in plans if plan.costs.costs.repair is not None]
    replaced = {plan.costs.part.path: plan for plan in plans if plan not in repaired}
    visit = None
    if wishes.setup > 0 and replaced:
        visit = together({name: (plan.upkept.life, plan.standing) for name, plan in replaced.items()}, wishes.setup)
    by_age = {name: plan.upkept for name, plan in replaced.items()}
    only_failed = {name: replace(part, age=None) for name, part in by_age.items()}
    without, aged = (_cycle(parts, standing, horizon, wishes) for parts in (only_failed, by_age))
    watched = None
    if any(plan.costs.watch for plan in replaced.values()):
        watched = return_on_watching(
            {name: replace(plan.upkept, watch=plan.costs.watch) for name, plan in replaced.items()}, horizon,
            wishes.repetitions, wishes.seed, aged, standing, wishes.hour_down,
        )  # fmt: skip
    stock = {
        name: spares(plan.upkept.life, lead, wishes.robots * plan.upkept.parts, wishes.level, plan.policy.age)
        for name, plan in replaced.items()
    }
    first = _first(robot, outlook, plans) if outlook else None
    if wishes.as_json:
        print_json(_json(robot, plans, visit, without, aged, watched, stock, first, unrated))
    else:
        _print(robot, plans, visit, (without, aged, watched), stock, first, unrated, wishes, horizon, lead)


def _hours(text: str, option: str) -> float:
    try:
        hours = quantity(text, "h")
    except UnitError as error:
        raise RobophmError(f"{option}: {error}") from None
    if not 0 < hours < 1e9:
        raise RobophmError(f"{option} {text}: expected a time above 0, below 1e9 h")
    return hours


def _plans(
    robot: Robot, plant: Plant, costs: Mapping[str, PartCosts], outlook: Outlook | None, wishes: Wishes
) -> list[_Plan]:
    """When each part is best replaced, its downtime as dear as it makes the robot stand still."""
    lives = {name: _life(robot, plant, one, outlook) for name, one in costs.items()}
    up: dict[str, float] = {}
    for name, one in costs.items():
        mean = lives[name][2].mean()
        each = mean / (mean + one.costs.corrective_downtime) if mean < math.inf else 1.0
        up |= dict.fromkeys(one.part.units, each ** (one.part.quantity / len(one.part.units)))
    standing = Standstill(robot.diagram)
    plans = []
    for name, one in costs.items():
        mode, pace, life = lives[name]
        stops = standing.stops(one.part.units[0], up)
        whole = one.standing(wishes.hour_down * stops)
        policy = best_age(life, whole, seed=wishes.seed)
        due = None
        if outlook is not None and policy.age is not None:
            i = next(k for k, other in enumerate(robot.modes) if other.path == mode.path)
            due = policy.age - float(outlook.age[i]) / pace
        upkept = Upkept(life, one.costs, policy.age, None, one.part.quantity, one.part.units)
        plans.append(_Plan(mode, one, pace, upkept, policy, due, stops, whole))
    return plans


def _life(
    robot: Robot, plant: Plant, said: PartCosts, outlook: Outlook | None
) -> tuple[FailureMode, float, LifeDistribution]:
    """A part's failure mode, how far its clock goes in a calendar hour, and its life in such."""
    part = said.part
    if len(part.modes) > 1:
        raise DataError(
            f"'{part.path}' fails in {len(part.modes)} ways, each with its own age; expected costs of parts "
            "that fail in one, as components of their own"
        )
    (mode,) = part.modes
    i = next(k for k, one in enumerate(robot.modes) if one.path == mode.path)
    pace = float(plant.pace[i])
    if outlook is not None:  # as it was used of late, at the stress that it had
        future = outlook.future
        gone = future.effective if mode.scaling == "age" else future.advance
        pace = float(gone[i, -1] / future.hours[-1])
    if not pace > 0:
        raise DataError(f"'{part.path}' does not age: its clock '{mode.clock}' stands still by the design's usage")
    return mode, pace, rescaled(mode.life, 1 / pace)


def _cycle(parts: Mapping[str, Upkept], standing: Standstill, horizon: float, wishes: Wishes) -> LifeCycle | None:
    if not parts:
        return None
    work = sum(
        part.parts * (1 + horizon / max(min(part.age or math.inf, part.life.mean()), 1e-9)) for part in parts.values()
    )
    if work * wishes.repetitions > MOST_LIVES or work * min(wishes.repetitions, TOGETHER) > MOST_TOGETHER:
        raise RobophmError(
            f"that is some {work:.2g} lives of parts of one robot, {wishes.repetitions:,} times over; expected a "
            "shorter --horizon or fewer --repetitions"
        )
    return simulate(parts, horizon, wishes.repetitions, wishes.seed, standing, wishes.hour_down)


class _First(NamedTuple):
    """What each part put in new would gain, and what parts of unknown rate make of that."""

    rows: list[dict[str, Any]]
    unknown: PartsOfUnknownRate | None


def _first(robot: Robot, outlook: Outlook, plans: Sequence[_Plan]) -> _First:
    """What each part put in new would gain for what it costs, the most mean life per cost first."""
    prices = {plan.costs.part.path: plan.standing.preventive * plan.costs.part.quantity for plan in plans}
    rows: list[dict[str, Any]] = []
    found = replacements(outlook, robot.diagram, robot.task)
    for one in found.parts:
        price = prices.get(one.path, 0.0)
        if not price > 0:
            continue
        rows.append({
            "part": one.path, "cost": price, "mean_life": one.mean, "mean_life_per_cost": one.mean / price,
            "completion": one.completion,
            "completion_per_cost": None if one.completion is None else one.completion / price,
        })  # fmt: skip
    rows.sort(key=lambda row: -row["mean_life_per_cost"] if math.isfinite(row["mean_life_per_cost"]) else 0.0)
    return _First(rows, found.unknown)


def _print(
    robot: Robot, plans: list[_Plan], visit: Visit | None,
    cycles: tuple[LifeCycle | None, LifeCycle | None, Return | None], stock: dict[str, tuple[int, float]],
    first: _First | None, unrated: list[str], wishes: Wishes, horizon: float, lead: float,
) -> None:  # fmt: skip
    out = console()
    left_out = alone(part for part in robot.all_components() if part.path in unrated)
    columns = [
        "",
        "replace at",
        "that is every",
        "cost per 1000 h",
        "if never",
        "saved",
        *(["due in"] if wishes.store else []),
    ]
    rows = []
    for plan in plans:
        name, policy, unit = plan.costs.part.path, plan.policy, CLOCK_UNITS[plan.mode.clock]
        age = policy.age
        rows.append([
            name,
            "never by age" if age is None else f"{number_text(age * plan.pace, 3)} {unit}",
            "–" if age is None else duration_text(age),
            number_text(1000 * policy.cost_rate, 3), number_text(1000 * policy.never, 3),
            f"{number_text(100 * policy.saving, 2)} %" if policy.saving else "–",
            *([_due(plan)] if wishes.store else []),
        ])  # fmt: skip
    rows += [[name, UNKNOWN, *["–"] * (len(columns) - 2)] for name in unrated]
    print_table(out, table(f"When to replace the parts of {robot.name}", columns, rows, figures=range(1, len(columns))))
    out.print("Costs of one part per 1000 h of calendar time. Never by age: it does not wear (β ≤ 1, or constant), or "
              "failing costs no more than replacing.", soft_wrap=True)  # fmt: skip
    if left_out:
        others = f"; all others are said as {left_out.if_never}" if any(plan.stops < _SURE for plan in plans) else ""
        out.print(f"{left_out.left_out} ({few(unrated)}): when to replace is not known{others}",
                  style="yellow", markup=False, soft_wrap=True)  # fmt: skip
    for plan in plans:
        if plan.stops < _SURE:
            out.print(
                f"{plan.costs.part.path} is redundant: while it is down the robot stands still with "
                f"{number_text(100 * plan.stops, 2)} %", markup=False, soft_wrap=True,
            )  # fmt: skip
    if visit:
        _print_visit(visit, wishes)
    by_failure, by_age, watched = cycles
    if by_failure and by_age:
        policies = [("only what fails", by_failure), ("by age", by_age)]
        policies += [("watched", watched.watched)] if watched else []
        rows = [[name, *_cycle_row(one, left_out)] for name, one in policies]
        title = f"Over {duration_text(horizon)} of one robot, {wishes.repetitions:,} times over (seed {wishes.seed})"
        columns = ["", "cost", "90 % between", "available", "failures", "precautions"]
        out.print()
        print_table(out, table(title, columns, rows, figures=range(1, 6)))
        if left_out:
            out.print(left_out.of_costs, style="yellow", soft_wrap=True)
        if watched:
            pays = "pays" if watched.ratio > 0 else "does not pay"
            out.print(
                f"Watching costs {number_text(watched.investment, 3)} and {pays}: return on it "
                f"{number_text(100 * watched.ratio, 3)} %, with {number_text(100 * watched.chance, 3)} % it saves "
                "anything",
                markup=False, soft_wrap=True,
            )  # fmt: skip
    if stock:
        robots = f"{wishes.robots} robot{'s' * (wishes.robots > 1)}"
        share = f"{100 * wishes.level:g} %"
        out.print(f"\nSpares that are enough for {robots} of new parts over {duration_text(lead)} with {share}:")
        out.print(
            "  " + ", ".join([*(f"{name} {number}" for name, (number, _) in stock.items()),
                              *(f"{name} {UNKNOWN}" for name in unrated)]),
            markup=False, soft_wrap=True,
        )  # fmt: skip
    if first and first.rows:
        columns = ["first, for what it costs", "cost", "mean life", "per cost", *(["PoTC"] if robot.task else [])]
        rows = [
            [row["part"], number_text(row["cost"]), _signed(row["mean_life"]), _signed(row["mean_life_per_cost"]),
             *([number_text(row["completion"])] if robot.task else [])]
            for row in first.rows[:20]
        ]  # fmt: skip
        out.print()
        print_table(out, table("What to replace first, put in new now", columns, rows, figures=range(1, len(columns))))
    if first and first.unknown:
        out.print(f"What to replace first: {first.unknown.aside} ({named(robot)})", style="yellow", markup=False,
                  soft_wrap=True)  # fmt: skip


def _due(plan: _Plan) -> str:
    return "–" if plan.due is None else "now" if plan.due <= 0 else duration_text(plan.due)


def _print_visit(visit: Visit, wishes: Wishes) -> None:
    out = console()
    if visit.interval is None:
        out.print(f"\nA visit that costs {wishes.setup:g} is worth nothing: replace what has failed.", markup=False)
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
    out.print(f"\nTogether, at {wishes.setup:g} a visit: one every {between}: {what}", markup=False, soft_wrap=True)
    out.print(
        f"That costs {number_text(1000 * visit.cost_rate, 3)} per 1000 h, where visits of their own cost "
        f"{number_text(1000 * visit.apart, 3)} ({number_text(100 * saved, 2)} % less)", markup=False, soft_wrap=True,
    )  # fmt: skip


def _cycle_row(one: LifeCycle, left_out: PartsOfUnknownRate | None) -> list[str]:
    """Of parts that are upkept each for itself: one more only adds costs, failures and time in which the robot stands
    still."""
    least, most = ("≥ ", "≤ ") if left_out else ("", "")
    return [
        f"{least}{number_text(one.cost)} ± {number_text(one.error, 2)}",
        f"{least}{number_text(one.low)} … {number_text(one.high)}", f"{most}{100 * one.availability:.4g} %",
        least + number_text(one.failures, 3), least + number_text(one.replacements, 3),
    ]  # fmt: skip


def _signed(hours: float) -> str:
    if not np.isfinite(hours):
        return number_text(hours)
    return ("+" if hours > 0 else "-" if hours < 0 else "") + duration_text(abs(hours))


def _json(
    robot: Robot, plans: list[_Plan], visit: Visit | None, by_failure: LifeCycle | None, by_age: LifeCycle | None,
    watched: Return | None, stock: dict[str, tuple[int, float]], first: _First | None,
    unrated: list[str],
) -> dict[str, Any]:  # fmt: skip
    def cycle(one: LifeCycle | None) -> dict[str, float] | None:
        names = ("cost", "low", "high", "error", "availability", "failures", "replacements")
        return None if one is None else {name: getattr(one, name) for name in names}

    return {
        "robot": robot.name,
        "parts": [
            {"part": p.costs.part.path, "clock": p.mode.clock, "age": p.policy.age and p.policy.age * p.pace,
             "every_hours": p.policy.age, "cost_per_hour": p.policy.cost_rate, "never": p.policy.never,
             "due_in_hours": p.due, "stops_robot": p.stops}
            for p in plans
        ],
        "unknown": {"parts": unrated, "first": first and first.unknown and asdict(first.unknown)},
        "together": visit and {"interval_hours": visit.interval, "every": dict(visit.every),
                               "cost_per_hour": visit.cost_rate, "apart": visit.apart},
        "life_cycle": {"failures_only": cycle(by_failure), "by_age": cycle(by_age),
                       "watched": watched and {**(cycle(watched.watched) or {}), "investment": watched.investment,
                                               "return": watched.ratio, "chance": watched.chance}},
        "spares": {name: {"spares": number, "enough_with": sure} for name, (number, sure) in stock.items()}
        | dict.fromkeys(unrated),
        "first": first and first.rows,
    }  # fmt: skip
