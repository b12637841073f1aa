"""A fleet's folder, its predictions made anew: every task when it began, every robot's remaining life once.

``robot.yaml`` is the design, ``recordings/<robot>.csv`` what sensors said, ``tasks.csv`` what was done and how it
ended, ``failures.csv`` what failed, was replaced or inspected, ``plans/<robot>.yaml`` what a robot does for ever.
Nothing of what comes later is looked at when a prediction is made.
"""

from __future__ import annotations

import csv
import os
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from decimal import Decimal, InvalidOperation
from functools import lru_cache, partial
from itertools import groupby, pairwise
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import numpy.typing as npt

from robophm.blocks.single_points import single_points_of_failure
from robophm.calibration.predictions import LEVELS, OWN, Lives, Predictions, Tasks
from robophm.core.errors import SourceError, nearest
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.core.waiting_time import time_at
from robophm.design.file import parse, read
from robophm.design.importers.legacy.figures import potc_paper
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Plan, Task
from robophm.design.task_file import Row, load_plan, plan_of_rows
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, Steps, completion_of_steps, plan_future, planned
from robophm.health.outlooks import as_lived
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import completion_at_rates
from robophm.transports.recordings.files import existing, reading
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.text import LONGEST_LINE

Array = npt.NDArray[np.float64]

MOST_BYTES = 2_000_000_000
"""Largest size of a table of a fleet [bytes]."""

_AT_ONCE = 20  # robots that a process takes

Model = Callable[[Outlook, Task, Steps], Completion]
"""A model that predicts a task from what was known when it began, and what its legs will add."""


@dataclass
class _Done:
    """A task that was begun."""

    start: int
    end: int
    task: Task
    completed: bool


@dataclass
class _Life:
    """The history of one robot: its tasks, and what happened to its parts."""

    tasks: list[_Done] = field(default_factory=list)
    events: list[tuple[int, str, str]] = field(default_factory=list)
    """Events as time, part (empty: the robot), and what happened; ascending."""


def files(folder: Path) -> list[Path]:
    """Return the files of a fleet's folder that are read."""
    named = (folder / name for name in ("robot.yaml", "tasks.csv", "failures.csv"))
    return [*named, *folder.glob("recordings/*"), *folder.glob("plans/*")]


def robophm_prediction(outlook: Outlook, task: Task, steps: Steps) -> Completion:
    """Return the tool's own prediction of a task."""
    return completion_of_steps(outlook, task, steps)


def paper_prediction(outlook: Outlook, task: Task, steps: Steps) -> Completion:
    """Return R^d of the paper: R of the robot when the task ends, d in kilometres."""
    system = outlook.plant.robot.diagram
    now = float(outlook.survival(system).works)
    after = potc_paper(now * completion_of_steps(outlook, task, steps).probability, task.distance / 1000)
    return Completion(after, 1 - after)


def doubled_rates_prediction(outlook: Outlook, task: Task, steps: Steps) -> Completion:
    """Return the prediction for a robot all of whose rates are doubled, which a test of honesty must reject."""
    return completion_at_rates(outlook, task, 2.0)


def forgetful_prediction(outlook: Outlook, task: Task, steps: Steps) -> Completion:
    """Return the prediction as if every robot were new, which a test of honesty must reject."""
    none = np.zeros(len(outlook.age))
    new = replace(
        outlook, age=outlook.plant.initial, seen_age=none, unseen_hazard=none, cumulative_hazard=none,
    )  # fmt: skip
    return completion_of_steps(new, task, steps)


OURS: dict[str, Model] = {OWN: robophm_prediction}
"""The tool's own model, by name."""

CONTROLS: dict[str, Model] = {
    "paper R^d": paper_prediction,
    "rates off by 2": doubled_rates_prediction,
    "forgets the past": forgetful_prediction,
}
"""Models that are known to be wrong: scoring must find them out."""


