"""One look at a robot's health: nominal and sensor-based side by side, with all that qualifies it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple, get_args, overload

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.given import number, numbers, one_of
from robophm.core.signal import NOT_FINITE, REORDERED, SECOND, no_number
from robophm.design.asked import check_knowledge, check_plan, check_task
from robophm.design.robot import FailureMode, Limits, Robot, Thresholds
from robophm.design.task import Knowledge, Plan, Task
from robophm.health.clock_jumps import waiting
from robophm.health.exposure import ExposureIntegrator
from robophm.health.failures_to_come import LONGEST, FailuresToCome, failures_to_come
from robophm.health.ledger import Ledger
from robophm.health.mission import Completion, completion, plan_future
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.subject import STALE, Figures, State, Subject, breached, figures_now, looking_ahead, silence
from robophm.health.uncertainty import SCENARIOS, LifeUncertainty, draw_loads, life_uncertainty
from robophm.health.unknown_rates import PartsOfUnknownRate, marked, marks, named, unknown

SCHEMA_VERSION = 1
"""Of a report as JSON."""

MOST_DRAWS = 100_000
"""Of uncertain rates and loads."""

Array = npt.NDArray[np.float64]
VIEWS: tuple[View, ...] = ("nominal", "sensor_based")


@dataclass(frozen=True)
class ComponentHealth:
    """A component in both views; hazard rates of all its equal parts together [1/h of operation]."""

    path: str
    quantity: int
    nominal_hazard_rate: float
    sensor_based_hazard_rate: float
    nominal_reliability: float
    sensor_based_reliability: float
    nominal_unreliability: float
    sensor_based_unreliability: float
    remaining_life: RemainingLife | None = None
    """Sensor-based, of the component alone [h]; where it was asked for."""
    flags: tuple[str, ...] = ()
    """As of a subject."""
    silence: str = ""
    """As of a subject."""
    unknown: bool = False
    """Whether it has a rate that is not known: its hazard rates are at least, its reliabilities at most, as stated."""


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
    notes: tuple[str, ...]
    """What was not taken, and why."""
    outlooks: Mapping[View, Outlook] = field(repr=False, compare=False)
    uncertainty: LifeUncertainty | None = None
    """Of the robot's sensor-based remaining life; where it was asked for, and rates or load are uncertain."""
    horizon: float | None = None
    """How far ahead failures to come are looked for [h of calendar time]; None: to the median remaining life."""

    @property
    def looked_ahead(self) -> bool:
        """Whether remaining lives, the slow part, are there."""
        return self.system.sensor_based.remaining_life is not None

    @cached_property
    def failures_to_come(self) -> FailuresToCome:
        """Which parts the robot's failures within the horizon will come from."""
        life = self.system.sensor_based.remaining_life or self.remaining_life()
        robot = self.outlooks["sensor_based"].plant.robot
        return failures_to_come(self.outlooks, robot.diagram, life.median, self.horizon)

    @property
    def breaches(self) -> tuple[str, ...]:
        """Thresholds of the design that the sensor-based figures fail; a module's by its path."""
        return self._told("breaches")

    @property
    def warnings(self) -> tuple[str, ...]:
        """The same of thresholds of a warning."""
        return self._told("warnings")

    def _told(self, what: Literal["breaches", "warnings"]) -> tuple[str, ...]:
        return tuple(
            words if subject.kind == "robot" else f"{subject.path}: {words}"
            for subject in self.subjects
            for words in getattr(subject, what)
        )

    @property
    def state(self) -> State:
        """Of the robot and all that has thresholds in it, in one word."""
        if self.breaches:
            return "error"
        if self.system.state == "stale":
            return "stale"
        return "warn" if self.warnings or self.system.flags else "ok"

    @property
    def limited(self) -> bool:
        """Whether the design sets any threshold at all: without one nothing can be called too low."""
        limits = [f.name for f in fields(Limits)]
        return any(
            getattr(one, name) is not None
            for system in _systems(self.outlooks["sensor_based"].plant.robot)
            for one in (system.thresholds, system.thresholds.warning)
            for name in limits
        )

    @property
    def system(self) -> Subject:
        """The robot as a whole."""
        return self.subjects[0]

    def subject(self, path: str) -> Subject:
        """A module or function by its path. Raises RobophmError, with the nearest known, where there is none."""
        by_path = {subject.path: subject for subject in reversed(self.subjects)}
        found: Subject = by_path[one_of(path, by_path, "module or function")]
        return found

    def looking_ahead(
        self, *, remaining_life: bool = True, parts: bool = False, pause: Callable[[], None] = lambda: None
    ) -> HealthReport:
        """The same with what is to come: completion of the task, and remaining lives, which are the slow part.

        ``pause`` is called after each subject and component.
        """
        lived = self.outlooks["sensor_based"]
        subjects, components = [], list(self.components)
        for one, system in zip(self.subjects, _systems(lived.plant.robot), strict=True):
            whole = system.kind == "robot"
            ahead = {
                view: looking_ahead(
                    getattr(one, view), self.outlooks[view], system.diagram, self.task,
                    remaining_life=remaining_life, whole=whole,
                )
                for view in VIEWS
            }  # fmt: skip
            subjects.append(_subject(system, one, ahead))
            pause()
        for i, diagram in enumerate(lived.plant.alone if parts else ()):
            components[i] = replace(components[i], remaining_life=lived.remaining_life(diagram))
            pause()
        return replace(self, subjects=tuple(subjects), components=tuple(components))

    def beside(self, earlier: HealthReport) -> HealthReport:
        """The same with the remaining lives and completions of an earlier look, which takes longer to have."""
        robot = self.outlooks["sensor_based"].plant.robot
        found = replace(
            self,
            subjects=tuple(
                _subject(system, one, {view: getattr(one, view).beside(getattr(before, view)) for view in VIEWS})
                for one, before, system in zip(self.subjects, earlier.subjects, _systems(robot), strict=True)
            ),
            components=tuple(
                replace(one, remaining_life=before.remaining_life)
                for one, before in zip(self.components, earlier.components, strict=True)
            ),
        )
        if "failures_to_come" in vars(earlier):
            vars(found)["failures_to_come"] = earlier.failures_to_come
        return found

    @overload
    def reliability(self, hours: float, view: View = "sensor_based") -> float: ...

    @overload
    def reliability(self, hours: Sequence[float] | Array, view: View = "sensor_based") -> Array: ...

    def reliability(self, hours: float | Sequence[float] | Array, view: View = "sensor_based") -> float | Array:
        """Survival since new after so many more operating hours of the same use; of many, shape of ``hours``.

        Raises RobophmError where hours are negative or not finite, or there is no such view.
        """
        outlook, asked = self._outlook(view), numbers(hours, "hours")
        works = outlook.reliability_curve(outlook.plant.robot.diagram, asked.ravel())[0].reshape(asked.shape)
        return works if asked.ndim else float(works)

    def remaining_life(self, view: View = "sensor_based") -> RemainingLife:
        """Of the robot [h]. Raises RobophmError where there is no such view."""
        outlook = self._outlook(view)
        return outlook.remaining_life(outlook.plant.robot.diagram)

    def completion(self, task: Task, view: View = "sensor_based") -> Completion:
        """Of a task by the robot as it is now.

        Raises RobophmError where the robot lacks a function or stress that the task names, or there is no such view.
        """
        outlook = self._outlook(view)
        check_task(task, outlook.plant.robot)
        return completion(outlook, task)

    def _outlook(self, view: View) -> Outlook:
        return self.outlooks[one_of(view, VIEWS, "view")]

    def to_json(self) -> dict[str, Any]:
        """As plain values, schema-versioned; an infinite time is the text "Infinity"."""
        names = ("robot", "design_hash", "time", "clocks")
        return {
            "schema_version": SCHEMA_VERSION,
            **{name: getattr(self, name) for name in names},
            "subjects": [plain(asdict(subject)) | {"state": subject.state} for subject in self.subjects],
            "components": [plain(asdict(component)) for component in self.components],
            "failures_to_come": plain(asdict(self.failures_to_come))
            if self.system.sensor_based.remaining_life
            else None,
            "task": task_to_json(self.task) if self.task else None,
            "uncertainty": plain({name: interval._asdict() for name, interval in vars(self.uncertainty).items()})
            if self.uncertainty
            else None,
            "state": self.state,
            "limits_set": self.limited,
            "breaches": list(self.breaches),
            "warnings": list(self.warnings),
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
            rate, works, ahead = marks(one.unknown)
            life = marked(ahead, f"{s.remaining_life.median:.4g}".replace("inf", "∞")) if s.remaining_life else "–"
            task = f"{ahead}{s.completion.probability:.6g}" if s.completion else "–"
            cells = (
                marked(rate, f"{n.hazard_rate:.4g}"),
                marked(rate, f"{s.hazard_rate:.4g}"),
                f"{works}{n.reliability:.6g}",
                f"{works}{s.reliability:.6g}",
                life,
                task,
            )
            rows.append(f"<tr><th>{escape(one.path)}</th>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
        left_out, robot = self.system.unknown, self.outlooks["sensor_based"].plant.robot
        says = f"<caption>{escape(left_out.sentence)} ({escape(named(robot))})</caption>" if left_out else ""
        return f"<table>{says}<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def health_report(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    task: Task | None = None, remaining_life: bool = True,
    future: FutureName = "recent", plan: Plan | None = None, knowledge: Knowledge | None = None,
    draws: int = 0, parts: bool = False, horizon: float | None = None,
) -> HealthReport:  # fmt: skip
    """The health that a ledger tells of; ``task`` is the design's unless given. Remaining life is the slow part.

    Under a ``plan`` the robot does its tasks again and again for the rest of its life. ``draws`` of uncertain rates and
    loads tell how far the remaining life may lie; ``parts``: state that of every component too. ``horizon`` [h]: how
    far ahead failures to come are looked for.
    Raises RobophmError where the robot lacks what a task, plan or knowledge names, or ``draws`` are no number of them.
    """
    draws = int(number(draws, "draws", high=MOST_DRAWS, whole=True))
    if horizon is not None:
        horizon = number(horizon, "horizon [h]", above=True, high=LONGEST)
    now = health_now(plant, exposure, ledger, task=task, future=future, plan=plan, knowledge=knowledge)
    return replace(
        now.looking_ahead(remaining_life=remaining_life, parts=parts),
        uncertainty=_uncertainty(plant, ledger, now.outlooks["sensor_based"], plan, draws),
        horizon=horizon,
    )


def health_now(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    task: Task | None = None, future: FutureName = "recent",
    plan: Plan | None = None, knowledge: Knowledge | None = None,
) -> HealthReport:  # fmt: skip
    """Hazard rates and reliabilities alone, quickly; ``looking_ahead`` of it gives the rest."""
    robot = plant.robot
    one_of(future, get_args(FutureName), "future")
    if task is not None:
        check_task(task, robot)
    if plan is not None:
        check_plan(plan, robot)
    if knowledge is not None:
        check_knowledge(knowledge, robot)
    views = outlooks(plant, exposure, ledger, future=future, knowledge=knowledge)
    if plan:
        views = {view: replace(outlook, plan=plan_future(outlook, plan)) for view, outlook in views.items()}
    lived = views["sensor_based"]
    silent = exposure.silent(ledger) if ledger.integrated_to is not None else {}  # else a mere look ahead
    odometers = {signal for clock in robot.clocks.values() for signal in clock.signals}
    rates = [views[view].component_hazard_rates() for view in VIEWS]
    survival = [views[view].component_survival() for view in VIEWS]
    numbers = np.stack([*rates, *(works for works, _ in survival), *(failed for _, failed in survival)], axis=1)
    clocks = ledger.clocks.value
    return HealthReport(
        robot.name,
        robot.design_hash,
        ledger.integrated_to,
        {name: float(total) for name, total in zip(("operating", "calendar", *robot.clocks), clocks, strict=True)},
        tuple(
            _subject(
                system,
                _marks(
                    (robot.modes[i] for i in plant.system(system.diagram).modes),
                    ledger,
                    silent,
                    *(odometers if system.kind == "robot" else ()),
                ).with_unknown(unknown(lived, system.diagram)),
                {view: figures_now(views[view], system.diagram) for view in VIEWS},
            )
            for system in _systems(robot)
        ),
        tuple(
            ComponentHealth(
                component.path,
                component.quantity,
                *(rate, lived_rate, works, lived_works, failed, lived_failed),
                flags=(*marks.flags, *([_UNKNOWN_RATE] if component.unknown else [])),
                silence=marks.silence,
                unknown=component.unknown,
            )
            for component, (rate, lived_rate, works, lived_works, failed, lived_failed) in zip(
                plant.components, numbers.tolist(), strict=True
            )
            for marks in (_marks(component.modes, ledger, silent),)
        ),
        task or robot.task,
        _notes(ledger),
        views,
    )


_UNKNOWN_RATE = "unknown rate"


class _System(NamedTuple):
    kind: str
    path: str
    diagram: Block
    thresholds: Thresholds


def _systems(robot: Robot) -> list[_System]:
    return [
        _System("robot", robot.name, robot.diagram, robot.thresholds),
        *(_System("module", module.path, module.diagram, module.thresholds) for module in robot.all_modules()),
        *(_System("function", name, diagram, Thresholds()) for name, diagram in robot.functions.items()),
    ]


class _Marks(NamedTuple):
    flags: tuple[str, ...] = ()
    silence: str = ""
    unknown: PartsOfUnknownRate | None = None

    def with_unknown(self, left_out: PartsOfUnknownRate | None) -> _Marks:
        """And what parts of unknown rate make of the figures."""
        return _Marks((*self.flags, left_out.words), self.silence, left_out) if left_out else self


def _subject(system: _System, marked: Subject | _Marks, of: Mapping[View, Figures]) -> Subject:
    lived, limits = of["sensor_based"], system.thresholds
    breaches, warnings = (tuple(breached(one, lived)) for one in (limits, limits.warning))
    marks = marked.flags, breaches, warnings, marked.silence, marked.unknown
    return Subject(system.kind, system.path, of["nominal"], lived, *marks)


def _uncertainty(plant: Plant, ledger: Ledger, lived: Outlook, plan: Plan | None, draws: int) -> LifeUncertainty | None:
    """None where nothing is uncertain: rates as stated, and a plan or too short a past."""
    loads = draw_loads(plant, ledger, SCENARIOS, seed=0) if draws and not plan else []
    if not draws or not (loads or any(mode.uncertainty for mode in plant.robot.modes)):
        return None
    return life_uncertainty(lived, plant.robot.diagram, loads=loads, draws=draws)


def _marks(modes: Iterable[FailureMode], ledger: Ledger, silent: Mapping[str, int | None], *signals: str) -> _Marks:
    """What of the past qualifies failure modes: the silent signals that they hang on, models outside their range."""
    mixed = {key.removeprefix(REORDERED) for key in ledger.counts if key.startswith(REORDERED)}
    if not silent and not mixed and not any(ledger.extrapolated.values()):
        return _Marks()
    heard_by, extrapolated = {*signals}, False
    for mode in modes:
        heard_by |= {channel.signal for stress in mode.stresses for channel in stress.channels.values()}
        heard_by |= set(mode.measured_clock.signals if mode.measured_clock else ())
        extrapolated |= bool(ledger.extrapolated[mode.path])
    own = {signal: last for signal, last in silent.items() if signal in heard_by}
    flags = (
        *(f"{STALE}{signal}" for signal in own),
        *(f"{REORDERED}{signal}" for signal in sorted(heard_by & mixed)),
        *(["extrapolated"] if extrapolated else []),
    )
    return _Marks(flags, silence(own))


def _dropped(reason: str, count: int) -> str:
    if reason.startswith(REORDERED):
        return f"{reason} in {count} messages; expected it bound by the element's name"
    said = no_number(reason.removeprefix(NOT_FINITE)) if reason.startswith(NOT_FINITE) else reason
    return f"{count} samples not taken: {said}"


def _notes(ledger: Ledger) -> tuple[str, ...]:
    dropped = [_dropped(reason, count) for reason, count in sorted(ledger.counts.items())]
    silent: dict[int, list[str]] = {}
    for key, nanoseconds in sorted(ledger.stale.items()):
        signal = key.rsplit(" ", 4)[0] if "[" in key else key.partition(" ")[0]  # a name may have blanks
        if signal not in silent.setdefault(nanoseconds, []):
            silent[nanoseconds].append(signal)
    if ledger.aside and ledger.newest is not None:
        dropped.insert(0, waiting(ledger.newest, ledger.aside))
    return (
        *dropped,
        *(f"no valid value for {t / SECOND:.6g} s of operation: {', '.join(signals)}" for t, signals in silent.items()),
    )


def task_to_json(task: Task) -> dict[str, Any]:
    """As plain values."""
    return {"distance": task.distance, "duration": task.duration, **asdict(task)}


def plain(value: Any) -> Any:
    """Values that JSON can say: an infinite number is the text "Infinity" or "-Infinity", what is none is None."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value
