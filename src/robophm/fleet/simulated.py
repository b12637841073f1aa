"""Robots of a design that work and really fail, told to a fleet as robots tell it: by the engine, over the real wire.

Lives, sensors and failures are those of ``robophm simulate`` with the same seed; what is reported of them is what a
robot that is watched would report, its failures and replacements noted as ``robophm service`` notes them.
"""

from __future__ import annotations

import csv
import http.client
import json
import secrets
import tempfile
import time
from collections import defaultdict
from collections.abc import Generator, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

from robophm.core.errors import DataError, RobophmError, SourceError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.fleet.address import FleetAddress
from robophm.fleet.payload import MOST_REPORTS, packed
from robophm.fleet.post import why_not
from robophm.fleet.way import way_to
from robophm.health.service import ServiceNote, take_note
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.report_history import ReportHistory
from robophm.monitoring.seen_wear import seen_wear
from robophm.parts import completed
from robophm.simulation.fleet import simulate
from robophm.stores.outbox import HORIZONS, Batch, Present, Waiting, report_values
from robophm.transports.recordings.opening import open_source


class TrueEvent(NamedTuple):
    """One thing that truly happened to a simulated robot, whether it was reported or not."""

    time: int
    """Time of it by the clock of all [ns since the epoch]."""
    part: str
    """Path of the part; empty: the robot as a whole."""
    what: str
    """Either "failed", "replaced", "inspected", or "end" of the record; a failure after it is the robot's next."""
    mode: str
    """Path of the failure mode by which the part had failed; empty where it had not, and for the robot as a whole."""


class SimulatedRobot(NamedTuple):
    """A robot that has worked, what it would have reported of it, and the truth."""

    name: str
    reports: Sequence[Mapping[str, Any]]
    """Health reports as JSON, oldest first, with the chances of failing that a fleet asks for."""
    ledger: Mapping[str, Any]
    events: Sequence[TrueEvent]


def simulated_robots(
    design: Path, robots: int, tasks: int, seed: int, every: float, end: int
) -> Generator[SimulatedRobot]:
    """Yield robots that do at least so many tasks each, the record of each ending at ``end`` [ns since the epoch].

    A report is made every ``every`` seconds. The same seed gives the same robots. Raises RobophmError.
    """
    robot = load(design)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / "fleet"
        simulate(design, folder, robots, tasks, seed, library=completed)
        events: dict[str, list[TrueEvent]] = defaultdict(list)
        with (folder / "failures.csv").open(encoding="utf-8", newline="") as stream:
            for row in csv.DictReader(stream):
                by_mode = row["event"] in ("failed", "replaced")
                mode = "/".join(filter(None, (row["part"], row["mode"]))) if by_mode else ""
                events[row["robot"]].append(TrueEvent(_nanoseconds(row["time"]), row["part"], row["event"], mode))
        for path in sorted((folder / "recordings").iterdir()):
            yield _observed(robot, path, events[path.stem], round(every * SECOND), end)


def _nanoseconds(seconds: str) -> int:
    whole, _, rest = seconds.partition(".")
    return int(whole) * SECOND + int(rest.ljust(9, "0"))


def _observed(robot: Robot, recording: Path, events: Sequence[TrueEvent], every: int, end: int) -> SimulatedRobot:
    """A robot as its own monitor sees it, all times moved so that its record ends at ``end``."""
    (over,) = (event.time for event in events if event.what == "end")
    events = [event._replace(time=event.time + end - over) for event in events]
    told = [event for event in events if event.time <= end and _is_told(robot, event)]
    history = ReportHistory(robot, every, None, lambda ledger: seen_wear(robot, ledger), horizons=HORIZONS)
    monitor = Monitor(robot, on_tick=history.follow)
    with open_source(recording) as source:
        for sample in sorted(source.samples(list(robot.signals))):
            at = sample.time + end - over
            while told and told[0].time <= at:
                event = told.pop(0)
                take_note(robot, monitor.ledger, ServiceNote(event.mode, failed=True, waits=event.what == "failed"))
            monitor.observe(sample._replace(time=at))
    return SimulatedRobot(recording.stem, history.reports, monitor.ledger.to_json(), events)


def _is_told(robot: Robot, event: TrueEvent) -> bool:
    """Whether a robot's past is told of it: of what was replaced, and of what says itself that it has failed."""
    says = any(part.monitored and event.part in (part.path, *part.units) for part in robot.all_components())
    return bool(event.part) and (event.what == "replaced" or (event.what == "failed" and says))


def tell(robot: SimulatedRobot, fleet: FleetAddress, token: str) -> None:
    """Send all that a robot reported to its fleet, oldest first; return once all of it is committed.

    Raises RobophmError where the fleet does not take it.
    """
    epoch = secrets.token_hex(8)
    rows = [Waiting(seq, epoch, seq, one["time"], 0, report_values(one)) for seq, one in enumerate(robot.reports, 1)]
    state = Present(epoch, len(rows), json.dumps(robot.ledger), robot.reports[-1] if rows else None)
    with closing(way_to(fleet, token)) as way:
        for first in range(0, max(len(rows), 1), MOST_REPORTS):
            left = max(len(rows) - first - MOST_REPORTS, 0)
            batch = Batch(tuple(rows[first : first + MOST_REPORTS]), left, None if left else state)
            try:
                way.send(packed(fleet.robot, time.time_ns(), batch), batch)
            except (OSError, http.client.HTTPException, DataError, SourceError) as error:
                raise RobophmError(f"fleet {fleet.service}: {why_not(error)}") from None
