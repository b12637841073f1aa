"""The plan of the robot's day: its shifts, the stations that it drives between, and how fast."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.signal import HOUR

if TYPE_CHECKING:
    Floats = NDArray[np.float64]

STATIONS = ((4.25, 2.18), (5.55, 3.54), (10.34, 3.91), (8.16, 0.82))
"""Positions x and y where the robot loads and unloads [m]; it charges at the first."""

CAPACITY = 40.0
"""Capacity of the battery [A·h]."""

DAY = 24 * HOUR
"""A day in nanoseconds [ns]."""


class Trip(NamedTuple):
    """A drive from one station to another: when [s], and how fast once it is under way [m/s]."""

    begin: float
    arrived: float
    here: int
    there: int
    cruise: float
    charging: bool


def working_shifts(start: int, duration: int, working_hours: tuple[float, float]) -> list[tuple[int, int]]:
    """Return begin and end [ns] of the times that the robot is switched on."""
    on, off = (int(hours * HOUR) for hours in working_hours)
    days = range(start - start % DAY, start + duration, DAY)
    shifts = [(max(day + on, start), min(day + off, start + duration)) for day in days]
    return [(begin, end) for begin, end in shifts if begin < end]


def plan_drive(rng: np.random.Generator, shifts: list[tuple[float, float]]) -> tuple[Floats, list[list[Trip]]]:
    """Return the drive that the robot sets out on: a row at each change of acceleration or rate of turn; and its tasks.

    Columns: time [s], speed [m/s], heading [rad], x, y [m]; from then on payload [kg] and charging (0, 1).
    """
    acceleration, turn_rate = 0.2, 0.6
    here, heading, payload, charge = 0, 0.0, 0.0, 0.9
    rows = [(0.0, 0.0, heading, *STATIONS[here], payload, 0.0)]
    tasks: list[list[Trip]] = []
    for begin, end in shifts:
        now = begin
        while True:
            there = 0 if charge < 0.3 and here else int(rng.choice([s for s in range(len(STATIONS)) if s != here]))
            dx, dy = np.subtract(STATIONS[there], STATIONS[here])
            distance = math.hypot(dx, dy)
            turn = math.remainder(math.atan2(dy, dx) - heading, math.tau)
            cruise = rng.uniform(0.25, 0.35)
            ramp = cruise / acceleration
            charging = charge < 0.3 and there == 0
            stay = (0.95 - charge) * CAPACITY / 18.0 * 3600.0 if charging else rng.uniform(10.0, 40.0)
            turned = now + max(abs(turn) / turn_rate, 1e-3)
            arrived = turned + ramp + distance / cruise
            if arrived + stay > end:
                break
            share = cruise * ramp / 2 / distance  # of the way, in each ramp
            way = [tuple(np.add(STATIONS[here], np.multiply(part, (dx, dy)))) for part in (0, share, 1 - share, 1)]
            payload = rng.uniform(5.0, 30.0) if rng.random() < 0.7 and not charging else 0.0
            rows += [
                (now, 0.0, heading, *STATIONS[here], payload, 0.0),
                (turned, 0.0, heading + turn, *way[0], payload, 0.0),
                (turned + ramp, cruise, heading + turn, *way[1], payload, 0.0),
                (arrived - ramp, cruise, heading + turn, *way[2], payload, 0.0),
                (arrived, 0.0, heading + turn, *STATIONS[there], 0.0, float(charging)),
            ]
            trip = Trip(now, arrived, here, there, cruise, charging)
            if now == begin or len(tasks[-1]) == 2 or tasks[-1][-1].charging:
                tasks.append([trip])
            else:
                tasks[-1].append(trip)
            used = 1.85 * (arrived + stay - now) + (14.0 + 1.3 * payload) / 25.0 * (arrived - now)
            charge = 0.95 if charging else charge - used / 3600.0 / CAPACITY
            now, here, heading = arrived + stay, there, heading + turn
        rows.append((now, 0.0, heading, *STATIONS[here], 0.0, 0.0))
    rows.append((max(rows[-1][0], shifts[-1][1]) + 1.0, *rows[-1][1:]))
    table: Floats = np.array(rows)
    later = np.append(np.diff(table[:, 0]) > 0, True)
    return np.compress(later, table, axis=0), tasks
