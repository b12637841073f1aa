"""One look at a robot's health: nominal and sensor-based side by side, with all that qualifies it."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from robophm.blocks.diagram import Block
from robophm.core.signal import SECOND
from robophm.design.robot import MeasuredClock, Robot, Task
from robophm.health.exposure import Exposure, Ledger
from robophm.health.prognosis import Completion, Figures, Outlook, Plant, RemainingLife, View, outlooks

SCHEMA_VERSION = 1
"""Of a report as JSON."""


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
        import numpy as np

        return float(outlook.survival_curve(outlook.plant.robot.diagram, np.array([hours])).works[0])

    def remaining_life(self, view: View = "sensor_based") -> RemainingLife:
        """Of the robot [h]."""
        outlook = self.outlooks[view]
        return outlook.remaining_life(outlook.plant.robot.diagram)

    def completion(self, task: Task, view: View = "sensor_based") -> Completion:
        """Of a task by the robot as it is now."""
        outlook = self.outlooks[view]
        return outlook.completion(outlook.plant.robot.diagram, task)

    def to_json(self) -> dict[str, Any]:
        """As plain values, schema-versioned; infinite times are null."""
        names = ("robot", "design_hash", "time", "clocks")
        return {
            "schema_version": SCHEMA_VERSION,
            **{name: getattr(self, name) for name in names},
            "subjects": [plain(asdict(subject)) for subject in self.subjects],
            "components": [plain(asdict(component)) for component in self.components],
            "task": asdict(self.task) if self.task else None,
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
    plant: Plant, exposure: Exposure, ledger: Ledger, *, task: Task | None = None, remaining_life: bool = True
) -> HealthReport:
    """The health that a ledger tells of; ``task`` is the design's unless given. Remaining life is the slow part."""
    robot = plant.robot
    task = task or robot.task
    views = outlooks(plant, exposure, ledger)
    silent = set(exposure.silent(ledger)) if ledger.integrated_to is not None else set()  # a mere look ahead
    systems = [("robot", robot.name, robot.diagram), *(("module", m.path, m.diagram) for m in robot.all_modules())]
    systems += [("function", name, diagram) for name, diagram in robot.functions.items()]
    subjects = tuple(
        Subject(
            kind,
            path,
            views["nominal"].figures(diagram, task, remaining_life=remaining_life),
            views["sensor_based"].figures(diagram, task, remaining_life=remaining_life),
            _flags(plant, diagram, ledger, silent, robot.clocks.values() if kind == "robot" else ()),
        )
        for kind, path, diagram in systems
    )
    columns = [
        values
        for method in ("component_hazard_rates", "component_survival")
        for values in (getattr(views[view], method)() for view in ("nominal", "sensor_based"))
    ]
    components = tuple(
        ComponentHealth(component.path, component.quantity, *(float(column[i]) for column in columns))
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
    )


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


def plain(value: Any) -> Any:
    """Values that JSON can say: what is infinite or not a number becomes None."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
