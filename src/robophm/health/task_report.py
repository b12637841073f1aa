""" "Can I do this?": tasks of a robot as it is now, in both views, with what decides them and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import fsum
from typing import Any

from robophm.core.json_values import plain
from robophm.design.task import Plan, Task
from robophm.health.draws import check_draws
from robophm.health.exposure import ExposureIntegrator
from robophm.health.future import Future
from robophm.health.ledger import Ledger
from robophm.health.mission import (
    Completion,
    DecidingComponent,
    completion,
    consecutive_completions,
    deciding_components,
)
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.report import VIEWS, task_to_json
from robophm.health.uncertainty import DRAWS, SCENARIOS, CompletionUncertainty, completion_uncertainty, draw_loads
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.worn import SeenWear

SCHEMA_VERSION = 1
"""The version of a task report as JSON."""


@dataclass(frozen=True)
class TaskFigures:
    """The completion of one task, given that those before it in the list were completed."""

    task: Task
    nominal: Completion
    sensor_based: Completion


@dataclass(frozen=True, repr=False)
class TaskReport:
    """The answer for all tasks of a list."""

    robot: str
    tasks: tuple[TaskFigures, ...]
    together: Mapping[View, Completion]
    """Probability, in each view, that all of the tasks are completed."""
    uncertainty: CompletionUncertainty | None
    """Uncertainty of all tasks together, sensor-based; None where rates are exact and no past tells of the load."""
    deciding: tuple[DecidingComponent, ...]
    """The components that all together hang on, sensor-based, the one that decides most first."""
    threshold: float | None
    """The least probability of completion that the design wants."""
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate in the needed functions on the probabilities."""
    wear: tuple[SeenWear, ...] = ()
    """Wear that sensors see of failure modes."""

    def __repr__(self) -> str:
        chance = f"{self.together['sensor_based'].probability:.6g}"
        return f"<TaskReport of {self.robot!r}: {len(self.tasks)} tasks, completed with {chance}>"

    @property
    def distance(self) -> float:
        """The distance of all tasks together [m]."""
        return fsum(one.task.distance for one in self.tasks)

    @property
    def duration(self) -> float:
        """The duration of all tasks together [h]."""
        return fsum(one.task.duration for one in self.tasks)

    @property
    def breached(self) -> bool:
        """Whether a task is less likely to be completed than the design wants."""
        return self.threshold is not None and any(one.sensor_based.probability < self.threshold for one in self.tasks)

    def to_json(self) -> dict[str, Any]:
        """Return the report as plain values, schema-versioned."""
        return {
            "schema_version": SCHEMA_VERSION,
            "robot": self.robot,
            "tasks": [
                {**task_to_json(one.task), "nominal": asdict(one.nominal), "sensor_based": asdict(one.sensor_based)}
                for one in self.tasks
            ],
            "together": {view: asdict(one) for view, one in self.together.items()},
            "uncertainty": plain(_uncertainty(self.uncertainty)) if self.uncertainty else None,
            "deciding": [asdict(one) for one in self.deciding],
            "threshold": self.threshold,
            "wear": [one.to_json() for one in self.wear],
            **({"unknown": asdict(self.unknown)} if self.unknown else {}),
        }


def task_report(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, plan: Plan, *,
    future: FutureName = "recent", draws: int = DRAWS, seed: int = 0, wear: Sequence[SeenWear] = (),
) -> TaskReport:  # fmt: skip
    """Answer whether a robot with this past can do a list of tasks. Raises RobophmError for too many ``draws``."""
    draws = check_draws(draws, plant.robot)
    views = outlooks(plant, exposure, ledger, future=future, knowledge=plan.knowledge, wear=wear)
    each = {view: consecutive_completions(views[view], plan.tasks) for view in VIEWS}
    joined = plan.joined
    lived = views["sensor_based"]
    loads = unsure_loads(plant, ledger, seed) if draws else None
    return TaskReport(
        plant.robot.name,
        tuple(map(TaskFigures, plan.tasks, each["nominal"], each["sensor_based"])),
        {view: completion(views[view], joined) for view in VIEWS},
        completion_uncertainty(lived, joined, loads=loads, draws=draws, seed=seed) if loads is not None else None,
        tuple(deciding_components(lived, joined)),
        plant.robot.wanted_completion,
        unknown_in(lived, joined),
        tuple(wear),
    )


def unsure_loads(plant: Plant, ledger: Ledger, seed: int) -> list[Future] | None:
    """Return the loads to come that are drawn from a past; None where nothing is uncertain, rates neither."""
    loads = draw_loads(plant, ledger, SCENARIOS, seed)
    return loads if loads or any(mode.uncertainty for mode in plant.robot.modes) else None


def unknown_in(outlook: Outlook, task: Task) -> PartsOfUnknownRate | None:
    """Return the effect of parts of unknown rate on the completion of a task; None where all it needs are known."""
    return unknown(outlook, *(outlook.plant.diagram(name) for name in sorted(needed(task))))


def needed(task: Task) -> set[str]:
    """Return the functions that must work in a task; "" is the whole robot."""
    return {name for leg in task.legs for name in (leg.functions or ("",))}


def _uncertainty(found: CompletionUncertainty) -> dict[str, Any]:
    intervals = ("failure", "failure_if_rates_known", "failure_if_load_known")
    return {"mean": asdict(found.mean), **{name: getattr(found, name)._asdict() for name in intervals}}
