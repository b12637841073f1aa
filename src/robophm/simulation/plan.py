"""Plans of simulated robots: a list of tasks of one to three legs, begun anew every so often, for ever."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robophm.simulation.design import INPUTS, Design, Signal

Array = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

MOST_TASKS = 3
MOST_LEGS = 3

JITTER = {"temperature": 1.0, "load": 0.02, "voltage": 0.01}
"""The most that a recorded stress is off its plan: K, share of the rated load, share of the voltage."""

DIGITS = {"temperature": 2, "load": 3, "voltage": 3}
"""Decimals of what a sensor says: what it says is the truth to the last digit."""


@dataclass(frozen=True)
class Plans:
    """The plans of some robots (b); by task (l), leg (k), function (f, the last is the whole robot), signal (s)."""

    every: Array
    """Period after which the list begins anew [s], shape (b,)."""
    tasks: npt.NDArray[np.int64]
    """Number of tasks in the list, shape (b,)."""
    seconds: Array
    """Duration of each leg, zero where there is none, shape (b, l, k)."""
    speed: Array
    """Speed of each leg [m/s], zero where the robot stands, shape (b, l, k)."""
    needs: Flags
    """Whether the leg needs the function, shape (b, l, k, f)."""
    stress: Array
    """Reading of each sensor, shape (b, l, k, s)."""


def draw_plans(design: Design, robots: int, rng: np.random.Generator) -> Plans:
    """A plan for each robot: legs of 5 to 40 min, half of them driven, each with its own stresses and functions."""
    shape = (robots, MOST_TASKS, MOST_LEGS)
    tasks = rng.integers(1, MOST_TASKS + 1, robots)
    legs = rng.integers(1, MOST_LEGS + 1, shape[:2])
    there = np.arange(MOST_LEGS) < legs[..., None]
    there &= (np.arange(MOST_TASKS) < tasks[:, None])[..., None]
    seconds = rng.integers(5, 41, shape) * 60.0 * there
    driven = rng.random(shape) < 0.5
    speed = rng.integers(4, 21, shape) * 0.05 * (driven & there)
    functions = len(design.functions)
    needs = np.zeros((*shape, functions + 1), dtype=bool)
    needs[..., -1] = rng.random(shape) < 0.2 if functions else True
    some = rng.random((*shape, functions))
    if functions:  # one always, each other one now and then
        needs[..., :-1] = (some == some.max(axis=-1, keepdims=True)) | (some < 0.15)
        needs[..., :-1] &= ~needs[..., -1:]
    stress = np.empty((*shape, len(design.signals)))
    for i, signal in enumerate(design.signals):
        stress[..., i] = within(signal, _stress(signal, shape, rng), JITTER[signal.input])
    share = np.clip(design.usage["operating"] * rng.uniform(0.7, 1.3, robots), 0.01, 0.95)
    every = np.ceil(seconds.sum(axis=(1, 2)) / share / 600) * 600
    return Plans(every, tasks, seconds.astype(float), np.round(speed, 2), needs, stress)


def _stress(signal: Signal, shape: tuple[int, ...], rng: np.random.Generator) -> Array:
    """The readings of a sensor in each leg, before its range is minded."""
    if signal.input == "temperature":
        return rng.uniform(15, 35, (shape[0], 1, 1)) + rng.uniform(0, 10, shape)
    if signal.input == "load":
        return rng.uniform(0.4, 1.0, shape)
    return (signal.reference or 24.0) * rng.uniform(0.9, 1.1, shape)


def within(signal: Signal, reading: Array, margin: float = 0.0) -> Array:
    """A reading as the sensor can say it: in its range, with few digits."""
    low, high = signal.low + margin, signal.high - margin
    if low > high:
        low = high = (signal.low + signal.high) / 2
    return np.asarray(np.round(np.clip(reading, low, high), DIGITS[signal.input]), dtype=float)


def legs_of(design: Design, plans: Plans, robot: int, task: int) -> list[dict[str, object]]:
    """The legs of a task as a task file says them: quantities as text, functions and stresses by name."""
    legs: list[dict[str, object]] = []
    names = list(design.functions)
    for k in np.flatnonzero(plans.seconds[robot, task]):
        seconds, speed = plans.seconds[robot, task, k], plans.speed[robot, task, k]
        leg: dict[str, object] = {"duration": f"{seconds / 60:g} min"}
        if speed:
            leg = {"distance": f"{seconds * speed:.10g} m", "speed": f"{speed:.10g} m/s"}
        if not plans.needs[robot, task, k, -1]:
            leg["functions"] = [
                name for name, needed in zip(names, plans.needs[robot, task, k], strict=False) if needed
            ]
        stresses: dict[str, str] = {}
        for signal, reading in zip(design.signals, plans.stress[robot, task, k], strict=True):
            stresses |= dict.fromkeys(signal.keys, f"{reading:.10g} {INPUTS[signal.input]}".rstrip())
        if stresses:
            leg["stresses"] = stresses
        legs.append(leg)
    return legs


def plan_text(design: Design, plans: Plans, robot: int) -> str:
    """The task file that a robot repeats."""
    lines = ["schema_version: 1", f"every: {plans.every[robot] / 60:g} min", "tasks:"]
    for task in range(plans.tasks[robot]):
        lines += [f"  - name: task {task + 1}", "    legs:"]
        # JSON is YAML: names are quoted whatever is in them.
        lines += [f"      - {json.dumps(leg, ensure_ascii=False)}" for leg in legs_of(design, plans, robot, task)]
    return "\n".join(lines) + "\n"
