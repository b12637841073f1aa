"""A service is noted in a robot's past by whoever goes on with that past, and by who asks where nobody does.

Two processes must not write one past. So what a person says is left in the store; who holds the past takes it in
between two samples, and keeps the answer in the transaction that keeps the ledger. Who asked waits for that answer.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any
from uuid import uuid4

from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.exposure import told_to_now
from robophm.health.ledger import Ledger, Service
from robophm.health.service import ServiceNote, find, take_note
from robophm.monitoring.replay import kept_ledger
from robophm.monitoring.stored_past import unknown_robot
from robophm.stores import Address, existing_store
from robophm.stores.service_requests import ServiceRequest, ServiceRequests, WithdrawnError
from robophm.stores.store import HeldError, Store, TakesRequests

WAIT = 10.0
"""Seconds that are waited for an answer, unless others are asked for."""

LOOK_EVERY = 0.05
"""Seconds between two looks for an answer."""

Answers = dict[str, dict[str, Any]]
"""Answers by the identities of their requests."""


def note_service(
    address: Address, robot: Robot, said: ServiceNote, *, key: str | None = None, wait: float = WAIT
) -> list[Service]:
    """Note a service in a robot's past in a store that is there, also while another process goes on with that past.

    Return what it did to each failure mode. Asked again with the same ``key`` it is not done again.

    Raises RobophmError where it does not fit the design, or the past of who holds it; StoreError where the store knows
    no such robot; HeldError where nobody answered within ``wait`` [s], and nothing was noted.
    """
    with existing_store(address) as store:
        if robot.identity not in store.robots():
            raise unknown_robot(address, store, robot)
        return note_in(store, robot, said, key=key, wait=wait)


def note_in(
    store: Store, robot: Robot, said: ServiceNote, *, key: str | None = None, wait: float = WAIT
) -> list[Service]:
    """Note a service as ``note_service``, in an open store that knows the robot. Raises as it does."""
    find(robot, said.part)
    requests = requests_in(store, robot)
    if requests is None:
        with store.alone(robot.identity):
            ledger = told_to_now(robot, kept_ledger(robot, store) or Ledger.new(robot))
            done = take_note(robot, ledger, said)
            store.save(robot.identity, ledger.to_json())
            return done
    key = key or uuid4().hex
    requests.leave(ServiceRequest(key, said.to_json()))
    try:
        return _answered(store, robot, requests, key, wait)
    except BaseException:
        with suppress(RobophmError):
            requests.withdraw(key)
        raise


def _answered(store: Store, robot: Robot, requests: ServiceRequests, key: str, wait: float) -> list[Service]:
    until = time.monotonic() + wait
    while (answer := requests.answer(key)) is None:
        try:
            with store.alone(robot.identity):
                ledger = kept_ledger(robot, store) or Ledger.new(robot)
                answer_waiting(store, robot, ledger)
        except HeldError as held:
            if time.monotonic() > until and requests.withdraw(key):
                raise HeldError(
                    f"nobody answered within {wait:g} s, and nothing was noted: {str(held).partition(';')[0]}, and "
                    "does not take it in; expected one that does, or that it is ended first"
                ) from None
            time.sleep(LOOK_EVERY)
    if "refused" in answer:
        raise RobophmError(answer["refused"])
    return [Service(*one[:4], *map(tuple, one[4:6]), *one[6:]) for one in answer["done"]]


def requests_in(store: Store, robot: Robot) -> ServiceRequests | None:
    """Return the requests that are left in a store; None where this kind of store takes none."""
    return store.service_requests(robot.identity) if isinstance(store, TakesRequests) else None


def answer_waiting(store: Store, robot: Robot, ledger: Ledger) -> None:
    """Take what waits into a ledger and keep it, where nobody else goes on with that past. Raises StoreError."""
    requests = requests_in(store, robot)
    if requests and (waiting := requests.waiting()):
        served, answers = taken_in(robot, ledger, waiting)
        with suppress(WithdrawnError):
            store.save(robot.identity, served.to_json(), answers=answers)


def taken_in(robot: Robot, ledger: Ledger, requests: Sequence[ServiceRequest]) -> tuple[Ledger, Answers]:
    """Return a copy of a ledger that knows of what was asked, in order, and the answers; the ledger stays as it is."""
    served, answers = told_to_now(robot, ledger.copy()), Answers()
    for request in requests:
        try:
            done = take_note(robot, served, ServiceNote.of(request.asked))
            answers[request.key] = {"done": [list(one) for one in done]}
        except (RobophmError, TypeError) as error:  # it may have been left by another version
            answers[request.key] = {"refused": str(error)}
    return served, answers
