"""Tasks that robots tell of: what is planned, and what was done.

Read are the three topics of the 2020 tool, std_msgs/String with a list in it, found by the last step of their name:

    robot_task_list               [[x, y, speed], …]   m, m/s: a task that is planned
    task_time                     [t, …]               s: the times of the legs of a task that is done
    task_position, task_positions [[x, y], …]          m: where it led, one place more than there are times

Orders of VDA 5050 (``orders.py``), goals of navigation (``goals.py``), nav_msgs/Path, a planned task, and the poses of
a robot, one done task. Distances are in the plane, as are those of the kilometres clock.
"""

from __future__ import annotations

from robophm.transports.tasks.listener import LONGEST_MESSAGE, TaskTopics
from robophm.transports.tasks.recorded import LONGEST_SILENCE, driven_task, tasks_of, told_by
from robophm.transports.tasks.texts import TEXT_TOPICS, TaskListener
from robophm.transports.tasks.told import DoneLeg, DoneTask, PlannedLeg, PlannedTask

__all__ = [
    "LONGEST_MESSAGE",
    "LONGEST_SILENCE",
    "TEXT_TOPICS",
    "DoneLeg",
    "DoneTask",
    "PlannedLeg",
    "PlannedTask",
    "TaskListener",
    "TaskTopics",
    "driven_task",
    "tasks_of",
    "told_by",
]
