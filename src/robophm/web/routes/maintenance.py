"""Maintenance: what is due and why, replacements to come, a calendar, the plan for stated costs, services noted."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Literal

from fastapi import APIRouter, HTTPException, Query, Response
from pydantic import Field

from robophm.core.errors import DataError, RobophmError
from robophm.core.files import write_atomically
from robophm.core.signal import SECOND
from robophm.design.robot import CLOCK_UNITS, Robot
from robophm.health.alarms import Alarm
from robophm.health.ledger import Ledger, Service
from robophm.health.part_due import RISK, PartDue
from robophm.health.service import MOST_WORDS, ServiceNote
from robophm.health.subject import silence
from robophm.learning.maintenance.costs_table import PartCosts, read_costs
from robophm.learning.maintenance.life_cycle_costs import LifeCycle
from robophm.learning.maintenance.upkeep import UpkeepPlan
from robophm.monitoring.upkeep_ahead import UpkeepAhead, upkeep_ahead
from robophm.report.maintenance_calendar import calendar
from robophm.web.access.roles import needs
from robophm.web.prepared_robot import PreparedRobot, finite
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
from robophm.web.service import Service as ServiceOfRobot
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/maintenance", tags=["maintenance"])


class ServiceSaid(Shape):
    """A person says that a part was replaced or repaired, just now."""

    part: Annotated[str, Field(min_length=1, max_length=1000)]
    """Path of the component, or of its failure mode."""
    remaining: Annotated[float, Field(ge=0, le=1)] | None = None
    """The share of its age that remains after a repair, 0 as new; null: a new one was put in."""
    failed: bool = False
    by: Annotated[str, Field(max_length=MOST_WORDS // 10)] = ""
    note: Annotated[str, Field(max_length=MOST_WORDS)] = ""
    key: Annotated[str, Field(min_length=8, max_length=100)]
    """A word that no other request has: sent again with the same one, it is not done again."""


class ServiceDone(Shape):
    """The effect of a service on one failure mode; ages without the initial exposure, while that still counts."""

    time: float | None
    """Time to which the robot's life had been counted then [s since the epoch]; null before its first."""
    mode: str
    kind: Literal["replaced", "repaired", "failed", "struck out"]
    failed: bool
    before: float
    """Effective age before it [unit of its clock]."""
    after: float
    """Effective age after it."""
    by: str
    note: str


class DuePart(Shape):
    """When a part is to be replaced; times in hours of calendar time from now on."""

    part: str
    quantity: int
    state: Literal["now", "ahead", "useless", "unknown", "still"]
    """``useless``: a new one would fail as soon; ``unknown``: no rate; ``still``: it does not age."""
    due: float | None
    """Time until which a failure comes with the chance that is taken; 0: now; null: not by age."""
    why: str
    early: float | None
    """Time until which it has failed with 5 %; null: never."""
    median: float | None
    late: float | None
    """The same with 95 %."""
    wear: str
    alone: bool
    """Whether it fails by itself; else it is told as if the parts that it depends on all worked."""
    served: ServiceDone | None


class ReplacementsToCome(Shape):
    """The number of replacements of a type of part, where what has failed is replaced at once."""

    name: str
    parts: list[str]
    count: int
    hours: float
    """Calendar time within which they are counted [h]."""
    expected: float | None
    """Mean number; null where a rate is unknown."""
    low: int | None
    high: int | None
    """The number is between both with 90 %."""
    none: float | None
    """Probability that there is none."""
    exact: bool


class Maintenance(Shape):
    """The upkeep that the robot asks for, and what was done."""

    time: float | None
    """Time of which the figures are [s since the epoch]; null: of a new robot."""
    risk: float
    silence: str
    due: list[DuePart]
    others: int
    """Parts that were not looked at, as they do not wear, or are less likely to fail within a year."""
    replacements: list[ReplacementsToCome]
    services: list[ServiceDone]
    """The last services, the latest first."""
    past: bool
    """Whether a past is known, in which services can be noted."""
    costs: str
    """The table of costs that is kept; empty where there is none."""


