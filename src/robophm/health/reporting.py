"""Reports of a robot's health from a ledger: quickly the state now, then what is to come, which takes longer."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple, get_args

import numpy as np

from robophm.core.argument_checks import number, one_of
from robophm.core.signal import REORDERED
from robophm.core.waiting_time import LONGEST
from robophm.design.robot import FailureMode, Robot
from robophm.design.task import Knowledge, Plan, Task
from robophm.design.task_checks import check_knowledge, check_plan, check_task
from robophm.health.doubtful_signals import Doubt, doubts
from robophm.health.draws import check_draws
from robophm.health.exposure import ExposureIntegrator, recent_signals
from robophm.health.ledger import Ledger
from robophm.health.limits import SEVERITIES, limited_values
from robophm.health.mission import completion, plan_future
from robophm.health.outlooks import FutureName, View, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.rejected_samples import rejected_samples
from robophm.health.report import VIEWS, ComponentHealth, HealthReport
from robophm.health.subject import (
    CLOCK_OFF,
    DOUBTFUL,
    FAILED,
    STALE,
    Figures,
    Subject,
    System,
    figures_now,
    looking_ahead,
    silence,
    some,
    systems,
)
from robophm.health.suspect_time import open_stretch, said
from robophm.health.uncertainty import SCENARIOS, LifeUncertainty, draw_loads, life_uncertainty
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.worn import SeenWear, moment, wear_flags

Lives = bool | Literal["robot"]
"""Whether remaining lives are stated: of all subjects, of the robot alone, or of none."""


def health_report(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    task: Task | None = None, remaining_life: Lives = True,
    future: FutureName = "recent", plan: Plan | None = None, knowledge: Knowledge | None = None,
    draws: int = 0, parts: bool = False, horizon: float | None = None, wear: Sequence[SeenWear] = (),
) -> HealthReport:  # fmt: skip
    """Return the health that a ledger tells of; ``task`` is the design's unless given. Remaining life is the slow part.

    ``remaining_life="robot"``: of the robot alone, which is quicker.

    Under a ``plan`` the robot does its tasks again and again for the rest of its life. ``draws`` of uncertain rates and
    loads tell how far the remaining life may lie; ``parts``: state that of every component too. ``horizon`` [h]: how
    far ahead failures to come are looked for. ``wear``: what sensors see of it.
    Raises RobophmError where the robot lacks what a task, plan or knowledge names, or ``draws`` are no number
    of them, or too many.
    """
    draws = check_draws(draws, plant.robot)
    if horizon is not None:
        horizon = number(horizon, "horizon [h]", above=True, high=LONGEST)
    now = health_now(plant, exposure, ledger, task=task, future=future, plan=plan, knowledge=knowledge, wear=wear)
    return replace(
        look_ahead(now, remaining_life=remaining_life, parts=parts),
        uncertainty=_uncertainty(plant, ledger, now.outlooks["sensor_based"], plan, draws),
        horizon=horizon,
    )


def health_now(
    plant: Plant, exposure: ExposureIntegrator, ledger: Ledger, *,
    task: Task | None = None, future: FutureName = "recent",
    plan: Plan | None = None, knowledge: Knowledge | None = None, wear: Sequence[SeenWear] = (),
) -> HealthReport:  # fmt: skip
    """Return hazard rates and reliabilities alone, quickly; ``look_ahead`` adds the rest."""
    robot = plant.robot
    _check(robot, task, future, plan, knowledge)
    views = outlooks(plant, exposure, ledger, future=future, knowledge=knowledge, wear=wear)
    if plan:
        views = {view: replace(outlook, plan=plan_future(outlook, plan)) for view, outlook in views.items()}
    lived = views["sensor_based"]
    silent = exposure.silent(ledger) if ledger.integrated_to is not None else {}  # else a mere look ahead
    odometers = {signal for clock in robot.clocks.values() for signal in clock.signals}
    rates = [views[view].component_hazard_rates() for view in VIEWS]
    survival = [views[view].component_survival() for view in VIEWS]
    asked = task or robot.task
    doubtful = doubts(exposure, ledger, lived, robot.diagram, asked)
    lost = ledger.failed
    numbers = np.stack([*rates, *(works for works, _ in survival), *(failed for _, failed in survival)], axis=1)
    return HealthReport(
        robot.name,
        robot.design_hash,
        ledger.integrated_to,
        _clocks(robot, ledger),
        tuple(
            _subject(
                system,
                _marks(
                    [robot.modes[i] for i in plant.system(system.diagram).modes],
                    *(ledger, lost, silent, wear, doubtful),
                    *(odometers if system.kind == "robot" else ()),
                )
                .with_time(ledger if system.kind == "robot" else None)
                .with_unknown(unknown(lived, system.diagram)),
                {view: figures_now(views[view], system.diagram) for view in VIEWS},
            )
            for system in systems(robot)
        ),
        tuple(
            ComponentHealth(
                component.path,
                component.quantity,
                *(rate, lived_rate, works, lived_works, failed, lived_failed),
                flags=(*marks.flags, *(["unknown rate"] if component.unknown else [])),
                silence=marks.silence,
                unknown=component.unknown,
            )
            for component, (rate, lived_rate, works, lived_works, failed, lived_failed) in zip(
                plant.components, numbers.tolist(), strict=True
            )
            for marks in (_marks(component.modes, ledger, lost, silent, wear, doubtful),)
        ),
        asked,
        (*_of_the_past(robot, ledger), *_doubted(doubtful, lived, asked)),
        views,
        wear=tuple(wear),
        doubts=doubtful,
        heard=exposure.last_values(ledger) if robot.limits_signals else {},
        signals=recent_signals(exposure.channels, ledger),
        suspect_time=tuple(ledger.suspect_time),
        silent=silent,
    )


def _check(robot: Robot, task: Task | None, future: FutureName, plan: Plan | None, knowledge: Knowledge | None) -> None:
    one_of(future, get_args(FutureName), "future")
    if task is not None:
        check_task(task, robot)
    if plan is not None:
        check_plan(plan, robot)
    if knowledge is not None:
        check_knowledge(knowledge, robot)


def _clocks(robot: Robot, ledger: Ledger) -> dict[str, float]:
    names = ("operating", "calendar", *robot.clocks)
    return {name: float(total) for name, total in zip(names, ledger.clocks.value, strict=True)}


def look_ahead(
    now: HealthReport, *, remaining_life: Lives = True, parts: bool = False, pause: Callable[[], None] = lambda: None
) -> HealthReport:
    """Add what is to come to a report: completion of the task, and remaining lives, which are the slow part.

    ``pause`` is called after each subject and component.
    """
    lived = now.outlooks["sensor_based"]
    subjects, components = [], list(now.components)
    for one, system in zip(now.subjects, systems(lived.plant.robot), strict=True):
        whole = system.kind == "robot"
        ahead = {
            view: looking_ahead(
                getattr(one, view), now.outlooks[view], system.diagram, now.task,
                remaining_life=remaining_life is True or (whole and remaining_life == "robot"), whole=whole,
            )
            for view in VIEWS
        }  # fmt: skip
        subjects.append(_subject(system, one, ahead))
        pause()
    limited = lived.plant.robot.limited_parts if remaining_life else {}
    asked = [
        i for i, part in limited.items() if part.thresholds.remaining_life or part.thresholds.warning.remaining_life
    ]
    for i in range(len(components)) if parts else asked:
        components[i] = replace(components[i], remaining_life=lived.remaining_life(lived.plant.alone[i]))
        pause()
    return replace(now, subjects=tuple(subjects), components=tuple(components))


def with_earlier_look(now: HealthReport, earlier: HealthReport) -> HealthReport:
    """Return the report of now, its remaining lives and completions taken from an earlier, complete report."""
    found = replace(
        now,
        subjects=tuple(
            _subject(system, one, {view: getattr(one, view).beside(getattr(before, view)) for view in VIEWS})
            for one, before, system in zip(now.subjects, earlier.subjects, systems(now.design), strict=True)
        ),
        components=tuple(
            replace(one, remaining_life=before.remaining_life)
            for one, before in zip(now.components, earlier.components, strict=True)
        ),
    )
    if "failures_to_come" in vars(earlier):
        vars(found)["failures_to_come"] = earlier.failures_to_come
    return found


def _of_the_past(robot: Robot, ledger: Ledger) -> list[str]:
    """What qualifies what a ledger has counted."""
    return [*map(said, ledger.suspect_time), *rejected_samples(ledger), *_counted_since(robot, ledger)]


def _counted_since(robot: Robot, ledger: Ledger) -> list[str]:
    """What is said of parts that came into the design when the robot had lived already."""
    came: dict[int, list[str]] = {}
    for mode in robot.modes if ledger.begun else ():
        if mode.key in ledger.begun:
            came.setdefault(ledger.begun[mode.key], []).append(mode.path)
    return [
        f"{some(paths)}: counted since {moment(time)}, not in the design before" for time, paths in sorted(came.items())
    ]


def _doubted(doubtful: Sequence[Doubt], lived: Outlook, task: Task | None) -> list[str]:
    """What is said of signals that may not be true."""
    if not doubtful:
        return []
    rate = lived.hazard_rate(lived.plant.robot.diagram)
    done = completion(lived, task) if task else None
    return [one.words(rate, done) for one in doubtful]


class _Marks(NamedTuple):
    flags: tuple[str, ...] = ()
    silence: str = ""
    unknown: PartsOfUnknownRate | None = None

    def with_time(self, ledger: Ledger | None) -> _Marks:
        """Return the marks, with that of a ledger whose time goes on without the machine's clock."""
        return self._replace(flags=(CLOCK_OFF, *self.flags)) if ledger and open_stretch(ledger) else self

    def with_unknown(self, left_out: PartsOfUnknownRate | None) -> _Marks:
        """Return the marks with the effect of parts of unknown rate on the figures."""
        return _Marks((*self.flags, left_out.words), self.silence, left_out) if left_out else self


