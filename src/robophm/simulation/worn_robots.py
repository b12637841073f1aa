"""Robots that wear by laws of physics and fail by them: what their sensors read, and when each of their parts fails.

Three laws, one for each part that wears. Nothing of them is known to whoever foretells; each robot has its own
coefficients, and every reading its noise.

- A crack by Paris' law (J. Basic Eng. 85, 1963): da/dt = C·a^(m/2), C lognormal, m normal; a₀ and the critical size.
- A battery whose loss of capacity saturates: Q·(1 − exp(−(t/τ)^p)); of some, Q lies below what is too much.
- A gear that loses metal by steps, some an hour, each the larger the higher the load of that hour, which goes on for
  hours before it changes.

Besides, a controller and two computers, one of which is enough, fail by chance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

HOURS = 600
"""The longest life that is drawn [h]."""

CRACK, BATTERY, GEAR = 4.0, 0.30, 10.0
"""Wear at which each part fails: mm, share of the capacity, g."""

CONTROLLER, COMPUTER = 1e-3, 3e-3
"""Failures by chance of each [1/h]."""

NOISE = {"link": 0.05, "battery": 0.006, "gear": 0.15}
"""Standard deviation of a reading."""

LIMITS = {"link": CRACK, "battery": BATTERY, "gear": GEAR}


@dataclass(frozen=True)
class WornRobot:
    """One robot: readings every hour until it is asked what it can do, and when it fails."""

    readings: dict[str, Array]
    """Readings of each part that wears, at 0, 1, 2, … h; shape (hours,)."""
    asked: float
    """The hour of the last reading; it works then."""
    task: float
    """Time that it shall work on [h]."""
    fails: float
    """Time when it fails [h]."""
    ends: dict[str, float]
    """Time when each part that wears fails [h]; infinite where it never does."""

    @property
    def completed(self) -> bool:
        """Whether it worked on for so long."""
        return self.fails > self.asked + self.task


def worn_robots(count: int, seed: int) -> list[WornRobot]:
    """Return ``count`` robots, each asked once while it works, of a task whose length has nothing to do with it.

    Those that fail before they would be asked are not asked.
    """
    rng = np.random.default_rng(seed)
    found: list[WornRobot] = []
    while len(found) < count:
        asked, task = int(rng.integers(30, 160)), float(rng.uniform(2.0, 60.0))
        courses = {"link": _crack(rng), "battery": _battery(rng), "gear": _gear(rng)}
        ends = {name: _passage(courses[name], limit) for name, limit in LIMITS.items()}
        by_chance = float(rng.exponential(1 / CONTROLLER)), float(rng.exponential(1 / COMPUTER, 2).max())
        noisy = {
            name: course[: asked + 1] + NOISE[name] * rng.standard_normal(asked + 1) for name, course in courses.items()
        }
        if (fails := min(*ends.values(), *by_chance)) > asked:
            found.append(WornRobot(noisy, float(asked), task, fails, ends))
    return found


def worn_out(part: str, count: int, seed: int) -> list[Array]:
    """Return hourly readings of ``count`` parts of one kind, each from new until its wear has passed its limit."""
    rng, found = np.random.default_rng(seed), list[Array]()
    course = {"link": _crack, "battery": _battery, "gear": _gear}[part]
    while len(found) < count:
        wear = course(rng)
        if math.isfinite(end := _passage(wear, LIMITS[part])):
            found.append(wear[: math.ceil(end) + 1] + NOISE[part] * rng.standard_normal(math.ceil(end) + 1))
    return found


def _passage(course: Array, limit: float) -> float:
    """When a course that never falls reaches a limit, evenly between two hours."""
    over = np.flatnonzero(course >= limit)
    if not len(over):
        return math.inf
    i = int(over[0])
    return i - 1 + (limit - course[i - 1]) / (course[i] - course[i - 1]) if i else 0.0


def _crack(rng: np.random.Generator) -> Array:
    m, start = rng.normal(3.0, 0.15), rng.uniform(0.8, 1.2)
    rate = 0.008 * rng.lognormal(0.0, 0.35)
    power = 1 - m / 2
    inside = start**power + power * rate * np.arange(HOURS)
    return np.where(inside > 0, np.maximum(inside, 1e-9) ** (1 / power), 1e6)


def _battery(rng: np.random.Generator) -> Array:
    most, slow, power = rng.normal(0.42, 0.05), 150 * rng.lognormal(0.0, 0.3), rng.uniform(0.85, 1.15)
    return np.asarray(most * (1 - np.exp(-((np.arange(HOURS) / slow) ** power))))


def _gear(rng: np.random.Generator) -> Array:
    load = np.repeat(rng.uniform(0.6, 1.4, HOURS // 6), 6)
    steps = rng.poisson(2.0, HOURS)
    size = 0.02 * rng.lognormal(0.0, 0.3)
    lost = rng.gamma(np.maximum(4.0 * steps, 1e-12), size / 4.0) * load**2 * (steps > 0)
    return np.concatenate(([0.0], np.cumsum(lost)[:-1]))