class CostsSaid(Shape):
    """A table of costs as comma-separated values, as ``robophm maintain`` takes it."""

    text: Annotated[str, Field(max_length=1_000_000)]


class PlannedPart(Shape):
    """When a part is best replaced, for its costs; costs per hour of calendar time."""

    part: str
    age: float | None
    """Age at which it is best replaced [unit of its clock]; null: never by age."""
    unit: str
    every: float | None
    """The same in calendar time [h]."""
    cost: float
    never: float
    """Cost where only what has failed is replaced."""
    due: float | None


class YearsOfUpkeep(Shape):
    """Costs of upkeep over the horizon, by simulation: mean, 90 % between, standard error of the mean."""

    cost: float
    low: float
    high: float
    error: float
    availability: float
    failures: float
    replacements: float


class MaintenancePlan(Shape):
    """The best plan beside what is done where only what has failed is replaced."""

    hours: float
    repetitions: int
    parts: list[PlannedPart]
    unknown: list[str]
    today: YearsOfUpkeep | None
    best: YearsOfUpkeep | None


Risk = Annotated[float, Query(gt=0, le=0.5)]
REPETITIONS = 400
MOST_SERVICES = 100


@router.get("", responses=REFUSED)
def get_maintenance(service: Served, risk: Risk = RISK) -> Maintenance:
    """Parts that are due, why and by when; replacements to come; what was done."""
    _, ledger, found = _ahead(service, risk)
    robot = found.robot
    return Maintenance(
        time=None if found.known_to is None else found.known_to / SECOND,
        risk=risk,
        silence=found.silence,
        due=[_due(robot, one) for one in found.dues.parts],
        others=found.dues.others,
        replacements=[
            ReplacementsToCome(**{**vars(one), "parts": list(one.parts)})
            for within in found.replacements.values()
            for one in within
        ],
        services=services_told(robot, ledger.services[: -MOST_SERVICES - 1 : -1]),
        past=ledger.known_to is not None,
        costs=_kept_costs(service).read_text("utf-8") if _kept_costs(service).exists() else "",
    )


@router.get("/maintenance.ics", responses=REFUSED, response_class=Response)
def get_calendar(service: Served, risk: Risk = RISK) -> Response:
    """The parts that are due as a calendar to subscribe to, by RFC 5545."""
    _, _, found = _ahead(service, risk)
    text = calendar(found.robot.name, found.robot.identity, found.dues, found.known_to)
    return Response(text, media_type="text/calendar; charset=utf-8")


@router.post("/costs", responses=REFUSED)
@needs("editor")
def keep_costs(said: CostsSaid, service: Served) -> Maintenance:
    """Keep a table of costs beside the design, in place of the one of before; an empty one keeps none."""
    place = _kept_costs(service)
    if said.text.strip():
        _costs_of(said.text, service.prepared().robot, 0.0)
        write_atomically(place, said.text)
    else:
        place.unlink(missing_ok=True)
    return get_maintenance(service)


@router.get("/plan", responses={**REFUSED, 404: {"description": "No table of costs is kept"}})
def get_plan(
    service: Served, hour_down: Annotated[float, Query(ge=0, le=1e12)] = 0.0,
    hours: Annotated[float, Query(gt=0, le=1e6)] = 5 * 8766.0,
) -> MaintenancePlan:  # fmt: skip
    """When each part is best replaced for the costs that are kept, beside what is done where only failures count."""
    place = _kept_costs(service)
    if not place.exists():
        raise HTTPException(404)
    prepared = service.prepared()
    costs = _costs_of(place.read_text("utf-8"), prepared.robot, hour_down)
    outlook = service.outlooks(prepared)["sensor_based"]
    plan = UpkeepPlan.of(
        prepared.robot, costs, outlook.future.pace(prepared.plant), age=outlook.age, hour_down=hour_down
    )
    cycles = plan.life_cycles(hours, REPETITIONS, 0)
    return MaintenancePlan(
        hours=hours,
        repetitions=REPETITIONS,
        parts=[
            PlannedPart(
                part=one.path, age=one.age, unit=CLOCK_UNITS[one.mode.clock], every=one.policy.age,
                cost=one.policy.cost_rate, never=one.policy.never, due=one.due,
            )
            for one in plan.parts
        ],
        unknown=list(plan.unknown),
        today=_years(cycles.failures_only) if cycles else None,
        best=_years(cycles.by_age) if cycles else None,
    )  # fmt: skip


