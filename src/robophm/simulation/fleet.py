"""A fleet's folder: the design, and for each robot its plan, what its sensors said, what it did, what failed."""

from __future__ import annotations

import csv
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import numpy.typing as npt

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.simulation.design import Design
from robophm.simulation.design_file import Library, read_design
from robophm.simulation.plan import MOST_LEGS, MOST_TASKS, Plans, draw_plans, legs_of, plan_text
from robophm.simulation.robots import END, FAILED, INSPECTED, NO_MODE, REPLACED, ROBOT, Lives, live

BEGIN = 1_767_225_600
"""Time when every robot begins: 2026-01-01 00:00 UTC, in seconds since the epoch."""

MOST_ROBOTS = 10_000_000
MOST_DONE = 100_000
"""The most tasks of one robot."""

_BATCH = 1000
_NUMBERS = 4_000_000  # about so many are held at once, which bounds the memory
_EVENTS = {FAILED: "failed", REPLACED: "replaced", INSPECTED: "inspected", END: "end"}


@dataclass(frozen=True)
class Fleet:
    """A simulated fleet and the folder that it lies in."""

    output: Path
    seed: int
    robots: int
    tasks: int
    """Performed by all robots together."""
    failed: int
    """Number of the tasks that failed."""
    refused: int
    """Starts before which a robot had to be repaired."""
    parts_failed: int
    """Number of parts that failed within the record."""


def simulate(
    design: Path,
    output: Path,
    robots: int,
    tasks: int,
    seed: int,
    on_robot: Callable[[int], None] | None = None,
    *,
    uncertain_rates: bool = False,
    library: Library | None = None,
) -> Fleet:
    """Simulate robots of one design and write the fleet's folder, whole or not at all.

    Each robot does at least so many tasks, to the end of a round of its plan. ``on_robot`` is told how many robots are
    written. ``uncertain_rates``: each robot draws its own true rates from the design's ``uncertainty``; else the stated
    ones are true. ``library`` completes components that name a part of a library: it is given, since nothing of the
    engine is imported here. The same seed writes the same bytes. Raises RobophmError where the folder holds anything or
    cannot be made, and DesignError for what is not simulated.
    """
    for what, number, least, most in (("robots", robots, 1, MOST_ROBOTS), ("tasks", tasks, 1, MOST_DONE)):
        if not least <= number <= most:
            raise RobophmError(f"{number} {what}; expected {least} … {most:,}")
    if seed < 0:
        raise RobophmError(f"seed {seed}; expected at least 0")
    if output.exists() and (not output.is_dir() or any(output.iterdir())):
        raise RobophmError(f"{output}: exists and is not empty; expected a folder of its own")
    robot = read_design(design, library)
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        made = Path(tempfile.mkdtemp(prefix=f".{output.name}.", dir=output.parent))
        try:
            shutil.copyfile(design, made / "robot.yaml")
            counts = _write(robot, made, robots, tasks, seed, on_robot or (lambda _: None), uncertain_rates)
            made.chmod(0o755)
            if output.exists():
                output.rmdir()
            made.rename(output)
        finally:
            shutil.rmtree(made, ignore_errors=True)
    except OSError as error:
        raise RobophmError(f"{output}: cannot be written: {error.strerror or error}") from None
    return Fleet(output, seed, robots, *counts)