def predict_fleet(
    folder: Path,
    models: dict[str, Model] | None = None,
    *,
    jobs: int = 1,
    on_robot: Callable[[int, int], None] | None = None,
) -> Predictions:
    """Return predictions of every model, of which the first also foretells remaining lives.

    ``jobs`` processes share the robots; ``on_robot`` hears how many of how many are done. Raises DesignError and
    SourceError where the folder is not such a one.
    """
    models = models or dict(OURS)
    design = existing(folder / "robot.yaml")
    text = read(design)
    robot = parse(text, str(design))
    for part in robot.all_components():
        if part.quantity > 1:  # of which one is replaced while the others grow older: a ledger knows but one age
            raise SourceError(
                f"{folder / 'robot.yaml'}: {part.path} is {part.quantity} equal parts, each of which fails and is "
                f"replaced by itself; expected {part.quantity} components"
            )
    lives = _lives(folder, robot)
    if not lives:
        raise SourceError(f"{folder / 'tasks.csv'}: holds no tasks")
    jobs = min(jobs, os.cpu_count() or 1, -(-len(lives) // _AT_ONCE))  # each takes 130 MB, busy or not
    found: dict[str, list[tuple[float, float, bool]]] = {name: [] for name in models}
    remaining: list[tuple[float, ...]] = []
    with ProcessPoolExecutor(jobs, get_context("spawn")) if jobs > 1 else nullcontext() as pool:
        work = partial(_robot_predictions, folder, text, tuple(models.values()))
        done = pool.map(work, lives.items(), chunksize=_AT_ONCE) if pool else map(work, lives.items())
        for i, (tasks, life) in enumerate(done):
            for name, rows in zip(models, tasks, strict=True):
                found[name] += rows
            remaining += [(float(i), *life)] if life else []
            if on_robot:
                on_robot(i + 1, len(lives))
    tables = {name: np.array(rows).reshape(-1, 3) for name, rows in found.items()}
    told = {name: Tasks(table[:, 0], table[:, 1], table[:, 2] == 1) for name, table in tables.items()}
    if not remaining:
        return Predictions(told)
    table = np.array(remaining)
    robots = table[:, 0].astype(np.intp)
    foretold = Lives(robots, table[:, 1], table[:, 5:], table[:, 2], table[:, 3], table[:, 4] == 1)
    return Predictions(told, {next(iter(models)): foretold})


@lru_cache(maxsize=1)
def _prepared(text: str) -> tuple[Plant, ExposureIntegrator]:
    """The robot of a design's text, which each process reads once; another fleet in the same folder has another."""
    robot = parse(text, "robot.yaml")
    return Plant(robot), ExposureIntegrator(robot)


def _robot_predictions(
    folder: Path, design: str, models: Sequence[Model], named: tuple[str, _Life]
) -> tuple[list[list[tuple[float, float, bool]]], tuple[float, ...] | None]:
    """Predictions for one robot: (failure, probability, failed) of each task by each model, and its remaining life."""
    plant, exposure = _prepared(design)
    name, life = named
    observer = _Observer(name, plant, exposure, _samples(folder, name, plant.robot), life)
    found: list[list[tuple[float, float, bool]]] = [[] for _ in models]
    for done, outlook in observer.tasks():
        steps = planned(outlook, done.task)
        for says, rows in zip(models, found, strict=True):
            said = says(outlook, done.task, steps)
            rows.append((said.failure, said.probability, not done.completed))
    return found, observer.remaining(_plan(folder, name, plant.robot))


class _Observer:
    """One robot as it was observed, from task to task."""

    def __init__(
        self, name: str, plant: Plant, exposure: ExposureIntegrator, samples: list[Sample], life: _Life
    ) -> None:
        self.plant, self.exposure, self.life = plant, exposure, life
        self.samples = samples
        self.taken = 0
        self.events = 0
        self.failed: set[str] = set()
        self.ledger = Ledger.new(plant.robot)
        if samples:
            self.ledger.started = samples[0].time
            if any(done.start < samples[0].time for done in life.tasks):
                raise SourceError(f"{name}: a task starts before the first sample of its recording")
            if any(at < samples[0].time for at, _, _ in life.events):
                raise SourceError(f"{name}: an event is before the first sample of its recording")

    def tasks(self) -> Iterator[tuple[_Done, Outlook]]:
        """Yield each task with what was known when it began."""
        for done in self.life.tasks:
            self._until(done.start)
            yield done, self.outlook()
            self._do(done)

    def outlook(self) -> Outlook:
        """Return the robot as it is known now: parts that report their failure, and exposure."""
        knowledge = Knowledge(failed=frozenset(self.failed))
        return as_lived(self.plant, self.exposure, self.ledger, knowledge=knowledge)

    def _do(self, done: _Done) -> None:
        """Live through a task: what a leg does not need ages by its duty, what its end needs has worked."""
        last = {function: k for k, leg in enumerate(done.task.legs) for function in leg.functions or ("",)}
        begun = done.start
        for k, leg in enumerate(done.task.legs):
            end = min(done.end, begun + round(leg.duration * HOUR))
            if k == len(done.task.legs) - 1 and done.completed:
                end = done.end
            self._until(end, np.where(self.plant.needed(leg.functions), 1.0, self.plant.duty))
            begun = end
            if done.completed:
                proven = [self.plant.diagram(function) for function, at in last.items() if at == k]
                self._inspect(single_points_of_failure(*proven) if proven else frozenset())

    def _inspect(self, units: frozenset[str]) -> None:
        parts = (part for part in self.plant.components if units.issuperset(part.units))
        self.ledger.inspect(mode.key for part in parts for mode in part.modes)

    def _until(self, time: int, duty: Array | None = None) -> None:
        """Carry the ledger on, and take in what was seen meanwhile."""
        events = self.life.events
        while self.events < len(events) and events[self.events][0] <= time:
            at, part, what = events[self.events]
            self._integrate(at, duty)
            self._happens(part, what)
            self.events += 1
        self._integrate(time, duty)

    def _happens(self, part: str, what: str) -> None:
        if not part:
            return
        component = self.plant.components[self.plant.component_of[self.plant.place[part]]]
        keys = [mode.key for mode in component.modes]
        if what == "failed" and component.monitored:
            self.failed.add(part)
        elif what == "replaced":
            self.failed.discard(part)
            self.ledger.replace(keys)
        elif what == "inspected":  # what fails a part together with others has not happened either
            causes = (cause for cause in self.plant.robot.causes if part in cause.members)
            self.ledger.inspect([*keys, *(mode.key for cause in causes for mode in cause.modes)])

    def _integrate(self, time: int, duty: Array | None) -> None:
        if self.ledger.integrated_to is not None and time <= self.ledger.integrated_to:
            return
        end = self.taken
        while end < len(self.samples) and self.samples[end].time <= time:
            end += 1
        self.exposure.integrate(self.ledger, self.samples[self.taken : end], time, duty)
        self.taken = end

    def remaining(self, plan: Plan | None) -> tuple[float, ...] | None:
        """Return the remaining life predicted when the record ends, where what came is known.

        The robot works then, and goes on by its plan, begun anew.
        """
        ends = [at for at, part, what in self.life.events if not part and what == "end"]
        failures = [
            at for at, part, what in self.life.events if ends and at > ends[0] and what == "failed" and not part
        ]
        if plan is None or not failures:
            return None
        self._until(ends[0])
        outlook = self.outlook()
        observed = (failures[0] - ends[0]) / HOUR
        curve = outlook.curve(outlook.plant.robot.diagram, plan_future(outlook, plan))
        levels = np.array(LEVELS)
        quantiles = np.maximum.accumulate(time_at(curve, levels, 1 - levels, tolerance=1e-5))
        fraction = float(curve(np.array([observed]))[0][0])
        return ends[0] / HOUR, fraction, observed, 0.0, *quantiles


def _samples(folder: Path, name: str, robot: Robot) -> list[Sample]:
    """The samples of a robot's sensors, in order of time."""
    with open_source(folder / "recordings" / f"{name}.csv") as source:
        known = {f"{info.topic}.{field}" for info in source.topics() for field in info.fields}
        for signal in robot.signals:
            if signal not in known:
                raise SourceError(f"{folder / 'recordings' / name}.csv: no signal '{signal}'{nearest(signal, known)}")
        return sorted(source.samples(list(robot.signals)))


def _plan(folder: Path, name: str, robot: Robot) -> Plan | None:
    path = folder / "plans" / f"{name}.yaml"
    return load_plan(path, robot) if path.exists() else None


def _lives(folder: Path, robot: Robot) -> dict[str, _Life]:
    """The history of each robot by its name."""
    lives: dict[str, _Life] = defaultdict(_Life)
    path = folder / "tasks.csv"
    tasks: dict[tuple[object, ...], Task] = {}
    for (name, _, start, end, outcome), group in groupby(
        _rows(path, ("robot", "task", "start", "end", "outcome")), key=lambda row: row[1][0]
    ):
        rows = [(line, cells) for line, (_, cells) in group]
        if outcome not in ("completed", "failed"):
            raise SourceError(f"{path}:{rows[0][0]}: outcome '{outcome}'; expected completed or failed")
        legs = tuple(tuple(sorted(cells.items())) for _, cells in rows)
        if legs not in tasks:
            tasks[legs] = plan_of_rows(
                [(line, {**cells, "task": "one"}) for line, cells in rows], robot, str(path)
            ).tasks[0]
        if Path(name).name != name:
            raise SourceError(f"{path}:{rows[0][0]}: '{name}' is no robot; expected a name without strokes")
        done = _Done(_time(path, rows, start), _time(path, rows, end), tasks[legs], outcome == "completed")
        if done.end < done.start:
            raise SourceError(f"{path}:{rows[0][0]}: ends at {end}, before it starts at {start}")
        lives[name].tasks.append(done)
    path = folder / "failures.csv"
    units = {unit for part in robot.all_components() for unit in part.units}
    for line, ((name, part, time, event), _) in _rows(path, ("robot", "part", "time", "event")):
        if part and part not in units:
            raise SourceError(f"{path}:{line}: unknown part '{part}'{nearest(part, units)}")
        if event not in EVENTS:
            raise SourceError(f"{path}:{line}: event '{event}'; expected {', '.join(EVENTS)}")
        if name not in lives:
            raise SourceError(f"{path}:{line}: robot '{name}' has no task in tasks.csv{nearest(name, lives)}")
        lives[name].events.append((_time(path, [(line, {})], time), part, event))
    for name, life in lives.items():
        life.tasks.sort(key=lambda done: done.start)
        if any(one.end > following.start for one, following in pairwise(life.tasks)):
            raise SourceError(f"{folder / 'tasks.csv'}: tasks of {name} overlap; expected one after the other")
        life.events.sort(key=lambda event: event[0])
    return lives


EVENTS = ("failed", "replaced", "inspected", "end")
"""Events that may happen to a part, or to a robot as a whole."""


def _rows(path: Path, named: Sequence[str]) -> Iterator[tuple[int, tuple[tuple[str, ...], dict[str, str]]]]:
    """Line, the named cells, and the others that are not empty. Raises SourceError."""
    if existing(path).stat().st_size > MOST_BYTES:
        raise SourceError(f"{path}: is larger than {MOST_BYTES / 1e9:g} GB")
    if not path.is_file():
        raise SourceError(f"{path}: is no regular file")
    with reading(path), path.open(encoding="utf-8-sig", newline="") as stream:
        lines = iter(lambda: stream.readline(LONGEST_LINE + 1), "")
        reader = csv.reader((_whole(path, i, line) for i, line in enumerate(lines, 1)), strict=True)
        header = next(reader, [])
        for name in named:
            if name not in header:
                raise SourceError(f"{path}:1: no column '{name}'{nearest(name, header)}")
        at = [header.index(name) for name in named]
        rest = [(i, name) for i, name in enumerate(header) if name not in named]
        for cells in reader:
            if len(cells) != len(header):
                raise SourceError(f"{path}:{reader.line_num}: {len(cells)} cells; expected {len(header)}")
            others = {name: cells[i].strip() for i, name in rest if cells[i].strip()}
            yield reader.line_num, (tuple(cells[i].strip() for i in at), others)


def _whole(path: Path, number: int, line: str) -> str:
    if len(line) > LONGEST_LINE:
        raise SourceError(f"{path}:{number}: longer than {LONGEST_LINE} characters")
    return line


def _time(path: Path, rows: Sequence[Row], text: str) -> int:
    """Seconds since the epoch in nanoseconds, to the last digit."""
    try:
        seconds = Decimal(text)
    except InvalidOperation:
        raise SourceError(f"{path}:{rows[0][0]}: '{text}' is not a time; expected seconds since the epoch") from None
    if not (seconds.is_finite() and abs(seconds) < 10**10):
        raise SourceError(f"{path}:{rows[0][0]}: {text} is no time of this age; expected seconds since the epoch")
    return int(seconds * SECOND)
