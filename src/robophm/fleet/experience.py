"""Failures and exposure of all robots of a design, by the newest ledger that each has sent."""

from __future__ import annotations

import json
import math
import zlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from typing import Any, NamedTuple

from robophm.core.errors import DataError, StoreError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.fleet.engines.engine import Row
from robophm.fleet.figures import present_sum
from robophm.fleet.store import FleetStore
from robophm.health.ledger import Ledger
from robophm.learning.rates.failure_log import Seen
from robophm.monitoring.rate_history import rate_history

AT_ONCE = 200
"""Ledgers that are in memory at a time."""

MOST_NAMED = 3
"""Robots that an error names, at most."""

_NO_LEDGER = (ArithmeticError, AttributeError, LookupError, OSError, TypeError, ValueError)


class ObservedRobot(NamedTuple):
    """A robot of a fleet and what each of its parts has gone through, failures and exposure."""

    robot: str
    site: str | None
    version: str | None
    """First eight digits of the hash of its design, by which versions of a design are told apart."""
    year: str
    """Year in which its record begins, by its own clock."""
    seen: tuple[Seen, ...]


class Experience(NamedTuple):
    """The experience of all robots of one design."""

    design: Robot
    robots: tuple[ObservedRobot, ...]

    @property
    def seen(self) -> list[Seen]:
        """The experience of each failure mode in each robot."""
        return [seen for one in self.robots for seen in one.seen]


class FleetExperience(NamedTuple):
    """The experience of a fleet, design by design."""

    designs: tuple[Experience, ...]
    left_out: dict[str, str]
    """Robots of which nothing is counted, and why."""


def experience(store: FleetStore, designs: Sequence[Robot]) -> FleetExperience:
    """Return the experience of robots of each design, by its name, as their newest ledgers have it.

    A ledger that was kept under another version of a design counts where each of its parts is told by its identity.
    Raises DataError where two designs have one name, or no robot of any has sent a ledger.
    """
    by_name, found, left_out = {one.name: one for one in designs}, defaultdict[str, list[ObservedRobot]](list), {}
    if len(by_name) < len(designs):
        raise DataError("two designs have the same name, by which robots report of them; expected each once")
    for name, site, design, digest, *kept in _kept(store):
        if design is None:
            left_out[name] = "has sent no ledger yet"
        elif design not in by_name:
            left_out[name] = f"is of another design, {design}"
        else:
            try:
                year, seen = _lived(by_name[design], _ledger(store, name, kept), name)
            except StoreError as error:
                left_out[name] = str(error)
            else:
                found[design].append(ObservedRobot(name, site, digest[:8] if digest else None, year, seen))
    if not found:
        why = "; ".join(f"{name}: {said}" for name, said in [*left_out.items()][:MOST_NAMED])
        raise DataError(f"{store.place}: no robot of {', '.join(by_name)} has sent a ledger of its work"
                        f"{f' ({why})' if why else ''}; expected one at least")  # fmt: skip
    return FleetExperience(tuple(Experience(one, tuple(found[one.name])) for one in designs), left_out)


def _kept(store: FleetStore) -> Iterator[Row]:
    """Name, site, design with its hash, ledger, report and checksum of each robot, by name."""
    last = ""
    while rows := store.rows(
        "SELECT robot.name, robot.site, present.design, present.design_hash, present.ledger, present.report, "
        "present.sum FROM robot LEFT JOIN present ON present.robot = robot.number WHERE robot.name > ? "
        "ORDER BY robot.name LIMIT ?", (last, AT_ONCE),
    ):  # fmt: skip
        last = rows[-1][0]
        yield from rows


def _ledger(store: FleetStore, name: str, kept: Sequence[Any]) -> bytes:
    ledger, report, told = kept
    if present_sum(ledger, report) != told:
        raise StoreError(f"{store.place}: the ledger of {name} is damaged: its checksum is another")
    return ledger  # type: ignore[no-any-return]


def _lived(design: Robot, kept: bytes, name: str) -> tuple[str, tuple[Seen, ...]]:
    """The year in which a robot's record begins, and its experience; StoreError where a ledger does not tell them."""
    try:
        ledger = Ledger.of(design, json.loads(zlib.decompress(kept)))
        if ledger.started is None:
            raise StoreError("has not worked yet")
        year = str(datetime.fromtimestamp(ledger.started // SECOND, UTC).year)
        seen = tuple(rate_history(design, ledger, name))
    except _NO_LEDGER as error:  # a robot may send whatever it likes in its place
        raise StoreError(f"has sent a ledger that cannot be read: {type(error).__name__}") from None
    if any(not 0 <= value < math.inf for one in seen for value in (one.failures, one.expected, one.exposure)):
        raise StoreError("has sent a ledger with exposure that cannot be")
    return year, seen
