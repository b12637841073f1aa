"""Repair of a ledger that counted a forward jump of the clock: the jump, and what followed it, are taken out again."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robophm.core.signal import HOUR
from robophm.design.robot import Robot
from robophm.health.clock_jumps import CLOCK_JUMP
from robophm.health.ledger import Ledger, Step
from robophm.health.window import Window


class RemovedJump(NamedTuple):
    """The stretch of time that was taken out of a ledger."""

    before: int
    """The time to which the ledger goes back [ns]."""
    until: int
    """The time to which the ledger had been integrated [ns]."""
    operating: float
    """Hours of operation behind the jump that are taken out with it."""


def take_out_jump(robot: Robot, ledger: Ledger) -> RemovedJump | None:
    """Bring a ledger back to where its first jump of the clock began; None where it has none, and nothing is changed.

    A jump is a step of the past that took longer than ``CLOCK_JUMP``. Sums are brought back by what the steps from then
    on added; of a mode whose stress scales its hazard, at the mean stress of each. Distances stay as measured.
    A part that was replaced or repaired since keeps its sums.
    """
    steps, until = ledger.history, ledger.integrated_to
    if ledger.started is None or until is None:
        return None
    first = next((i for i, step in enumerate(steps) if step.calendar * HOUR > CLOCK_JUMP), None)
    if first is None:
        return None
    before = steps[first - 1].end if first else ledger.started
    gone = steps[first:]
    _bring_back(robot, ledger, gone, before)
    ledger.history = steps[:first]
    ledger.pending, ledger.aside, ledger.ended = Window(), [], None
    times_until(robot, ledger, before)
    ledger.integrated_to = ledger.newest = before
    return RemovedJump(before, until, sum(step.operating for step in gone))


def times_until(robot: Robot, ledger: Ledger, before: int) -> None:
    """Let nothing that a ledger knows of be later than a time [ns], of which more is not known to have been.

    The history stays as it is, and so do the sums.
    """
    ledger.started = None if ledger.started is None else min(ledger.started, before)
    ledger.recent = [step for step in ledger.recent if step.end <= before]
    ledger.ends = []
    ledger.heard = None if ledger.heard is None else min(ledger.heard, before)
    ledger.off = before if ledger.off is not None and ledger.off > before else ledger.off
    ledger.last = {key: (min(time, before), values) for key, (time, values) in ledger.last.items()}
    ledger.seen = {key: seen._replace(time=min(seen.time, before)) for key, seen in ledger.seen.items()}
    ledger.replaced = {key: min(time, before) for key, time in ledger.replaced.items()}
    for mode in robot.modes:
        if mode.wear and mode.key in ledger.wear:
            ledger.wear[mode.key].until(before, mode.wear.every)
    ledger.services = [service._replace(time=min(service.time, before)) for service in ledger.services]


def _bring_back(robot: Robot, ledger: Ledger, gone: list[Step], before: int) -> None:
    served = {key for key, time in ledger.replaced.items() if time > before}
    kept = np.array([mode not in served for mode in ledger.modes])
    age, effective = (np.sum([getattr(step, name) for step in gone], axis=0) * kept for name in ("age", "effective"))
    hazard = np.zeros(len(kept))
    for i, mode in enumerate(robot.modes):
        if mode.scaling == "hazard" and kept[i]:
            initial = 0.0 if mode.key in ledger.replaced else mode.initial_exposure
            at = initial + float(ledger.age.value[i] - age[i])
            for step in gone:
                if step.age[i] > 0:
                    more = mode.life.increment(np.array([at]), np.array([step.age[i]]))
                    hazard[i] += step.effective[i] / step.age[i] * float(more[0])
                    at += float(step.age[i])
    clocks = np.zeros(len(ledger.clocks.high))
    clocks[:2] = sum(step.operating for step in gone), sum(step.calendar for step in gone)
    totals = (ledger.age, age), (ledger.effective, effective), (ledger.hazard, hazard), (ledger.clocks, clocks)
    for total, less in totals:
        total.add(-less)
        below = total.value < 0  # by rounding alone
        total.high[below], total.low[below] = 0.0, 0.0
