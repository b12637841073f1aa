"""The robot of the scripted visit: forty days of a courier that works, fails and is repaired, then one that goes wrong.

Its past is made by the commands that anybody would use: ``robophm replay`` and ``robophm service``. What must be found
out about it follows from its design, by closed forms.
"""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..conftest import Served, serving

HOUR, DAY = 3600, 86_400
BEGIN = 1_790_000_000 // DAY * DAY
"""Time of its first sample [s since the epoch], a midnight."""
DAYS = 40
SHIFT = (9 * HOUR, 17 * HOUR)
"""Between which times of a day it is on [s]."""
FAILED = (6, 21, 33)
"""Days after whose shifts a caster wheel had failed and was replaced."""
HOT = BEGIN + DAYS * DAY + SHIFT[0] + HOUR // 3
"""Since when its drive is at 45 °C: twenty above its reference, four times as fast as designed."""

MOTOR, CASTER, OTHER = 2e-4, 6e-4, 6e-4
"""Rates of one of two motors, which wear, of one of four caster wheels, and of all else [1/h]."""
SHAPE = 3.0
WHEEL = "caster wheel with its swivel bearing"

DESIGN = f"""\
schema_version: 1
name: courier
usage: {{operating: 8 h/day}}
max_gap: 15 min
task: {{distance: 360 m, speed: 0.1 m/s}}
thresholds:
  hazard_rate: {{limit: 9e-3 /h, delay: 1 min}}
  warning: {{reliability: 0.5}}
acceleration: {{model: q10, reference_temperature: 25 degC}}
modules:
  drive:
    signals: {{temperature: {{topic: /drive, field: temperature, unit: degC, range: [-40, 125], max_age: 15 min}}}}
    components:
      motor: {{quantity: 2, rate: {MOTOR} /h, life: {{distribution: weibull, shape: {SHAPE}}}}}
      {WHEEL}: {{quantity: 4, rate: {CASTER} /h}}
      encoder: {{quantity: 2, required: 1, rate: 1e-6 /h}}
  power:
    components:
      battery: {{rate: {OTHER / 2} /h}}
      step-down converter: {{rate: {OTHER / 4} /h}}
  navigation:
    diagram: {{series: [computer, {{parallel: [lidar, stereo camera]}}]}}
    signals: {{temperature: {{topic: /computer, field: temperature, unit: degC, range: [-40, 125], max_age: 15 min}}}}
    components:
      lidar: {{rate: 1e-6 /h}}
      stereo camera: {{rate: 3e-6 /h}}
      computer: {{rate: {OTHER / 4} /h}}
"""

Rows = list[tuple[int, float, float]]
"""Times [s], and temperatures of drive and computer [°C]."""


def recorded(path: Path, rows: Rows) -> Path:
    """Write a recording, a table of signals."""
    lines = [f"{at},{drive},{computer}" for at, drive, computer in rows]
    path.write_text("\n".join(["time,/drive.temperature,/computer.temperature", *lines]) + "\n")
    return path


def robophm(*words: str | Path) -> None:
    """Run a command. Raises CalledProcessError where it is not content."""
    subprocess.run([sys.executable, "-m", "robophm", *words], check=True, stdout=subprocess.DEVNULL)


@contextmanager
def visited_robot(folder: Path) -> Iterator[Served]:
    """The courier, watched on the day that goes wrong, of which a minute lasts a second."""
    design, past = folder / "courier.yaml", folder / "courier.past"
    design.write_text(DESIGN)
    begin = 0
    for end in (*FAILED, DAYS):
        rows: Rows = [(BEGIN + day * DAY + t, 25.0, 25.0) for day in range(begin, end) for t in range(*SHIFT, 600)]
        robophm("replay", design, recorded(folder / f"until-day-{end}.csv", rows), "--store", past)
        if end in FAILED:
            noted = ("--failed", "--by", "Workshop", "--note", "bearing seized")
            robophm("service", design, f"drive/{WHEEL}", "--store", past, "--replaced", *noted)
        begin = end
    today: Rows = [
        (at, 45.0 if at >= HOT else 25.0 + math.sin(at / 900), 25.0 + 2 * math.sin(at / 1200))
        for at in range(BEGIN + DAYS * DAY + SHIFT[0], BEGIN + (DAYS + 1) * DAY, 10)
    ]
    with serving(design, store=past, recordings=(recorded(folder / "today.csv", today),)) as served:
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 60})
        yield served


def motors_cumulative_hazard(hours: float) -> float:
    """The cumulative hazard of both motors at an age: Weibull, with the mean life that their rate says."""
    return 2 * (hours * MOTOR * math.gamma(1 + 1 / SHAPE)) ** SHAPE


def promised(days: int) -> float:
    """Failures to be expected in the last of the forty days; what stands in for another is left out."""
    until, hours = (shifts * (SHIFT[1] - SHIFT[0]) / HOUR for shifts in (DAYS, days))
    return hours * (4 * CASTER + OTHER) + motors_cumulative_hazard(until) - motors_cumulative_hazard(until - hours)