def _subject(system: System, marked: Subject | _Marks, of: Mapping[View, Figures]) -> Subject:
    lived = of["sensor_based"]
    limited = [one for one in limited_values("", system.thresholds, lived.limited) if one.broken]
    breaches, warnings = (tuple(one.words for one in limited if one.severity == kind) for kind in SEVERITIES)
    marks = marked.flags, breaches, warnings, marked.silence, marked.unknown
    return Subject(system.kind, system.path, of["nominal"], lived, *marks)


def _uncertainty(plant: Plant, ledger: Ledger, lived: Outlook, plan: Plan | None, draws: int) -> LifeUncertainty | None:
    """Uncertainty of remaining life; None where rates are exact and the load is planned or the past too short."""
    loads = draw_loads(plant, ledger, SCENARIOS, seed=0) if draws and not plan else []
    if not draws or not (loads or any(mode.uncertainty for mode in plant.robot.modes)):
        return None
    return life_uncertainty(lived, plant.robot.diagram, loads=loads, draws=draws)


def _marks(
    modes: Sequence[FailureMode], ledger: Ledger, lost: Collection[str], silent: Mapping[str, int | None],
    wear: Sequence[SeenWear], doubtful: Sequence[Doubt], *signals: str,
) -> _Marks:  # fmt: skip
    """Marks on figures of failure modes: those by which parts have failed (``lost``, by key), silent and doubtful
    signals that they hang on, models outside their range, their wear."""
    worn = wear_flags(wear, (mode.path for mode in modes)) if wear else ()
    if lost:
        worn = (*(f"{FAILED}{mode.path}" for mode in modes if mode.key in lost), *worn)
    mixed = {key.removeprefix(REORDERED) for key in ledger.counts if key.startswith(REORDERED)}
    if not silent and not mixed and not doubtful and not any(ledger.extrapolated.values()):
        return _Marks(worn)
    heard_by, extrapolated = {*signals}, False
    for mode in modes:
        heard_by |= {channel.signal for stress in mode.stresses for channel in stress.channels.values()}
        heard_by |= set(mode.measured_clock.signals if mode.measured_clock else ())
        extrapolated |= bool(ledger.extrapolated[mode.identity])
    own = {signal: last for signal, last in silent.items() if signal in heard_by}
    flags = (
        *(f"{STALE}{signal}" for signal in own),
        *(f"{REORDERED}{signal}" for signal in sorted(heard_by & mixed)),
        *(f"{DOUBTFUL}{one.about.signal}" for one in doubtful if one.about.signal in heard_by),
        *(["extrapolated"] if extrapolated else []),
        *worn,
    )
    return _Marks(flags, silence(own))
