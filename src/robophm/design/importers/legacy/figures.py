"""The 2020 tool's figures, kept so that its users can compare. They are wrong outside a series of constant rates.

Every figure here is that tool's own, with its faults: two equal parts in parallel come out worse than one; the
probability of task completion (PoTC) hangs on the length of the last leg alone; "km/h" mode divides the time of a task
by 3600 twice; in "m/s" mode a rate per hour is multiplied by seconds. Nothing else uses them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

from robophm.blocks.diagram import Block, Group, Parallel, Series, Unit
from robophm.core.errors import ModelError, StructureError, UnitError, nearest
from robophm.design.robot import Module, Robot
from robophm.design.task import Task

UnitMode = Literal["km/h", "m/s"]
UNIT_MODES: tuple[UnitMode, ...] = get_args(UnitMode)
"""The "unit" of that tool: km/h takes seconds for hours / 3600, m/s as they are, rates per hour in both."""

ReliabilityModel = Literal["exponential", "rayleigh", "weibull", "curve"]

Leg = tuple[float, float]
"""Straight from one position to the next: metres and seconds."""

MOST_LEGS = 1_000_000
"""The most legs in all repetitions of a task."""


def series_rate(rates: Iterable[float]) -> float:
    """Return the sum of the rates, Σλ."""
    return math.fsum(rates)


def parallel_rate(rates: Sequence[float]) -> float:
    """Σλ/Hₙ with Hₙ = 1 + 1/2 + … + 1/n; 0 of none. Two equal units come out at 4/3 λ, worse than one."""
    return math.fsum(rates) / math.fsum(1 / n for n in range(1, len(rates) + 1)) if rates else 0.0


def stressed_rate(
    rate: float,
    temperature: float = 25.0,
    reference_temperature: float = 25.0,
    load: float = 1.0,
    reference_load: float = 1.0,
) -> float:
    """λ · (P/P₀)³ · 2^((T − T₀)/10); temperatures in °C. That tool only ever applied the temperature."""
    return rate * (load / reference_load) ** 3 * 2 ** ((temperature - reference_temperature) / 10)


def sensor_based_rate(rate: float, temperatures: Sequence[float | None]) -> float:
    """A module's rate at the mean of its temperature sensors [°C]; a silent one (None) counts as 0 °C.

    A module without sensors keeps its rate.
    """
    if not temperatures:
        return rate
    return stressed_rate(rate, sum(0.0 if one is None else one for one in temperatures) / len(temperatures))


def reliability_at(
    seconds: float,
    rate: float,
    unit: UnitMode = "km/h",
    model: ReliabilityModel = "exponential",
    shape: float = 1.0,
) -> float:
    """R after ``seconds`` since its window was opened, at ``rate`` [1/h].

    exponential exp(−λt); curve exp(−(exp((λt)^c) − 1)); rayleigh exp(−(t/λ)²) and weibull exp(−(t/λ)^c), which have the
    wrong dimension and therefore answer 0. Raises UnitError for another unit, ModelError for another model or a number
    below zero.
    """
    if unit not in ("km/h", "m/s"):
        raise UnitError(f"unit '{unit}': the 2020 tool has km/h and m/s")
    if not (0 <= seconds < math.inf and 0 <= rate < math.inf and 0 < shape < math.inf):
        raise ModelError(f"{seconds:g} s at {rate:g} /h, shape {shape:g}: expected finite numbers of at least 0")
    time = seconds / 3600 if unit == "km/h" else seconds
    try:
        match model:
            case "exponential":
                return math.exp(-rate * time)
            case "curve":
                return math.exp(-(math.exp((rate * time) ** shape) - 1))
            case "rayleigh":
                return math.exp(-((time / rate) ** 2))
            case "weibull":
                return math.exp(-((time / rate) ** shape))
    except OverflowError:
        return 0.0
    except ZeroDivisionError:
        raise ModelError(f"{model} with the rate {rate:g} /h: the 2020 tool divides by it; expected above 0") from None
    known = ("exponential", "rayleigh", "weibull", "curve")
    raise ModelError(f"no reliability model '{model}' in the 2020 tool{nearest(str(model), known)}")


def potc_paper(reliability: float, distance: float) -> float:
    """R^d, the paper's probability of task completion. Raises ModelError for R outside 0…1 and a length below 0."""
    if not (0 <= reliability <= 1 and 0 <= distance < math.inf):
        raise ModelError(f"R = {reliability:g} over {distance:g}: expected R in 0…1 and a finite length of at least 0")
    return float(reliability**distance)


def waypoint_legs(waypoints: Sequence[Sequence[float]]) -> list[Leg]:
    """The legs between waypoints [x m, y m, speed m/s] as planned: at the speed given where each leg begins.

    Raises ModelError for what is no waypoint, and for a speed that is not above zero.
    """
    if any(len(waypoint) != 3 for waypoint in waypoints):
        raise ModelError("a waypoint has x, y and speed; expected three numbers each")
    for *_, speed in waypoints[:-1]:
        if not speed > 0:
            raise ModelError(f"a waypoint with speed {speed:g} m/s; expected above 0")
    lengths = _lengths(waypoints)
    return [(length, length / speed) for length, (*_, speed) in zip(lengths, waypoints, strict=False)]


def driven_legs(times: Sequence[float], positions: Sequence[Sequence[float]]) -> list[Leg]:
    """The legs between positions [x m, y m] as driven, in ``times`` [s]; times beyond the last leg are not looked at.

    Raises ModelError for fewer times than legs.
    """
    if len(times) < len(positions) - 1:
        raise ModelError(f"{len(times)} times for {len(positions) - 1} legs; expected one for each leg")
    return list(zip(_lengths(positions), times, strict=False))


