"""The settings that may be changed of a watch that runs, as parameters of its node."""

from __future__ import annotations

from functools import partial

from robophm.monitoring.task_assessor import TaskAssessor
from robophm.transports.health_topics import HealthTopics, Parameter, TaskService
from robophm.transports.health_topics.task_service import MOST_DRAWS


def running_parameters(topics: HealthTopics, assessor: TaskAssessor, tasks: TaskService) -> list[Parameter]:
    """Return the parameters of a robot that is watched; each is as it was at the start until it is set."""
    return [
        Parameter(
            "limit", "least probability of completion for a task to be a go, where whoever asks states no limit",
            0.0, 1.0, lambda: assessor.limit, partial(setattr, assessor, "limit"),
        ),
        Parameter(
            "draws", "draws of rates and loads for the interval of such an answer, where whoever asks states none",
            1, MOST_DRAWS, lambda: tasks.draws, lambda value: setattr(tasks, "draws", int(value)), whole=True,
        ),
        Parameter(
            "publish_every", "seconds between two reports of health as topics, at least; 0: each report",
            0.0, 3600.0, lambda: topics.every, partial(setattr, topics, "every"),
        ),
    ]  # fmt: skip
