"""A robot prepared to be asked, once for each design: its plant, its new self, what its levels promise."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import cached_property
from typing import Any, Literal

from robophm.blocks.single_points import single_points_of_failure
from robophm.design.robot import Module, Robot
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.report import HealthReport
from robophm.health.reporting import health_report
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.health.when_new import hazard_rates
from robophm.health.why import Explanation, explain
from robophm.health.worn import SeenWear
from robophm.monitoring.wear_watch import WearWatch
from robophm.web.shapes import LevelFigures, UnknownRates

_KEPT = 4


class PreparedRobot:
    """A robot prepared for questions: what does not change while its design does not."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.wear = WearWatch(robot)
        """Forecasts of its wear."""
        self._asking = threading.Lock()
        self._known: tuple[Mapping[str, Any], HealthReport, Explanation] | None = None
        """The past for which its health was worked out last, that health, and why it is so."""

    @cached_property
    def plant(self) -> Plant:
        """Return the robot compiled for computation. Raises RobophmError where no figures can be given for it."""
        return Plant(self.robot)

    def seen_wear(self, exposure: ExposureIntegrator, ledger: Ledger) -> Sequence[SeenWear]:
        """Return what sensors have seen of the robot's wear by now, as the ledger tells."""
        return self.wear.renewed(exposure.settled(ledger))

    def health(self, exposure: ExposureIntegrator, ledger: Ledger) -> tuple[HealthReport, Explanation]:
        """Return its health by this past, and why it is so: worked out once for a past that stays the same."""
        past = ledger.to_json()
        with self._asking:
            if self._known is None or self._known[0] != past:
                settled = exposure.settled(ledger)
                report = health_report(self.plant, exposure, settled, wear=self.wear.renewed(settled))
                self._known = past, report, explain(report)
            return self._known[1:]

    @cached_property
    def new(self) -> Outlook:
        """Return the outlook of the new robot, as designed."""
        return as_designed(self.plant)

    @cached_property
    def modules(self) -> Mapping[str, Module]:
        """Return the robot under an empty path, then its modules by path."""
        return self.robot.levels

    @cached_property
    def rates(self) -> dict[str, float]:
        """Return the nominal hazard rate when new of each level and part, by path; equal parts together [1/h]."""
        return hazard_rates(self.new)

    @cached_property
    def unknown(self) -> dict[str, PartsOfUnknownRate]:
        """Return the effect of parts of unknown rate on each level and part that has some, by path."""
        found = {path: unknown(self.new, module.diagram) for path, module in self.modules.items()}
        for part, alone in zip(self.plant.components, self.plant.alone, strict=True):
            if part.unknown:
                found[part.path] = unknown(self.new, alone)
        return {path: one for path, one in found.items() if one}

    @cached_property
    def single_points(self) -> frozenset[str]:
        """Return paths of the components, and their units, whose failure alone fails the robot."""
        units = single_points_of_failure(self.robot.diagram)
        return frozenset(units) | frozenset(unit.partition("[")[0] for unit in units)

    @cached_property
    def levels(self) -> dict[str, LevelFigures]:
        """Return the figures of each level and part when new, by path."""
        found = {
            path: LevelFigures(
                kind="module" if path else "robot",
                hazard_rate=finite(self.rates[path]),
            )
            for path in self.modules
        }
        for part in self.robot.all_components():
            found[part.path] = LevelFigures(
                kind="component",
                hazard_rate=finite(self.rates[part.path]),
                quantity=part.quantity,
                single_point=part.path in self.single_points,
            )
        return found


Says = Literal["sentence", "of_tasks", "aside"]
"""The kind of note on parts of unknown rate beside figures: of health, of tasks, of figures that are no bounds."""


def unknown_of(found: PartsOfUnknownRate | None, says: Says = "sentence") -> UnknownRates | None:
    """Return the effect of parts of unknown rate as a response; None where there are none."""
    return rates_of(found, says) if found else None


def rates_of(found: PartsOfUnknownRate, says: Says = "sentence") -> UnknownRates:
    """Return the effect of parts of unknown rate as a response."""
    return UnknownRates(**asdict(found), failing=found.failing, sentence=getattr(found, says))


def finite(value: float) -> float | None:
    """Return the value, or None where it is no finite number, which JSON cannot say."""
    return value if math.isfinite(value) else None


class PreparedRobots:
    """The latest few prepared robots, by identity; for any number of threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._found: OrderedDict[int, PreparedRobot] = OrderedDict()

    def of(self, robot: Robot) -> PreparedRobot:
        """Return the prepared robot, made now or remembered."""
        with self._lock:
            one = self._found.get(id(robot))
            if one is None or one.robot is not robot:
                one = self._found[id(robot)] = PreparedRobot(robot)
            self._found.move_to_end(id(robot))
            while len(self._found) > _KEPT:
                self._found.popitem(last=False)
            return one