def potc(
    reliability: float,
    rate: float,
    legs: Sequence[Leg],
    unit: UnitMode = "km/h",
    model: ReliabilityModel = "exponential",
    shape: float = 1.0,
) -> float:
    """PoTC of a task, actual by its driven legs or predicted by its waypoints' legs.

    R is carried on from leg to leg, and the answer is R^(length of the last leg): earlier lengths do not matter. In
    km/h mode lengths are in km, and times divided by 3600 twice. A task without legs answers 0, as that tool does.
    """
    return prognostic(reliability, rate, legs, 1, unit, model, shape)[1]


def prognostic(
    reliability: float,
    rate: float,
    legs: Sequence[Leg],
    repetitions: int,
    unit: UnitMode = "km/h",
    model: ReliabilityModel = "exponential",
    shape: float = 1.0,
) -> list[float]:
    """PoTC before the first and after every repetition of a task, R carried on: 1, then ``repetitions`` values.

    Raises ModelError for too many legs in all, or fewer than one repetition.
    """
    if not 1 <= repetitions <= MOST_LEGS / max(len(legs), 1):
        raise ModelError(f"{repetitions} repetitions of {len(legs)} legs; expected 1 to {MOST_LEGS:,} legs in all")
    hour, kilometre = (3600, 1000) if unit == "km/h" else (1, 1)
    steps = [(reliability_at(seconds / hour, rate, unit, model, shape), metres / kilometre) for metres, seconds in legs]
    series, completed = [1.0], 0.0
    for _ in range(repetitions):
        for works, distance in steps:
            reliability *= works
            completed = potc_paper(reliability, distance)
        series.append(completed)
    return series


@dataclass(frozen=True)
class LegacyTask:
    """The 2020 tool's figures of a robot's task."""

    reliability: float
    """R of the whole robot when the task begins."""
    actual: float
    """PoTC by the times that the legs took."""
    predicted: float
    """PoTC by the times that were planned."""
    prognostic: tuple[float, ...]
    """PoTC before the first and after every repetition as planned."""


def legacy_task(
    robot: Robot,
    legs: Sequence[Leg],
    uptime_hours: float,
    repetitions: int = 1,
    unit: UnitMode = "km/h",
    driven: Sequence[Leg] | None = None,
) -> LegacyTask:
    """Return that tool's figures of a task for a whole robot by its legacy rate, exponential.

    ``legs`` as planned (waypoint_legs makes them of waypoints), ``driven`` as they were (driven_legs; default: as
    planned). Raises StructureError for what that tool cannot draw, ModelError and UnitError as the figures do.
    """
    rate = legacy_rate(robot)
    now = reliability_at(uptime_hours * 3600, rate, unit)
    planned = prognostic(now, rate, legs, repetitions, unit)
    actual = planned[1] if driven is None else potc(now, rate, driven, unit)
    return LegacyTask(now, actual, planned[1], tuple(planned))


def legacy_tasks(
    robot: Robot, planned: Task, uptime_hours: float, repetitions: int = 1, driven: Task | None = None
) -> dict[UnitMode, LegacyTask]:
    """Return the same for a task with its legs as the design has them, in both of that tool's unit modes.

    Several tasks, joined, are to that tool one task of all their legs.
    """

    def legs(task: Task) -> list[Leg]:
        return [(leg.distance, leg.duration * 3600) for leg in task.legs]

    done = legs(driven) if driven else None
    return {unit: legacy_task(robot, legs(planned), uptime_hours, repetitions, unit, done) for unit in UNIT_MODES}


def legacy_rate(module: Module) -> float:
    """The 2020 tool's failure rate of a module as it is drawn [1/h].

    Raises StructureError for what that tool cannot draw: k-of-n groups, and clocks other than hours.
    """
    rates = {inner.path: inner for inner in module.modules}
    parts = {component.path: component for component in module.all_components()}

    def rate(block: Block) -> float:
        if isinstance(block, Group):
            raise StructureError(f"{block.name}: the 2020 tool knows no parts that depend on each other")
        if isinstance(block, Unit):
            if block.name in rates:
                return legacy_rate(rates[block.name])
            part = parts[block.name.partition("[")[0]]
            if part.required < part.quantity or any(mode.clock not in ("operating", "calendar") for mode in part.modes):
                raise StructureError(f"{part.path}: the 2020 tool knows neither k-of-n nor clocks other than hours")
            if part.unknown:
                raise StructureError(f"{part.path}: its rate is unknown, which the 2020 tool would take for zero")
            return part.quantity * math.fsum(mode.rate for mode in part.modes)
        rates_within = [rate(inner) for inner in block.blocks]
        if isinstance(block, Series):
            return series_rate(rates_within)
        if isinstance(block, Parallel):
            return parallel_rate(rates_within)
        raise StructureError("the 2020 tool knows neither k-of-n groups nor networks")

    return rate(module.wiring)


def legacy_reliability(module: Module, hours: float) -> float:
    """The 2020 tool's reliability of a module: exp(−λt) with its rate, whatever the structure."""
    return math.exp(-legacy_rate(module) * hours)


def _lengths(positions: Sequence[Sequence[float]]) -> list[float]:
    """The lengths of the straight lines between consecutive positions [m]."""
    return [math.dist(start[:2], end[:2]) for start, end in pairwise(positions)]
