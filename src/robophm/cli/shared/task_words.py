"""What the options about tasks and what is known of parts say, read for a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from robophm.core.errors import DesignError, RobophmError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design.asked import contradiction
from robophm.design.build_task import build_knowledge
from robophm.design.fault import Fault
from robophm.design.robot import Robot
from robophm.design.schema_task import Knowledge as SaidKnowledge
from robophm.design.task import Knowledge, Plan


def with_knowledge(plan: Plan, robot: Robot, failed: Sequence[str], working: Sequence[str]) -> Plan:
    """The plan with what the command line knows besides. Raises DesignError where that contradicts."""
    try:
        more = build_knowledge(SaidKnowledge(failed=list(failed), working=list(working)), robot)
    except Fault as fault:
        raise DesignError(str(fault)) from None
    known = Knowledge(plan.knowledge.failed | more.failed, plan.knowledge.working | more.working)
    if says := contradiction(known, robot):
        raise DesignError(says)
    return replace(plan, knowledge=known)


def known_functions(robot: Robot, functions: Sequence[str]) -> None:
    """Raises RobophmError where the robot has no function of such a name."""
    if unknown := [name for name in functions if name not in robot.functions]:
        raise RobophmError(f"no function '{unknown[0]}'{nearest(unknown[0], robot.functions)}")


def stated_speed(text: str | None) -> float | None:
    """What ``--speed`` says [m/s]. Raises UnitError where it is none."""
    speed = quantity(text, "m/s") if text is not None else None
    if speed is not None and not speed > 0:
        raise UnitError(f"--speed {text}: expected above zero")
    return speed
