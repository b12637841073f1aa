"""A robot's health as topics of ROS, of either generation: the sink, its messages and their names.

``sink.py`` decides what is published when, ``report_fields.py`` puts a report's figures into fields of
diagnostic_msgs/DiagnosticArray, phm_msgs/Health and the others, ``message_of_fields.py`` makes messages of such fields,
``definitions.py`` knows the types of phm_msgs (ros/phm_msgs), ``names.py`` makes topics of paths, ``outlet.py`` has the
publishers and services. ``task_service.py`` answers a robot that asks before it goes, ``part_reports.py`` takes what it
tells of its parts, ``parameters.py`` what may be changed meanwhile, ``recording.py`` is an outlet to a file.
"""

from __future__ import annotations

from robophm.transports.health_topics.outlet import Outlet
from robophm.transports.health_topics.parameters import Parameter, ParameterServices
from robophm.transports.health_topics.part_reports import PartReports
from robophm.transports.health_topics.recording import HealthRecording
from robophm.transports.health_topics.sink import HealthTopics
from robophm.transports.health_topics.task_service import TaskService

__all__ = ["HealthRecording", "HealthTopics", "Outlet", "Parameter", "ParameterServices", "PartReports", "TaskService"]
