"""Failures and exposure of all robots of a design, by the newest ledger that each has sent."""

from __future__ import annotations

import json
import math
import zlib
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any, NamedTuple

from robophm.core.errors import DataError, StoreError
from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.fleet.engines.engine import Row
from robophm.fleet.figures import must_be_kept
from robophm.fleet.store import FleetStore
from robophm.health.ledger import Ledger
from robophm.learning.rates.failure_log import Seen
from robophm.monitoring.rate_history import rate_history

AT_ONCE = 200
"""Ledgers that are in memory at a time."""

MOST_NAMED = 3
"""Robots that an error names, at most."""

NO_LEDGER = (ArithmeticError, AttributeError, LookupError, OSError, TypeError, ValueError, zlib.error)
"""Errors by which it shows that what was sent in place of a ledger is none."""


NOT_WORKED = "has not worked yet"
"""Why nothing is counted of a robot whose ledger is as new."""


class Origin(NamedTuple):
    """The origin of a robot's record, by which robots are put together."""

    design: str
    site: str | None
    version: str | None
    """First eight digits of the hash of its design, by which versions of a design are told apart."""
    year: str
    """Year in which its record begins, by its own clock."""


class ObservedRobot(NamedTuple):
    """A robot of a fleet and what each of its parts has gone through, failures and exposure."""

    robot: str
    origin: Origin
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


class KeptLedger(NamedTuple):
    """A robot and its newest ledger, or why there is none that counts."""

    robot: str
    site: str | None
    design_hash: str | None
    design: str
    """Name of its design; empty where it is not known."""
    ledger: Ledger | None
    why: str
    """Why it is left out; empty where it is not."""

    @property
    def origin(self) -> Origin:
        """Return the origin of a ledger's record. Raises StoreError of one that has not begun, and NO_LEDGER."""
        if self.ledger is None or self.ledger.started is None:
            raise StoreError(NOT_WORKED)
        year = str(datetime.fromtimestamp(self.ledger.started // SECOND, UTC).year)
        return Origin(self.design, self.site, self.design_hash[:8] if self.design_hash else None, year)


def kept_ledgers(store: FleetStore, designs: Sequence[Robot], names: Collection[str] = ()) -> Iterator[KeptLedger]:
    """Yield all robots of a fleet by name, with the ledgers of those of some designs. Raises StoreError, DataError.

    ``names``: of these robots alone, where there are any. A ledger that was kept under another version of a design
    counts where each of its parts is told by its identity.
    """
    by_name = {one.name: one for one in designs}
    if len(by_name) < len(designs):
        raise DataError("two designs have the same name, by which robots report of them; expected each once")
    for name, site, design, digest, *kept in _kept(store):
        if names and name not in names:
            continue
        ledger, why = None, ""
        if design is None:
            why = "has sent no ledger yet"
        elif design not in by_name:
            why = f"is of another design, {design}"
        else:
            try:
                ledger = _ledger(store, name, by_name[design], kept)
            except StoreError as error:
                why = str(error)
        yield KeptLedger(name, site, digest, design or "", ledger, why)


UNREADABLE = "has sent a ledger that cannot be read"
"""Why a robot is left out whose ledger is none."""


def experience(store: FleetStore, designs: Sequence[Robot]) -> FleetExperience:
    """Return the experience of robots of each design, by its name, as ``kept_ledgers`` has them.

    Raises DataError where two designs have one name, or no robot of any has sent a ledger.
    """
    by_name, found, left_out = {one.name: one for one in designs}, defaultdict[str, list[ObservedRobot]](list), {}
    for one in kept_ledgers(store, designs):
        why = one.why
        if one.ledger:
            try:
                found[one.design].append(_lived(by_name[one.design], one.ledger, one))
            except StoreError as error:
                why = str(error)
        if why:
            left_out[one.robot] = why
    if not found:
        said = "; ".join(f"{name}: {why}" for name, why in [*left_out.items()][:MOST_NAMED])
        raise DataError(f"{store.place}: no robot of {', '.join(by_name)} has sent a ledger of its work"
                        f"{f' ({said})' if said else ''}; expected one at least")  # fmt: skip
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


def _ledger(store: FleetStore, name: str, design: Robot, kept: Sequence[Any]) -> Ledger:
    text, report, told = kept
    must_be_kept(store.place, name, text, report, told)
    try:
        return Ledger.of(design, json.loads(zlib.decompress(text)))
    except NO_LEDGER:  # a robot may send whatever it likes in its place
        raise StoreError(UNREADABLE) from None


def _lived(design: Robot, ledger: Ledger, kept: KeptLedger) -> ObservedRobot:
    """What a robot has gone through by its ledger; StoreError where that does not tell it."""
    try:
        found = ObservedRobot(kept.robot, kept.origin, tuple(rate_history(design, ledger, kept.robot)))
    except NO_LEDGER:
        raise StoreError(UNREADABLE) from None
    if any(not 0 <= value < math.inf for one in found.seen for value in (one.failures, one.expected, one.exposure)):
        raise StoreError("has sent a ledger with exposure that cannot be")
    return found
