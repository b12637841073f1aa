"""``python -m benchmarks.worn_honesty``: is the probability of task completion honest where wear is in it?

Robots wear by laws that no model of ours contains (``simulation/worn_robots.py``); each is asked once, by all that its
samples said till then, whether it will do a task. The same robots are asked with their wear ignored: that must be found
out. Exits with 1 where one of both fails.
"""

from __future__ import annotations

import argparse
import os
import secrets
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import count as counted
from itertools import repeat
from typing import NamedTuple

import numpy as np

from benchmarks.honesty import FOUND_OUT, stage
from robophm.calibration.predictions import Tasks
from robophm.calibration.tasks import TaskScore, likelihood_ratio_p_value, score_tasks
from robophm.calibration.verdict import judge_tasks
from robophm.cli.shared.output import console
from robophm.core.signal import HOUR, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Leg, Task
from robophm.health.mission import Completion, completion
from robophm.learning.wear.among_others import Unit
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.seen_wear import seen_wear
from robophm.simulation.worn_robots import COMPUTER, CONTROLLER, LIMITS, WornRobot, worn_out, worn_robots

ROBOTS = 1000

EVERY = 3
"""Of the hourly readings of a teacher, each of which is one."""

DESIGN = f"""
schema_version: 1
name: worn
max_gap: 2 h
components:
  link:
    mtbf: 133 h
    life: {{distribution: weibull, shape: 2.8}}
    wear: {{topic: /wear, field: link, threshold: {LIMITS["link"]}}}
  battery:
    mtbf: 206 h
    life: {{distribution: weibull, shape: 2.7}}
    wear: {{topic: /wear, field: battery, threshold: {LIMITS["battery"]}}}
  gear:
    mtbf: 247 h
    life: {{distribution: weibull, shape: 3.4}}
    wear: {{topic: /wear, field: gear, threshold: {LIMITS["gear"]}}}
  controller: {{rate: {CONTROLLER} /h}}
  computer: {{rate: {COMPUTER} /h, quantity: 2, required: 1, monitored: false}}
"""
"""Lives are those of the population: what a design would know of such parts without their sensors."""

START = 1_700_002_800 * 10**9  # the beginning of an hour


class Asked(NamedTuple):
    """What was said of one task, and what came."""

    with_wear: Completion
    without: Completion
    completed: bool


def ask(robot: Robot, one: WornRobot, teachers: Mapping[str, Sequence[Unit]] | None = None) -> Asked | None:
    """Let a robot live through its samples, and ask it; None where a reading is at its threshold already.

    That is to be served, and not to be asked what it will do. ``teachers``: parts of its kinds that wore out.
    """
    monitor = Monitor(robot, period=3600.0)
    for k in range(int(one.asked) + 1):
        for name, values in one.readings.items():
            monitor.observe(Sample(START + k * HOUR, f"/wear.{name}", float(values[k])))
    task = Task((Leg(one.task),))
    wear = seen_wear(robot, monitor.exposure.settled(monitor.ledger), teachers or {})
    if any(worn.state == "reached" for worn in wear):
        return None
    reports = [monitor.report(remaining_life=False, wear=what) for what in (wear, ())]
    seen, blind = (completion(report.outlooks["sensor_based"], task) for report in reports)
    return Asked(seen, blind, one.completed)


def _ask_some(some: Sequence[WornRobot], teachers: int, seed: int) -> list[Asked | None]:
    robot, others = parse(DESIGN), taught(teachers, seed)
    return [ask(robot, one, others) for one in some]


def taught(count: int, seed: int) -> dict[str, list[Unit]]:
    """So many parts of each kind that wore out, of which every ``EVERY``-th reading is known."""
    found = {name: worn_out(name, count, seed) for name in LIMITS}
    return {
        name: [Unit(np.arange(0, len(wear), EVERY), wear[::EVERY]) for wear in parts] for name, parts in found.items()
    }


def asked(count: int, seed: int, jobs: int = 1, teachers: int = 0) -> Iterator[list[Asked | None]]:
    """What was said of so many robots, ten at a time, each ten with teachers of its own."""
    robots = worn_robots(count, seed)
    some = [robots[i : i + 10] for i in range(0, count, 10)]
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_ask_some, some, repeat(teachers), counted(seed + 1))


def tasks_of(said: Sequence[Asked], *, with_wear: bool) -> Tasks:
    """Predictions and outcomes, to be scored."""
    chances = [one.with_wear if with_wear else one.without for one in said]
    return Tasks(
        np.array([one.failure for one in chances]), np.array([one.probability for one in chances]),
        np.array([not one.completed for one in said]),
    )  # fmt: skip


def inside(score: TaskScore) -> bool:
    """Whether all groups of tasks lie inside their bands, which together hold 99 %."""
    return not any(one.outside for one in score.bins)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.worn_honesty", description="wear against the truth")
    parser.add_argument("--robots", type=int, default=ROBOTS, help=f"default {ROBOTS:,}")
    parser.add_argument("--teachers", type=int, default=0, help="others of each kind of part, that wore out; default 0")
    parser.add_argument("--seed", type=int, help="default a fresh one")
    arguments = parser.parse_args()
    seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
    out = console()
    alone = f"with {arguments.teachers} others of each kind as teachers" if arguments.teachers else "each alone"
    out.print(f"{arguments.robots:,} robots that wear, {alone}, one task each, seed {seed}", highlight=False)
    answers: list[Asked | None] = []
    with stage("asked") as heard:
        for some in asked(arguments.robots, seed, os.cpu_count() or 1, arguments.teachers):
            answers += some
            heard(len(answers), arguments.robots)
    said = [one for one in answers if one]
    out.print(f"{len(answers) - len(said)} of them have reached a threshold, and are not asked", highlight=False)
    ours, blind = (tasks_of(said, with_wear=which) for which in (True, False))
    score = score_tasks(ours)
    out.print("failures predicted for a task    tasks   failed   expected   99 % band", highlight=False)
    for one in score.bins:
        mark = "  outside" if one.outside else ""
        out.print(
            f"{one.lowest:11.3%} … {one.highest:10.3%} {one.tasks:12,} {one.failed:8,} {one.expected:10.1f}"
            f"   {one.band[0]:,} … {one.band[1]:,}{mark}",
            highlight=False,
        )
    p_value = likelihood_ratio_p_value(blind, ours)
    verdict = judge_tasks(score)
    out.print(f"with wear: {verdict}", markup=False, soft_wrap=True)
    out.print(f"wear ignored: {judge_tasks(score_tasks(blind))}", markup=False, soft_wrap=True)
    out.print(f"wear ignored, by the ratio of likelihoods to ours: p = {p_value:.2g}", highlight=False)
    honest = inside(score) and verdict.finding != "not calibrated" and p_value < FOUND_OUT
    out.print("honest" if honest else "not honest", style="green" if honest else "bold red")
    return 0 if honest else 1


if __name__ == "__main__":
    sys.exit(main())
