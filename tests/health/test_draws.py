"""More draws than can be paid for are refused before any is made, from Python as from the command line."""

import pytest

from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.task import Plan, Task
from robophm.health.draws import MOST_DRAWN, check_draws
from robophm.health.task_report import task_report
from robophm.monitoring.monitor import Monitor

PARTS = 1000
ROBOT = "schema_version: 1\nname: R\ncomponents:\n" + "".join(
    f"  p{i}: {{rate: 1 FIT, uncertainty: {{error_factor: 3}}}}\n" for i in range(PARTS)
)


def test_as_many_as_take_the_memory_that_there_may_be():
    robot = parse(ROBOT)
    most = MOST_DRAWN // PARTS
    assert check_draws(most, robot) == most
    for wrong, says in (
        (most + 1, f"draws {most + 1}: too many for so many uncertain rates; expected at most {most}"),
        (1.5, "draws 1.5: expected a whole number"),
        (-1, "draws -1: expected a whole number of at least 0"),
    ):
        monitor = Monitor(robot)
        with pytest.raises(RobophmError, match=says):
            monitor.report(draws=wrong)
        with pytest.raises(RobophmError, match=says):
            task_report(monitor.plant, monitor.exposure, monitor.ledger, Plan((Task.plain(1.0, 1.0),)), draws=wrong)
