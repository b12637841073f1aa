"""The first look at a drafted robot: what its figures may be while so much is assumed, and what to ask next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robophm.design.robot import FailureMode, Robot
from robophm.design.task import Leg, Task
from robophm.drafting.bindings import inputs_of
from robophm.health.drawn_rates import draw_rates
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.rate_sensitivity import LargestUnknown, Ranges, largest_unknowns, ranges
from robophm.health.report import HealthReport
from robophm.health.uncertainty import DRAWS, Interval, weighted_interval
from robophm.health.unknown_rates import PartsOfUnknownRate, unknown
from robophm.monitoring.replay import replay
from robophm.parts import graded

HOUR_OF_WORK = Task((Leg(1.0),))
"""The task where a design states none."""


@dataclass(frozen=True)
class FirstLook:
    """A robot's figures as ranges, after what it recorded, and the parts that it would help most to know."""

    robot: Robot
    task: Task
    lived: float
    """Hours of operation that were heard."""
    ranges: Ranges
    unknowns: tuple[LargestUnknown, ...]
    left_out: PartsOfUnknownRate | None
    report: HealthReport | None
    """The health of the robot after its recordings; None where there are none, or no signal is bound."""


def first_look(robot: Robot, recordings: Sequence[Path] = (), *, most: int = 3) -> FirstLook:
    """Figures of a robot after recordings, or as designed. Raises RobophmError where none can be given."""
    heard = [str(path) for path in recordings] if robot.signals else []
    report = replay(robot, heard, skip_missing=True) if heard else None
    outlook = report.outlooks["sensor_based"] if report else as_designed(Plant(robot))
    return look_at(robot, outlook, report, most=most)


def look_at(robot: Robot, outlook: Outlook, report: HealthReport | None = None, *, most: int = 3) -> FirstLook:
    """Figures of a robot by an outlook, which may be of a report. Raises RobophmError where none can be given."""
    task = robot.task or HOUR_OF_WORK
    return FirstLook(
        robot,
        task,
        report.clocks["operating"] if report else 0.0,
        ranges(outlook, robot.diagram, task),
        tuple(largest_unknowns(outlook, robot.diagram, task, most=most)),
        unknown(outlook, robot.diagram),
        report,
    )


@dataclass(frozen=True)
class PartFigures:
    """A part of a draft in figures."""

    path: str
    quantity: int
    entry: str
    """The name of its entry in the library of parts; "" where its rate is from elsewhere."""
    grade: str
    source: str
    rate: Interval
    """Mean over its life, at design stress, of all its failure modes [1/h of operation]: 5 %, median, 95 %."""
    stated: float
    """The rate as stated, of which the range is."""
    stresses: tuple[str, ...]
    """Names of the stresses and clocks that its hazard rate depends on."""
    signals: tuple[str, ...]
    """Names of the signals that these are measured by."""


def part_figures(robot: Robot) -> list[PartFigures]:
    """Every part with its rate, how sure that is, where it is from, and what it listens to."""
    plant = Plant(robot)
    usage = np.where(plant.calendar, 1 / robot.usage.operating, plant.usage)
    rates = np.array([mode.rate for mode in robot.modes]) * usage
    drawn = rates[:, None] * draw_rates(plant, DRAWS, seed=0)
    found = []
    for i, part in enumerate(plant.components):
        rows = np.flatnonzero(plant.part == i)
        modes = [robot.modes[row] for row in rows]
        said = graded(modes[0].source)
        entry, _, grade = said.partition(", grade ")
        each = [channel for mode in modes for stress in mode.stresses for channel in stress.channels.values()]
        listened = [channel.signal for channel in each]
        listened += [signal for mode in modes if mode.measured_clock for signal in mode.measured_clock.signals]
        clocks = [mode.clock for mode in modes if mode.clock not in ("operating", "calendar")]
        total = drawn[rows].sum(axis=0)
        found.append(
            PartFigures(
                part.path, part.quantity, entry, grade or _grade(modes[0]),
                modes[0].source, weighted_interval(total, np.ones(len(total)) / len(total)), float(rates[rows].sum()),
                tuple(dict.fromkeys([*inputs_of(part), *clocks])), tuple(dict.fromkeys(listened)),
            )
        )  # fmt: skip
    return found


def _grade(mode: FailureMode) -> str:
    """B where a handbook's model gives the rate; "" where nobody says how good it is."""
    return "B" if mode.stresses and "." in mode.stresses[0].model.name else ""
