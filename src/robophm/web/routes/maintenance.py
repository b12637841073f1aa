"""Maintenance: services that are noted while the robot is watched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Literal

from fastapi import APIRouter
from pydantic import Field

from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.health.ledger import Service
from robophm.health.service import MOST_WORDS, ServiceNote
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
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
    """What a service did to one failure mode; ages without the initial exposure, while that still counts."""

    time: float | None
    """Time to which the robot's life had been counted then [s since the epoch]; null before its first."""
    mode: str
    kind: Literal["replaced", "repaired"]
    failed: bool
    before: float
    """Effective age before it [unit of its clock]."""
    after: float
    """Effective age after it."""
    by: str
    note: str


@router.post("/service", responses=REFUSED)
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