@router.post("/service", responses=REFUSED)
@needs("operator")
def note_service(said: ServiceSaid, service: Served) -> list[ServiceDone]:
    """Note that a part was replaced or repaired; whoever goes on with the robot's past takes it in, once."""
    run = service.monitoring.run
    robot = run.robot if run and run.state == "running" else service.prepared().robot
    note = ServiceNote(said.part, said.remaining, said.failed, said.by.strip(), said.note.strip())
    return services_told(robot, service.monitoring.note_service(robot, note, said.key))


def services_told(robot: Robot, services: Sequence[Service]) -> list[ServiceDone]:
    """Return services of a robot as a response; those of parts that are in its design no more are left out."""
    paths = {mode.key: mode.path for mode in robot.modes}
    return [
        ServiceDone(
            time=one.time / SECOND if one.time else None, mode=paths[one.mode], kind=one.kind, failed=one.failed,
            before=one.before[1], after=one.after[1], by=one.by, note=one.note,
        )
        for one in services
        if one.mode in paths
    ]  # fmt: skip


def _ahead(service: ServiceOfRobot, risk: float) -> tuple[PreparedRobot, Ledger, UpkeepAhead]:
    prepared = service.prepared()
    service.monitoring.catch_up(prepared.robot)
    exposure, ledger = service.past(prepared)
    with service.monitoring.alarm_log(prepared.robot) as log:
        alarms = [Alarm.of(one) for one in log.alarms(open_only=True)]
    silent = "" if ledger.known_to is None else silence(exposure.silent(exposure.settled(ledger)))
    found = upkeep_ahead(
        prepared.robot, service.outlooks(prepared)["sensor_based"], ledger, wear=prepared.seen_wear(exposure, ledger),
        alarms=alarms, risk=risk, silent=silent,
    )  # fmt: skip
    return prepared, ledger, found


def _due(robot: Robot, one: PartDue) -> DuePart:
    served = services_told(robot, [one.served])[0] if one.served else None
    return DuePart(
        part=one.part, quantity=one.quantity, state=one.state, due=one.due, why=one.why, early=finite(one.early),
        median=finite(one.median), late=finite(one.late), wear=one.wear, alone=one.alone, served=served,
    )  # fmt: skip


def _years(one: LifeCycle) -> YearsOfUpkeep:
    return YearsOfUpkeep(**{name: getattr(one, name) for name in YearsOfUpkeep.model_fields})


def _kept_costs(service: ServiceOfRobot) -> Path:
    design = service.settings.design
    return design.with_name(f"{design.name}.costs.csv")


def _costs_of(text: str, robot: Robot, hour_down: float) -> dict[str, PartCosts]:
    """The costs of a table. Raises DataError, with the row, where it is none, or no part of it has a rate."""
    with TemporaryDirectory() as folder:
        table = Path(folder) / "costs.csv"
        table.write_text(text, "utf-8")
        try:
            found = read_costs(table, robot, hour_down)
        except RobophmError as error:
            raise DataError(str(error).replace(f"{table}", "costs")) from None
    if all(one.part.unknown for one in found.values()):
        raise DataError("costs: all parts in it are of unknown rate; expected one with a rate")
    return found
