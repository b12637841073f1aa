"""A report of a robot's health: nominal and sensor-based figures side by side, with all that qualifies them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from itertools import chain
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.argument_checks import numbers, one_of
from robophm.core.html_table import html_table
from robophm.core.json_values import plain
from robophm.design.robot import Robot
from robophm.design.task import Task
from robophm.design.task_checks import check_task
from robophm.health.doubtful_signals import Doubt
from robophm.health.failures_to_come import FailuresToCome, failures_to_come
from robophm.health.ledger import SuspectTime
from robophm.health.limits import LimitedValue, Severity, limited_signals, limited_values
from robophm.health.mission import Completion, completion
from robophm.health.outlooks import View
from robophm.health.prognosis import Outlook, RemainingLife
from robophm.health.subject import State, Subject, systems
from robophm.health.uncertainty import QUANTILES, Interval, LifeUncertainty, life_with_rates_unsure
from robophm.health.unknown_rates import marked, marks, named
from robophm.health.worn import SeenWear

SCHEMA_VERSION = 1
"""The version of a health report as JSON."""

CHANCE = 0.9
"""The chance to still work for which a time is stated, unless the design states one (``thresholds.survival``)."""

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
    """Flags that qualify the sensor-based figures, as in ``Subject.flags``."""
    silence: str = ""
    """The note that figures rest on silent sensors, as in ``Subject.silence``."""
    unknown: bool = False
    """Whether one of its rates is unknown: the stated hazard rates are then lower bounds, the reliabilities upper
    bounds."""

    @property
    def limited(self) -> dict[str, float | None]:
        """Return the figures that a design may limit, by name; None where one is not known."""
        return {
            "hazard_rate": self.sensor_based_hazard_rate,
            "reliability": self.sensor_based_reliability,
            "remaining_life": self.remaining_life.median if self.remaining_life else None,
        }


@dataclass(frozen=True)
class HealthReport:
    """A robot's health at one time of its own clock."""

    robot: str
    design_hash: str
    time: int | None
    """Nanoseconds since the epoch to which exposure has been integrated; None before the first sample."""
    clocks: Mapping[str, float]
    """Clocks since the start: operating and calendar hours, and the robot's own measured clocks, each in its unit."""
    subjects: tuple[Subject, ...]
    """The robot first, then its modules outer before inner, then its functions."""
    components: tuple[ComponentHealth, ...]
    task: Task | None
    notes: tuple[str, ...]
    """Notes on samples that were not taken into the past, and why."""
    outlooks: Mapping[View, Outlook] = field(repr=False, compare=False)
    uncertainty: LifeUncertainty | None = None
    """Uncertainty of the robot's sensor-based remaining life; None unless asked for and rates or load are uncertain."""
    horizon: float | None = None
    """The time ahead in which failures to come are looked for [h of calendar time]; None: the median remaining life."""
    wear: tuple[SeenWear, ...] = ()
    """Wear that sensors see of failure modes; the sensor-based figures have it in the place of their hazard."""
    doubts: tuple[Doubt, ...] = ()
    """Signals of stress that may not be true, and what that would mean. The figures take them as they are."""
    heard: Mapping[str, float] = field(default_factory=dict)
    """The last values that still hold of the signals of stress, where the design limits any."""
    signals: Mapping[str, float] = field(default_factory=dict)
    """Means of the signals of stress over the last ten minutes, as their messages have them."""
    suspect_time: tuple[SuspectTime, ...] = ()
    """Stretches in which the machine's clock was not plausible, so that time went on without it."""
    silent: Mapping[str, int | None] = field(default_factory=dict)
    """Signals that are silent, and when each had a valid value last [ns]; None where it never spoke."""

    @property
    def design(self) -> Robot:
        """The robot as designed."""
        return self.outlooks["sensor_based"].plant.robot

    @cached_property
    def failures_to_come(self) -> FailuresToCome:
        """Return which parts the robot's failures within the horizon will come from."""
        life = self.system.sensor_based.remaining_life or self.remaining_life()
        return failures_to_come(self.outlooks, self.design.diagram, life.median, self.horizon)

    @property
    def chance(self) -> float:
        """Return the chance to still work for which a time is stated: the design's ``thresholds.survival``, or 0.9."""
        return self.design.thresholds.survival or CHANCE

    @property
    def works_for_with_rates_unsure(self) -> float | None:
        """Return when that chance is reached [h], rates as uncertain as stated; None where all are exact."""
        return self._with_rates_unsure[0] if self._with_rates_unsure else None

    @property
    def life_with_rates_unsure(self) -> Interval | None:
        """The robot's remaining life [h] with rates as uncertain as the design states; None where all are exact."""
        return Interval(*self._with_rates_unsure[1:]) if self._with_rates_unsure else None

    @cached_property
    def _with_rates_unsure(self) -> list[float] | None:
        """When survival falls to the stated chance, and to those of an interval."""
        levels = np.append(self.chance, QUANTILES)
        found = life_with_rates_unsure(self.outlooks["sensor_based"], self.design.diagram, levels)
        return None if found is None else found.tolist()

    @cached_property
    def limited_values(self) -> tuple[LimitedValue, ...]:
        """Return what the design limits, as it is now: of the robot, of modules, of parts, then of signals."""
        found: list[LimitedValue] = []
        for system, one in zip(systems(self.design), self.subjects, strict=True):
            path = "" if system.kind == "robot" else system.path
            found += limited_values(path, system.thresholds, one.sensor_based.limited, one.silence)
        for i, part in self.design.limited_parts.items():
            health = self.components[i]
            found += limited_values(part.path, part.thresholds, health.limited, health.silence)
        return (*found, *limited_signals(self.design, self.heard))

    @property
    def breaches(self) -> tuple[str, ...]:
        """Return the design's thresholds that the sensor-based figures and signals fail, by what they are of."""
        return self._broken("error")

    @property
    def warnings(self) -> tuple[str, ...]:
        """Return the design's warning thresholds that the sensor-based figures and signals fail."""
        return self._broken("warn")

    def _broken(self, severity: Severity) -> tuple[str, ...]:
        return tuple(one.said for one in self.limited_values if one.severity == severity and one.broken)

    @property
    def stale(self) -> frozenset[str]:
        """The silent signals that the robot, or anything in it, hangs on."""
        return frozenset(chain.from_iterable(one.stale for one in self.subjects))

    @property
    def state(self) -> State:
        """Return the state of the robot and all that has thresholds in it, in one word."""
        if self.breaches:
            return "error"
        if self.system.state in ("error", "stale"):
            return self.system.state
        return "warn" if self.warnings or self.system.flags else "ok"

    @property
    def system(self) -> Subject:
        """The robot as a whole."""
        return self.subjects[0]

    def subject(self, path: str) -> Subject:
        """A module or function by its path. Raises RobophmError, with the nearest known, where there is none."""
        by_path = {subject.path: subject for subject in reversed(self.subjects)}
        found: Subject = by_path[one_of(path, by_path, "module or function")]
        return found

    @overload
    def reliability(self, hours: float, view: View = "sensor_based", *, of: str = "") -> float: ...

    @overload
    def reliability(self, hours: Sequence[float] | Array, view: View = "sensor_based", *, of: str = "") -> Array: ...

    def reliability(
        self, hours: float | Sequence[float] | Array, view: View = "sensor_based", *, of: str = ""
    ) -> float | Array:
        """P(it works until so many operating hours from now), since new: of its past nothing is known but its exposure.

        So 0 hours have the reliability of now, not 1. What a robot that works now will survive is
        ``survival_of_next``. ``of`` a module or function by its path, else of the robot; shape of ``hours``. Raises
        RobophmError where hours are negative or not finite, or there is no such view, module or function.
        """
        outlook, diagram = self._outlook(view), self._diagram(of)
        return _shaped(lambda asked: outlook.reliability_curve(diagram, asked)[0], hours)

    @overload
    def survival_of_next(self, hours: float, view: View = "sensor_based", *, of: str = "") -> float: ...

    @overload
    def survival_of_next(
        self, hours: Sequence[float] | Array, view: View = "sensor_based", *, of: str = ""
    ) -> Array: ...

    def survival_of_next(
        self, hours: float | Sequence[float] | Array, view: View = "sensor_based", *, of: str = ""
    ) -> float | Array:
        """P(it works on through the next so many operating hours), given that it works now and what else is known.

        1 of 0 hours, unless it is known to have failed. Arguments and errors as of ``reliability``.
        """
        outlook, diagram = self._outlook(view), self._diagram(of)
        return _shaped(lambda asked: outlook.curve(diagram, outlook.operating)(asked)[1], hours)

    def remaining_life(self, view: View = "sensor_based", *, of: str = "") -> RemainingLife:
        """Return the remaining life of the robot, or ``of`` a module or function [h of calendar time].

        Raises RobophmError where there is no such view, module or function.
        """
        return self._outlook(view).remaining_life(self._diagram(of))

    def completion(self, task: Task, view: View = "sensor_based") -> Completion:
        """Return the probability that the robot, as it is now, completes a task.

        Raises RobophmError where the robot lacks a function or stress that the task names, or there is no such view.
        """
        outlook = self._outlook(view)
        check_task(task, outlook.plant.robot)
        return completion(outlook, task)

    def _diagram(self, of: str) -> Block:
        if of == "":
            return self.design.diagram
        diagrams = {one.path: one.diagram for one in reversed([*systems(self.design)]) if one.kind != "robot"}
        found: Block = diagrams[one_of(of, diagrams, "module or function")]
        return found

    def _outlook(self, view: View) -> Outlook:
        return self.outlooks[one_of(view, VIEWS, "view")]

    def to_json(self, *, failures_to_come: bool = True) -> dict[str, Any]:
        """Return the report as plain values, schema-versioned; an infinite time is the text "Infinity".

        ``failures_to_come`` are worked out for it where there is a remaining life, which takes time.
        """
        names = ("robot", "design_hash", "time", "clocks")
        return {
            "schema_version": SCHEMA_VERSION,
            **{name: getattr(self, name) for name in names},
            "design": self.design.design_name or self.robot,
            "subjects": [plain(asdict(subject)) | {"state": subject.state} for subject in self.subjects],
            "components": [plain(asdict(component)) for component in self.components],
            "failures_to_come": plain(asdict(self.failures_to_come))
            if failures_to_come and self.system.sensor_based.remaining_life
            else None,
            "task": task_to_json(self.task) if self.task else None,
            "uncertainty": plain({name: interval._asdict() for name, interval in vars(self.uncertainty).items()})
            if self.uncertainty
            else None,
            "wear": [one.to_json() for one in self.wear],
            "doubts": [plain(one.to_json()) for one in self.doubts],
            "state": self.state,
            "limits_set": self.design.limited,
            "breaches": list(self.breaches),
            "warnings": list(self.warnings),
            "notes": list(self.notes),
            "suspect_time": [one._asdict() for one in self.suspect_time],
            "silent": dict(self.silent),
            "signals": plain(dict(self.signals)),
        }

    def __repr__(self) -> str:
        one = self.system.sensor_based
        rate, works, _ = marks(self.system.unknown)
        figures = f"hazard rate {rate}{one.hazard_rate:.4g} /h, reliability {works}{one.reliability:.6g}"
        return f"<HealthReport of {self.robot!r:.60}: {self.state}, {figures}>"

    def _repr_html_(self) -> str:
        """Return the report as an HTML table, for a notebook."""
        head = ("", "λ nominal [1/h]", "λ sensor", "R nominal", "R sensor", "RUL median [h]", "PoTC")
        rows = []
        for one in self.subjects:
            n, s = one.nominal, one.sensor_based
            rate, works, ahead = marks(one.unknown)
            life = marked(ahead, f"{s.remaining_life.median:.4g}".replace("inf", "∞")) if s.remaining_life else "–"
            task = f"{ahead}{s.completion.probability:.6g}" if s.completion else "–"
            rows.append((
                one.path, marked(rate, f"{n.hazard_rate:.4g}"), marked(rate, f"{s.hazard_rate:.4g}"),
                f"{works}{n.reliability:.6g}", f"{works}{s.reliability:.6g}", life, task,
            ))  # fmt: skip
        left_out = self.system.unknown
        return html_table(f"{left_out.sentence} ({named(self.design)})" if left_out else "", head, rows)


def _shaped(curve: Callable[[Array], Array], hours: float | Sequence[float] | Array) -> float | Array:
    """A curve at hours in their own shape. Raises RobophmError where they are negative or not finite."""
    asked = numbers(hours, "hours")
    found = (curve(asked.ravel()) if asked.size else asked).reshape(asked.shape)
    return found if asked.ndim else float(found)


def task_to_json(task: Task) -> dict[str, Any]:
    """Return a task as plain values for JSON."""
    return {"distance": task.distance, "duration": task.duration, **asdict(task)}
