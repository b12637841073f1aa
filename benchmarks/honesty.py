"""``python -m benchmarks.honesty``: are predictions honest about robots that really fail? Exits with 1 where not.

A fleet is simulated from a fresh seed by a room that shares nothing with the engine but files; every task and every
remaining life is predicted, by us and by models that are known to be wrong, and scored against what happened. So are
the rates that are learned of fleets (``learned_rates.py``, by a fixed seed).
"""

from __future__ import annotations

import argparse
import os
import secrets
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks import learned_rates
from robophm.calibration.fleet import CONTROLS, OURS, predict_fleet
from robophm.calibration.score import Calibration, score
from robophm.calibration.tasks import likelihood_ratio_p_value
from robophm.cli.calibrate import print_calibration
from robophm.cli.shared.output import console
from robophm.simulation.fleet import simulate

DESIGN = Path(__file__).parents[1] / "examples/fleet/robot.yaml"
ROBOTS, TASKS = 20_000, 3

COVERAGE = 0.015
"""How far the share of lives in an interval may be from what it should be."""

FOUND_OUT = 1e-6
"""A control's p-value beside ours, at most."""


def faults(calibration: Calibration, controls: Mapping[str, float]) -> list[str]:
    """What is not as honest predictions, and tests that see, would have it; of controls their p-values."""
    models = {one.model: one for one in calibration.models}
    ours = models["robophm"]
    assert ours.tasks
    assert ours.lives
    found = [
        f"robophm, {what}: {verdict}"
        for what, verdict in (("tasks", ours.task_verdict), ("remaining life", ours.life_verdict))
        if verdict and verdict.finding != "calibrated"
    ]
    found += [
        f"tasks predicted to fail with {one.lowest:.3g} … {one.highest:.3g}: {one.failed} failed; "
        f"expected {one.band[0]} … {one.band[1]}"
        for one in ours.tasks.bins
        if not one.band[0] <= one.failed <= one.band[1]
    ]
    found += [
        f"{one.share:.2%} of lives ended in the {one.level:.0%} interval; expected {one.level:.0%} ± {COVERAGE:.1%}"
        for one in ours.lives.coverage
        if abs(one.share - one.level) > COVERAGE
    ]
    found += [
        f"{name} was not found out: p = {p_value:.2g}; expected < {FOUND_OUT:g}"
        for name, p_value in controls.items()
        if not p_value < FOUND_OUT
    ]
    return found


@contextmanager
def stage(what: str) -> Iterator[Callable[[int, int], None]]:
    """A line that says how far it is, and in the end how long it took."""
    start = shown = time.monotonic()
    terminal = sys.stderr.isatty()

    def heard(done: int, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if terminal and (now - shown > 0.5 or done == total):
            shown = now
            print(f"\r{what}: {done:,} of {total:,} robots, {now - start:.0f} s", end="", file=sys.stderr, flush=True)

    yield heard
    print(("\r" if terminal else "") + f"{what}: {time.monotonic() - start:.0f} s".ljust(60), file=sys.stderr)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.honesty", description="predictions against the truth")
    parser.add_argument("--robots", type=int, default=ROBOTS, help=f"default {ROBOTS:,}")
    parser.add_argument("--tasks", type=int, default=TASKS, help=f"of each robot, at least; default {TASKS}")
    parser.add_argument("--seed", type=int, help="default a fresh one")
    arguments = parser.parse_args()
    seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
    out = console()
    out.print(f"{arguments.robots:,} robots, {arguments.tasks} tasks or more each, seed {seed}", highlight=False)
    with TemporaryDirectory() as folder:
        fleet = Path(folder) / "fleet"
        with stage("simulated") as heard:
            simulate(DESIGN, fleet, arguments.robots, arguments.tasks, seed, lambda done: heard(done, arguments.robots))
        with stage("predicted") as heard:
            predictions = predict_fleet(fleet, {**OURS, **CONTROLS}, jobs=os.cpu_count() or 1, on_robot=heard)
    calibration = score(predictions)
    print_calibration(out, calibration)
    tasks, lives = (getattr(calibration.models[0], kind) for kind in ("tasks", "lives"))
    out.print("\nfailures predicted for a task    tasks   failed   expected   99 % band", highlight=False)
    for one in tasks.bins:
        out.print(
            f"{one.lowest:11.3%} … {one.highest:10.3%} {one.tasks:12,} {one.failed:8,} {one.expected:10.1f}"
            f"   {one.band[0]:,} … {one.band[1]:,}",
            highlight=False,
        )
    bars = " ".join(str(bar) for bar in lives.histogram)
    out.print(f"\nPIT: {bars}; 99 % band {lives.band[0]:,} … {lives.band[1]:,}", highlight=False)
    for one in lives.coverage:
        out.print(f"{one.level:.0%} interval: {one.share:.2%} ({one.low:.2%} … {one.high:.2%})", highlight=False)
    controls = {
        name: likelihood_ratio_p_value(predictions.tasks[name], predictions.tasks["robophm"]) for name in CONTROLS
    }
    told = ", ".join(f"{name} p = {p_value:.2g}" for name, p_value in controls.items())
    out.print(f"\nby the ratio of likelihoods to ours: {told}", highlight=False)
    wrong = faults(calibration, controls)
    with stage("rates learned"):
        rates = learned_rates.scored()
    out.print("\n".join(["", *learned_rates.text(*rates)]), highlight=False)
    wrong += learned_rates.faults(*rates)
    out.print("\n".join(["", *wrong]) if wrong else "\nhonest", style="bold red" if wrong else "green", markup=False)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
