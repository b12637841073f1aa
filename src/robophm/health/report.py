"""One look at a robot's health: nominal and sensor-based side by side, with all that qualifies it."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from robophm.blocks.diagram import Block
from robophm.core.signal import SECOND
from robophm.design.robot import MeasuredClock, Robot
from robophm.design.task import Knowledge, Plan, Task
from robophm.health.exposure import Exposure
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, completion, plan_future
from robophm.health.plant import Plant
from robophm.health.prognosis import FutureName, Outlook, RemainingLife, View, outlooks
from robophm.health.uncertainty import SCENARIOS, LifeUncertainty, draw_loads, life_uncertainty

SCHEMA_VERSION = 1
"""Of a report as JSON."""

VIEWS: tuple[View, ...] = ("nominal", "sensor_based")


@dataclass(frozen=True)
class Figures:
    """The health of a robot, module or function in one view."""

    hazard_rate: float
    """Now, given what is known now [1/h of operation]."""
    reliability: float
    """Probability of having survived since new."""
    unreliability: float
    """Its complement, with its own digits."""
    remaining_life: RemainingLife | None = None
    completion: Completion | None = None
    """Of the task; of a module or function, that it does its share throughout."""


def figures(
    outlook: Outlook, diagram: Block, task: Task | None, *, remaining_life: bool = True, whole: bool = True
) -> Figures:
    """All figures of one system; it is ``whole`` where the task is its own."""
    state = outlook.survival(diagram)
    return Figures(
        outlook.hazard_rate(diagram),
        float(state.works),
        float(state.failed),
        outlook.remaining_life(diagram) if remaining_life else None,
        completion(outlook, task, None if whole else diagram) if task else None,
    )


@dataclass(frozen=True)
class Subject:
    """What figures are given for: the robot, a module or a function."""

    kind: str
    """robot, module or function."""
    path: str
    nominal: Figures
    sensor_based: Figures
    flags: tuple[str, ...] = ()
    """What qualifies the sensor-based figures: 'stale /topic.field', 'extrapolated'."""


@dataclass(frozen=True)
class ComponentHealth:
    """A component in both views; hazard rates of all its equal parts together [1/h of operation]."""

    path: str
    quantity: int
    nominal_hazard_rate: float
    sensor_based_hazard_rate: float
    nominal_reliability: float
    sensor_based_reliability: float
    remaining_life: RemainingLife | None = None
    """Sensor-based, of the component alone [h]; where it was asked for."""


@dataclass(frozen=True)
class HealthReport:
    """A robot's health at one time of its own clock."""

    robot: str
    design_hash: str
    time: int | None
    """Nanoseconds since the epoch to which exposure has been integrated; None before the first sample."""
    clocks: Mapping[str, float]
    """Since the start: operating and calendar [h], and what the robot's clocks measured (kilometres [km], …)."""
    subjects: tuple[Subject, ...]
    """The robot first, then its modules outer before inner, then its functions."""
    components: tuple[ComponentHealth, ...]
    task: Task | None
    breaches: tuple[str, ...]
    """Thresholds of the design that the sensor-based figures fail."""
    notes: tuple[str, ...]
    """What was not taken, and why."""
    outlooks: Mapping[View, Outlook] = field(repr=False, compare=False)
    uncertainty: LifeUncertainty | None = None
    """Of the robot's sensor-based remaining life; where it was asked for, and rates or load are uncertain."""

    @property
    def system(self) -> Subject:
        """The robot as a whole."""
        return self.subjects[0]

    def subject(self, path: str) -> Subject:
        """A module or function by its path. Raises KeyError."""
        for subject in self.subjects:
            if subject.path == path:
                return subject
        raise KeyError(path)

    def reliability(self, hours: float, view: View = "sensor_based") -> float:
        """Survival since new after so many more operating hours of the same use."""
        outlook = self.outlooks[view]
        return float(outlook.reliability_curve(outlook.plant.robot.diagram, np.array([hours]))[0][0])

    def remaining_life(self, view: View = "sensor_based") -> RemainingLife:
        """Of the robot [h]."""
        outlook = self.outlooks[view]
        return outlook.remaining_life(outlook.plant.robot.diagram)

    def completion(self, task: Task, view: View = "sensor_based") -> Completion:
        """Of a task by the robot as it is now."""
        return completion(self.outlooks[view], task)

    def to_json(self) -> dict[str, Any]:
        """As plain values, schema-versioned; infinite times are null."""
        names = ("robot", "design_hash", "time", "clocks")
        return {
            "schema_version": SCHEMA_VERSION,
            **{name: getattr(self, name) for name in names},
            "subjects": [plain(asdict(subject)) for subject in self.subjects],
            "components": [plain(asdict(component)) for component in self.components],
            "task": task_to_json(self.task) if self.task else None,
            "uncertainty": plain({name: interval._asdict() for name, interval in vars(self.uncertainty).items()})
            if self.uncertainty
            else None,
            "breaches": list(self.breaches),
            "notes": list(self.notes),
        }

    def _repr_html_(self) -> str:
        """A table, for a notebook."""
        from html import escape

        head = "".join(
            f"<th>{h}</th>"
            for h in ("", "λ nominal [1/h]", "λ sensor", "R nominal", "R sensor", "RUL median [h]", "PoTC")
        )
        rows = []
        for one in self.subjects:
            n, s = one.nominal, one.sensor_based
            life = f"{s.remaining_life.median:.4g}" if s.remaining_life else "–"
            task = f"{s.completion.probability:.6g}" if s.completion else "–"
            cells = (
                f"{n.hazard_rate:.4g}",
                f"{s.hazard_rate:.4g}",
                f"{n.reliability:.6g}",
                f"{s.reliability:.6g}",
                life,
                task,
            )
            rows.append(f"<tr><th>{escape(one.path)}</th>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
        return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def health_report(
    plant: Plant, exposure: Exposure, ledger: Ledger, *,
    task: Task | None = None, remaining_life: bool = True,
    future: FutureName = "recent", plan: Plan | None = None, knowledge: Knowledge | None = None,
    draws: int = 0, parts: bool = False,
) -> HealthReport:  # fmt: skip
    """The health that a ledger tells of; ``task`` is the design's unless given. Remaining life is the slow part.

    Under a ``plan`` the robot does its tasks again and again for the rest of its life. ``draws`` of uncertain rates and
    loads tell how far the remaining life may lie; ``parts``: state that of every component too.
    """
    robot = plant.robot
    task = task or robot.task
    views = outlooks(plant, exposure, ledger, future=future, knowledge=knowledge)
    if plan:
        views = {view: replace(outlook, plan=plan_future(outlook, plan)) for view, outlook in views.items()}
    lived = views["sensor_based"]
    silent = set(exposure.silent(ledger)) if ledger.integrated_to is not None else set()  # a mere look ahead
    systems = [("robot", robot.name, robot.diagram), *(("module", m.path, m.diagram) for m in robot.all_modules())]
    systems += [("function", name, diagram) for name, diagram in robot.functions.items()]
    subjects = tuple(
        Subject(
            kind,
            path,
            *_both(views, kind, diagram, task, remaining_life),
            _flags(plant, diagram, ledger, silent, robot.clocks.values() if kind == "robot" else ()),
        )
        for kind, path, diagram in systems
    )
    rates, survival = (
        [getattr(views[view], method)() for view in VIEWS]
        for method in ("component_hazard_rates", "component_survival")
    )
    components = tuple(
        ComponentHealth(
            component.path,
            component.quantity,
            float(rates[0][i]),
            float(rates[1][i]),
            float(survival[0][i]),
            float(survival[1][i]),
            remaining_life=lived.remaining_life(plant.alone[i]) if parts else None,
        )
        for i, component in enumerate(plant.components)
    )
    clocks = ledger.clocks.value
    return HealthReport(
        robot.name,
        robot.design_hash,
        ledger.integrated_to,
        {name: float(total) for name, total in zip(("operating", "calendar", *robot.clocks), clocks, strict=True)},
        subjects,
        components,
        task,
        _breaches(robot, subjects[0].sensor_based),
        _notes(ledger),
        views,
        _uncertainty(plant, ledger, lived, plan, draws),
    )


def _uncertainty(plant: Plant, ledger: Ledger, lived: Outlook, plan: Plan | None, draws: int) -> LifeUncertainty | None:
    """None where nothing is uncertain: rates as stated, and a plan or too short a past."""
    loads = draw_loads(plant, ledger, SCENARIOS, seed=0) if draws and not plan else []
    if not draws or not (loads or any(mode.uncertainty for mode in plant.robot.modes)):
        return None
    return life_uncertainty(lived, plant.robot.diagram, loads=loads, draws=draws)


def _both(
    views: Mapping[View, Outlook], kind: str, diagram: Block, task: Task | None, remaining_life: bool
) -> tuple[Figures, Figures]:
    nominal, sensor_based = (
        figures(views[view], diagram, task, remaining_life=remaining_life, whole=kind == "robot") for view in VIEWS
    )
    return nominal, sensor_based


def _flags(
    plant: Plant, diagram: Block, ledger: Ledger, silent: Collection[str], odometers: Iterable[MeasuredClock]
) -> tuple[str, ...]:
    """What qualifies a system: the silent signals that its parts hang on, and models outside their range."""
    modes = [plant.robot.modes[i] for i in plant.system(diagram).modes]
    heard_by = {channel.signal for mode in modes for stress in mode.stresses for channel in stress.channels.values()}
    for clock in (*odometers, *(mode.measured_clock for mode in modes)):
        heard_by |= set(clock.signals) if clock else set()
    extrapolated = any(ledger.extrapolated[mode.path] for mode in modes)
    return (
        *(f"stale {signal}" for signal in sorted(heard_by & set(silent))),
        *(["extrapolated"] if extrapolated else []),
    )


def _breaches(robot: Robot, figures: Figures) -> tuple[str, ...]:
    limits = robot.thresholds
    found = []
    if limits.hazard_rate is not None and not figures.hazard_rate <= limits.hazard_rate:
        found.append(f"hazard rate {figures.hazard_rate:.4g} /h is above {limits.hazard_rate:.4g} /h")
    if limits.reliability is not None and not figures.reliability >= limits.reliability:
        found.append(f"reliability {figures.reliability:.6g} is below {limits.reliability:g}")
    life, completion = figures.remaining_life, figures.completion
    if limits.remaining_life is not None and life and not life.median >= limits.remaining_life:
        found.append(f"median remaining life {life.median:.4g} h is below {limits.remaining_life:g} h")
    if limits.completion is not None and completion and not completion.probability >= limits.completion:
        found.append(f"probability of task completion {completion.probability:.6g} is below {limits.completion:g}")
    return tuple(found)


def _notes(ledger: Ledger) -> tuple[str, ...]:
    dropped = [f"{count} samples not taken: {reason}" for reason, count in sorted(ledger.counts.items())]
    silent: dict[int, list[str]] = {}
    for key, nanoseconds in sorted(ledger.stale.items()):
        signal = key.partition(" ")[0]
        if signal not in silent.setdefault(nanoseconds, []):
            silent[nanoseconds].append(signal)
    return (
        *dropped,
        *(f"no valid value for {t / SECOND:.6g} s of operation: {', '.join(signals)}" for t, signals in silent.items()),
    )


def task_to_json(task: Task) -> dict[str, Any]:
    """As plain values."""
    return {"distance": task.distance, "duration": task.duration, **asdict(task)}


def plain(value: Any) -> Any:
    """Values that JSON can say: what is infinite or not a number becomes None."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
