"""Stretches of a robot's past in which its machine's clock was not plausible, and what may be done about them.

Live, time then goes on without that clock, by one that nobody sets, so that nothing heard is lost and nothing counts
twice. What is not known is whether the robot rested for as long as the clock is ahead: whoever owns it says so.
"""

from __future__ import annotations

import functools
import math
from typing import Literal

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.health.clock_jump_removal import times_until
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger, Step, SuspectTime
from robophm.health.window import Window
from robophm.health.worn import moment

MOST_SUSPECT = 100
"""Stretches that a ledger keeps; of more, the two oldest become one."""

Verdict = Literal["taken in", "struck out"]


def hear_clock(ledger: Ledger, time: int, ahead: float) -> None:
    """Record by how much the machine's clock is ahead of the time that counts [s]; 0 or NaN: it is not."""
    known = ledger.suspect_time
    last = known[-1] if known and not known[-1].outcome else None
    if ahead and math.isfinite(ahead):
        if last and (last.ahead > 0) == (ahead > 0):
            known[-1] = last._replace(end=max(time, last.end), ahead=ahead)
            return
        if last:
            known[-1] = last._replace(outcome="passed")
        known.append(SuspectTime(time, time, ahead))
        if len(known) > MOST_SUSPECT:
            known[:2] = [known[1]._replace(begin=known[0].begin)]
    elif last:
        followed = last.ahead > 0 and time - last.end >= last.ahead * SECOND
        known[-1] = last._replace(outcome="believed" if followed else "passed")


def open_stretch(ledger: Ledger) -> SuspectTime | None:
    """Return the stretch that lasts until now; None where the clock was plausible when it was last heard."""
    return ledger.suspect_time[-1] if ledger.suspect_time and not ledger.suspect_time[-1].outcome else None


def said(one: SuspectTime) -> str:
    """Return in words what was wrong with the clock, and what became of it."""
    by = f"{abs(one.ahead) / 3600:,.2f} h {'ahead' if one.ahead > 0 else 'behind'}"
    where = f"from {moment(one.begin)} to {moment(one.end)} the clock was {by}"
    ends = {
        "": "time goes on without it; robophm store repair takes the difference in, or strikes it out",
        "passed": "time went on without it",
        "believed": "time went on without it, then it was believed, and the difference counts as rest",
        "taken in": "the difference was taken in as rest",
        "struck out": "the difference was struck out",
    }
    return f"{where}: {ends[one.outcome]}"


def settle(robot: Robot, ledger: Ledger, verdict: Verdict) -> SuspectTime:
    """Bring the ledger's time to the clock that it went on without; return the stretch that was open.

    ``taken in``: the robot rested for the difference, which counts on calendar clocks. ``struck out``: there was no
    such time, and it counts on none. Raises RobophmError where the clock is plausible, or time would have to go back to
    be taken in.
    """
    if (stretch := open_stretch(ledger)) is None or ledger.newest is None:
        raise RobophmError("the clock was plausible when it was last heard: there is nothing to take in or strike out")
    if verdict == "taken in" and stretch.ahead < 0:
        raise RobophmError("the clock is behind the past: nothing can be taken in; expected it to be struck out")
    exposure = ExposureIntegrator(robot)
    columns, ledger.pending = ledger.pending.columns(), Window()
    begun = ledger.newest if ledger.integrated_to is None else max(ledger.newest, ledger.integrated_to)
    exposure.integrate_columns(ledger, columns, [begun])
    now = begun + round(stretch.ahead * SECOND)
    if verdict == "taken in":
        _rest_until(robot, exposure, ledger, now)
    elif stretch.ahead < 0:
        times_until(robot, ledger, now)
        ledger.history = _joined(ledger.history, now)
    ledger.integrated_to = ledger.newest = now
    ledger.ended, ledger.aside = None, []
    done = ledger.suspect_time[-1] = stretch._replace(outcome=verdict)
    return done


def _rest_until(robot: Robot, exposure: ExposureIntegrator, ledger: Ledger, now: int) -> None:
    """Integrate to a time, the robot being off."""
    if (power := ledger.last.get(robot.powered or "")) is not None and robot.powered:
        ledger.last[robot.powered] = power[0], (0.0,)
    if ledger.newest is not None:
        ledger.ends.append(ledger.newest)
    exposure.integrate_columns(ledger, {}, [now])
    if power is not None and robot.powered:
        ledger.last[robot.powered] = power


def _joined(steps: list[Step], now: int) -> list[Step]:
    """Steps of a past of which none ends after a time: those that would are one, which ends then."""
    kept = [step for step in steps if step.end <= now]
    later = [step for step in steps if step.end > now]
    return [*kept, functools.reduce(Step.then, later)._replace(end=now)] if later else kept
