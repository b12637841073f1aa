"""Rates of a design as failures in the field have them: ``robophm.learn``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from robophm.core.argument_checks import instance
from robophm.core.errors import DataError
from robophm.design.robot import Robot
from robophm.health.drawn_rates import handbook_of
from robophm.health.unknown_rates import few
from robophm.interface.asking import Paths, RobotOrPath, paths_of, robot_of
from robophm.learning.rates.failure_log import Seen, read_failure_log
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate, unstated
from robophm.learning.rates.rate_update import learn as learned_rates
from robophm.monitoring.rate_history import each_once, rate_history
from robophm.monitoring.stored_past import stored_past
from robophm.parts import graded
from robophm.stores import place_of

STORES = (".db", ".sqlite", ".sqlite3")
"""Suffixes of stores; all else is a log."""


@dataclass(frozen=True)
class Learned:
    """The rates of a robot as the field has them."""

    robot: Robot
    rates: tuple[LearnedRate, ...]
    unknown: tuple[UnstatedRate, ...]
    """The experience with parts whose rate the design does not know."""
    notes: tuple[str, ...]


def learn(robot: RobotOrPath, logs: Paths, *, prior: str | None = None, of: str | None = None) -> Learned:
    """Learn the rates of a design from failures in the field: failure logs (CSV, YAML) and stores of robots (.db).

    ``prior``: what stated rates count as, "10000 h" or "2 failures"; ``of``: the rates of this one robot of the fleet.
    Raises DataError where a log is none, or nothing was seen.
    """
    found = robot_of(robot)
    for name, given in (("prior", prior), ("of", of)):
        instance(given, str | None, name, "text, or None", DataError)
    seen: list[Seen] = []
    notes: list[str] = []
    given_logs = list(paths_of(logs, "log"))
    for log, robot_name in zip(given_logs, each_once([place_of(log) for log in given_logs]), strict=True):
        if is_store(log):
            with stored_past(str(log), found) as (_, ledger):
                seen += rate_history(found, ledger, robot_name)
        else:
            read = read_failure_log(log, found)
            seen += read.seen
            notes += read.notes
    if not any(one.exposure > 0 or one.failures for one in seen):
        raise DataError("nothing was seen: no failure and no exposure; expected a log or a robot that has worked")
    rates = learned_rates(found, seen, prior, of)
    notes += rated_alike(found, rates)
    return Learned(found, tuple(rates), tuple(unstated(found, seen)), tuple(notes))


def rated_alike(robot: Robot, learned: Sequence[LearnedRate]) -> list[str]:
    """Return a sentence for each model or entry that rates parts of which something was seen, and others too.

    What the field says of one part is that part's alone (docs/adr/0063): the others keep the rate as stated, and who
    reads that one is three times worse than stated should know of them.
    """
    seen = {one.mode.path for one in learned}
    found: dict[str, tuple[set[str], set[str]]] = {}
    for mode in robot.modes:
        name = handbook_of(mode) or graded(mode.source).partition(",")[0]
        if name and not mode.unknown and not mode.evidence:
            heard, silent = found.setdefault(name, (set(), set()))
            (heard if mode.path in seen else silent).add(robot.part_of(mode))
    return [
        f"{name} rates {few(sorted(heard))}, of which something was seen, and {few(sorted(silent - heard))}, of which "
        f"nothing was: {'their rates stay' if len(silent - heard) > 1 else 'its rate stays'} as stated; a log counts "
        "parts that still work too"
        for name, (heard, silent) in found.items()
        if heard and silent - heard
    ]


def is_store(log: Path) -> bool:
    """Whether a path is that of a store, or its kind and where it is."""
    return log.suffix.lower() in STORES or place_of(log) != str(log)
