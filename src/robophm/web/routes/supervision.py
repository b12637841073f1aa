"""Answers for a supervisor, who has no token: whether the service lives, and does what it was started for."""

from __future__ import annotations

from fastapi import APIRouter, Response

from robophm.web.service import Served, Service
from robophm.web.shapes import Shape

router = APIRouter(tags=["supervision"])


class Standing(Shape):
    """Whether all is as it should be, and what is not, in words that tell nothing of the robot."""

    ok: bool
    wrong: list[str]


@router.get("/healthz", responses={503: {"model": Standing, "description": "Something has failed"}})
def get_healthz(service: Served, response: Response) -> Standing:
    """Whether the service works: 503 where what watches the robot has failed."""
    return _told(_failures(service), response)


@router.get("/readyz", responses={503: {"model": Standing, "description": "Not ready"}})
def get_readyz(service: Served, response: Response) -> Standing:
    """Whether the service does what it was started for: 503 also until the robot is watched, where that was asked."""
    return _told([*_failures(service), *_awaited(service)], response)


def _failures(service: Service) -> list[str]:
    return ["monitoring has failed"] if service.monitoring.state == "failed" else []


def _awaited(service: Service) -> list[str]:
    """What was asked for and is not there yet, or not for now: a robot that is watched, and room for its past."""
    run = service.monitoring.run
    there = not service.wanted or (run is not None and (run.stopped or run.looks > 0))
    unkept = run is not None and run.state == "running" and not run.kept
    return [*([] if there else ["the robot is not watched yet"]), *(["the past cannot be kept"] if unkept else [])]


def _told(wrong: list[str], response: Response) -> Standing:
    response.status_code = 503 if wrong else 200
    return Standing(ok=not wrong, wrong=wrong)