def _write(
    design: Design, folder: Path, robots: int, tasks: int, seed: int, on_robot: Callable[[int], None], uncertain: bool
) -> tuple[int, int, int, int]:
    """Tasks done and failed, starts refused, parts failed."""
    for name in ("recordings", "plans"):
        (folder / name).mkdir()
    digits = len(str(robots))
    each = (tasks + MOST_TASKS) * MOST_LEGS * (len(design.signals) + 4) + len(design.modes) * (
        MOST_TASKS * MOST_LEGS + tasks
    )
    batch = max(1, min(_BATCH, _NUMBERS // each))
    done = failed = refused = parts_failed = 0
    keys = [key for signal in design.signals for key in signal.keys]
    with _text(folder / "tasks.csv") as task_file, _text(folder / "failures.csv") as failure_file:
        task_rows, failure_rows = (csv.writer(file, lineterminator="\n") for file in (task_file, failure_file))
        legs = ["distance", "speed", "duration", "functions", *keys]
        task_rows.writerow(["robot", "task", "start", "end", "outcome", *legs])
        failure_rows.writerow(["robot", "part", "time", "event", "mode"])
        for number, first in enumerate(range(0, robots, batch)):
            rng = np.random.default_rng([seed, number])
            names = [f"{i + 1:0{digits}}" for i in range(first, min(first + batch, robots))]
            plans = draw_plans(design, len(names), rng)
            lives = live(design, plans, tasks, rng, uncertain_rates=uncertain)
            times = _Times(lives)
            for b, name in enumerate(names):
                (folder / "plans" / f"robot-{name}.yaml").write_text(plan_text(design, plans, b), encoding="utf-8")
                with _text(folder / "recordings" / f"robot-{name}.csv") as file:
                    _record(design, times, b, file)
                task_rows.writerows(_tasks(design, plans, lives, times, b, f"robot-{name}", keys))
                on_robot(first + b + 1)
            failure_rows.writerows(_failures(design, lives, [f"robot-{name}" for name in names]))
            done += int(np.sum(lives.done))
            failed += int(np.sum(lives.failed))
            refused += lives.refused
            parts_failed += sum(int((one.modes != NO_MODE).sum()) for one in lives.events if one.what == FAILED)
    return done, failed, refused, parts_failed


def _text(path: Path) -> TextIO:
    return path.open("w", encoding="utf-8", newline="")


def _nanoseconds(seconds: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    return np.rint(seconds * SECOND).astype(np.int64)


def _time(nanoseconds: int) -> str:
    """Seconds since the epoch, exact."""
    whole, rest = divmod(nanoseconds, SECOND)
    return f"{BEGIN + whole}.{rest:09}".rstrip("0").rstrip(".")


class _Times:
    """Times and stresses of lives, laid out robot by robot: times [ns] first by robot, then by leg or task."""

    def __init__(self, lives: Lives) -> None:
        self.begins, self.ends, self.starts, self.stops = (
            _nanoseconds(np.stack(times, axis=1))
            for times in (
                [piece.begin for piece in lives.pieces],
                [piece.end for piece in lives.pieces],
                lives.starts,
                lives.ends,
            )
        )
        self.speeds = np.stack([piece.speed for piece in lives.pieces], axis=1)
        self.stresses = np.stack([piece.stress for piece in lives.pieces], axis=1)
        self.end = _nanoseconds(lives.end)


def _record(design: Design, times: _Times, b: int, file: TextIO) -> None:
    """Write a robot's sensor record: at every change, and again before it is too old; off, only that it is off."""
    file.write(",".join(["time", design.powered, *(name for name, _ in design.speed),
                         *(signal.name for signal in design.signals)]) + "\n")  # fmt: skip
    step = int(0.8 * min(design.max_age, 1e9) * SECOND)
    silence = ",0" + ",0" * len(design.speed) + "," * len(design.signals) + "\n"
    last = 0
    for p in np.flatnonzero(times.ends[b] > times.begins[b]):
        begin, end = int(times.begins[b, p]), int(times.ends[b, p])
        if begin > last:
            file.write(_time(last) + silence)
        said = ["1", *(f"{times.speeds[b, p] / unit:.12g}" for _, unit in design.speed)]
        said += [
            f"{(reading - signal.offset) / signal.scale:.12g}"
            for signal, reading in zip(design.signals, times.stresses[b, p], strict=True)
        ]
        text = "," + ",".join(said) + "\n"
        for time in range(begin, end, step):
            file.write(_time(time) + text)
        last = end
    for time in sorted({last, int(times.end[b])}):
        file.write(_time(time) + silence)


def _tasks(
    design: Design, plans: Plans, lives: Lives, times: _Times, b: int, name: str, keys: list[str]
) -> list[list[str]]:
    """Rows of the tasks that a robot did, one for each leg, as it was planned."""
    rows = []
    for j, (done, slots, failed) in enumerate(zip(lives.done, lives.slots, lives.failed, strict=True)):
        if not done[b]:
            continue
        start, end = _time(int(times.starts[b, j])), _time(int(times.stops[b, j]))
        said = [name, str(j + 1), start, end, "failed" if failed[b] else "completed"]
        for leg in legs_of(design, plans, b, int(slots[b])):
            stresses: Any = leg.get("stresses", {})
            functions: Any = leg.get("functions", [])
            cells = [str(leg.get(key, "")) for key in ("distance", "speed", "duration")]
            rows.append([*said, *cells, ";".join(functions), *(stresses[key] for key in keys)])
    return rows


def _failures(design: Design, lives: Lives, names: list[str]) -> list[list[str]]:
    """Every event of these robots, robot by robot in order of time."""
    robots, parts, modes, seconds = (np.concatenate(one) for one in list(zip(*lives.events, strict=True))[:4])
    times = _nanoseconds(seconds)
    kinds = np.concatenate([np.full(len(one.robots), one.what) for one in lives.events])
    order = np.lexsort((np.where(parts == ROBOT, len(design.parts), parts), kinds, times, robots))
    labels = (*design.parts, "")  # the robot as a whole, −1, is the last
    named = (*(mode.name for mode in design.modes), "")  # NO_MODE, −1, is the last
    rows = zip(*(column[order].tolist() for column in (robots, parts, times, kinds, modes)), strict=True)
    return [[names[robot], labels[part], _time(time), _EVENTS[kind], named[mode]]
            for robot, part, time, kind, mode in rows]  # fmt: skip
