"""The honest health of a robot: from its design and its sensors, nominal and sensor-based.

>>> import robophm
>>> robot = robophm.load("robot.yaml")                                  # doctest: +SKIP
>>> health = robophm.replay(robot, "drive.mcap")                        # doctest: +SKIP
>>> health.survival_of_next(100), health.remaining_life().median        # doctest: +SKIP

docs/guides/python.md has an example of each function.
"""

from __future__ import annotations

TYPE_CHECKING = False  # that of typing takes as long to import as all else here: who asks to end then gets a traceback
if TYPE_CHECKING:
    from typing import Any

    from robophm.blocks.diagram import KOutOfN, Link, Network, Parallel, Series, Unit
    from robophm.blocks.reliability import Structure
    from robophm.core.errors import RobophmError
    from robophm.design.file import load
    from robophm.design.robot import Robot
    from robophm.design.task import Leg, Task
    from robophm.design.task_file import load_plan
    from robophm.drafting.answers import Answers
    from robophm.drafting.drafting import new
    from robophm.health.fleet import Fleet
    from robophm.health.report import HealthReport
    from robophm.interface.availability import availability
    from robophm.interface.bindings import bind
    from robophm.interface.demonstration import demonstrate
    from robophm.interface.fault_trees import cutsets, dynamic_tree, fault_tree
    from robophm.interface.faults import diagnose, fmeca
    from robophm.interface.field import learn
    from robophm.interface.handbook import models, rate
    from robophm.interface.importance import importance
    from robophm.interface.lists import import_bom, import_legacy
    from robophm.interface.lives import fit, fit_limited, fit_modes, fit_repaired, fit_stress
    from robophm.interface.outlook import predict
    from robophm.interface.plots import plot
    from robophm.interface.predictions import calibrate, simulate
    from robophm.interface.redundancy import allocate
    from robophm.interface.tables import frame, rows
    from robophm.interface.tasks import service, task, why
    from robophm.interface.upkeep import maintain
    from robophm.interface.wear import wear
    from robophm.learning.wear.worn_mode import WearOptions
    from robophm.life import life_distribution
    from robophm.monitoring.monitor import Monitor
    from robophm.monitoring.replay import replay
    from robophm.stores import open_store
    from robophm.transports.recordings.opening import open_source

__all__ = [
    "Answers",
    "Fleet",
    "HealthReport",
    "KOutOfN",
    "Leg",
    "Link",
    "Monitor",
    "Network",
    "Parallel",
    "RobophmError",
    "Robot",
    "Series",
    "Structure",
    "Task",
    "Unit",
    "WearOptions",
    "allocate",
    "availability",
    "bind",
    "calibrate",
    "cutsets",
    "demonstrate",
    "diagnose",
    "dynamic_tree",
    "fault_tree",
    "fit",
    "fit_limited",
    "fit_modes",
    "fit_repaired",
    "fit_stress",
    "fmeca",
    "frame",
    "import_bom",
    "import_legacy",
    "importance",
    "learn",
    "life_distribution",
    "load",
    "load_plan",
    "maintain",
    "models",
    "new",
    "open_source",
    "open_store",
    "plot",
    "predict",
    "rate",
    "replay",
    "rows",
    "service",
    "simulate",
    "task",
    "wear",
    "why",
]

# Where each public name lives: it is imported when it is first asked for, so that `import robophm` costs nothing.
_HOMES = {
    "blocks.diagram": ("KOutOfN", "Link", "Network", "Parallel", "Series", "Unit"),
    "blocks.reliability": ("Structure",),
    "core.errors": ("RobophmError",),
    "design.file": ("load",),
    "design.robot": ("Robot",),
    "design.task": ("Leg", "Task"),
    "design.task_file": ("load_plan",),
    "drafting.answers": ("Answers",),
    "drafting.drafting": ("new",),
    "health.fleet": ("Fleet",),
    "health.report": ("HealthReport",),
    "interface.availability": ("availability",),
    "interface.bindings": ("bind",),
    "interface.demonstration": ("demonstrate",),
    "interface.fault_trees": ("cutsets", "dynamic_tree", "fault_tree"),
    "interface.faults": ("diagnose", "fmeca"),
    "interface.field": ("learn",),
    "interface.handbook": ("models", "rate"),
    "interface.importance": ("importance",),
    "interface.lists": ("import_bom", "import_legacy"),
    "interface.lives": ("fit", "fit_limited", "fit_modes", "fit_repaired", "fit_stress"),
    "interface.outlook": ("predict",),
    "interface.plots": ("plot",),
    "interface.predictions": ("calibrate", "simulate"),
    "interface.redundancy": ("allocate",),
    "interface.tables": ("frame", "rows"),
    "interface.tasks": ("service", "task", "why"),
    "interface.upkeep": ("maintain",),
    "interface.wear": ("wear",),
    "learning.wear.worn_mode": ("WearOptions",),
    "life": ("life_distribution",),
    "monitoring.monitor": ("Monitor",),
    "monitoring.replay": ("replay",),
    "stores": ("open_store",),
    "transports.recordings.opening": ("open_source",),
}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    for home, names in _HOMES.items():
        if name in names:
            value = getattr(import_module(f"robophm.{home}"), name)
            globals()[name] = value
            return value
    from robophm.core.errors import nearest

    raise AttributeError(f"module 'robophm' has no attribute {name!r}{nearest(name, __all__)}")


def __dir__() -> list[str]:
    return sorted(__all__)
