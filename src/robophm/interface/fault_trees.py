"""Fault trees and minimal sets: ``robophm.fault_tree``, ``robophm.dynamic_tree`` and ``robophm.cutsets``."""

from __future__ import annotations

from os import PathLike
from time import perf_counter

from robophm.blocks.dynamic_modules import DynamicAnswer
from robophm.blocks.listed_sets import ListedSets
from robophm.blocks.top_event import TopEvent
from robophm.core.argument_checks import instance, number, path, shown
from robophm.core.errors import DesignError, RobophmError
from robophm.design.importers import galileo
from robophm.design.importers.open_psa import load as read_model
from robophm.design.robot import Robot
from robophm.health.fault_tree import fault_tree as tree_of_robot
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.interface.asking import RobotOrPath, robot_of

MODEL = ".xml"
"""The suffix of models in the Open-PSA format; all else is a design."""


def fault_tree(
    source: RobotOrPath, function: str | None = None, *, hours: float | None = None, top: str | None = None
) -> TopEvent:
    """The fault tree of a new robot or of a function of it, or of an Open-PSA model (.xml), with the ``probability``
    of its top event; ``cut_sets`` and ``path_sets`` list what it takes.

    ``hours`` of operation of a robot, 1000 unless given, or mission time of a model; ``top``: a gate of a model, or a
    sequence of its event trees. Raises RobophmError, with the nearest name, for what is none.
    """
    time = None if hours is None else number(hours, "hours")
    instance(function, str | None, "function", "the name of one, or None")
    instance(top, str | None, "top", "the name of a gate, or None")
    if not isinstance(source, Robot):
        file = path(source, "robot or model", DesignError)
        if file.suffix.lower() == MODEL:
            if function is not None:
                raise RobophmError(f"function {shown(function)}: is of a robot; expected top, a gate of the model")
            return read_model(file, time, top).top_event()
    if top is not None:
        raise RobophmError(f"top {shown(top)}: is of a model; expected function, one of the robot")
    return tree_of_robot(as_designed(Plant(robot_of(source))), function, 1000.0 if time is None else time)


def dynamic_tree(source: str | PathLike[str], hours: float, *, seconds: float = 60.0) -> DynamicAnswer:
    """How likely the top event of a dynamic fault tree in the Galileo format is by a time, and its mean time.

    ``hours``: the time, in the unit of the tree's rates. Raises RobophmError for what is no such tree or cannot be
    solved exactly in so many ``seconds``.
    """
    file = path(source, "dynamic fault tree", DesignError)
    time = number(hours, "hours")
    return galileo.load(file).solved(time, perf_counter() + number(seconds, "seconds", above=True))


def cutsets(
    robot: RobotOrPath, function: str | None = None, *, hours: float = 1000.0, most: int = 20,
    order: int | None = None, paths: bool = False,
) -> ListedSets:  # fmt: skip
    """The smallest sets of parts whose failure fails a robot, the likeliest by then first; all are counted.

    Of at most ``order`` parts, where that is given, the smallest first. ``paths``: sets whose work is enough instead.
    Raises RobophmError, with the nearest name, for a function that there is not.
    """
    listed = int(number(most, "most", low=1, high=100_000, whole=True))
    if order is not None:
        order = int(number(order, "order", low=1, whole=True))
    event = fault_tree(robot, function, hours=number(hours, "hours"))
    return event.path_sets(listed, order) if paths else event.cut_sets(listed, order)
