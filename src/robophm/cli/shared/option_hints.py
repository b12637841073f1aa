"""Options named on stderr: an error or a note speaks of what it asks for, and the commands add how it is given.

So nobody who imports robophm, or looks at its page, is told of an option of the command line.
"""

from __future__ import annotations

OPTIONS = {
    "an estimate by simulation": "an estimate by simulation (--monte-carlo of show or fault-tree)",
    "expected one, or the name of the top gate": "expected one, or --top",
    "expected a mission time": "expected --at",
    "expected the mission time": "expected it as --at",
    "or another topic": "or --topic",
    "ask for ROS 2": "ask for ROS 2 (--via ros2)",
    "unless values hold for longer": "unless --gap is longer",
    "as with fewer levels": "as with fewer levels (--bins)",
    "expected a robot with a past": "expected a robot with a past (--store, or --at)",
    "expected one, or the robot's usual speed": "expected one, e.g. --speed 0.3",
    "expected a user first": "expected a user first (`robophm users add`)",
    "columns they are in a mapping file": "columns they are in a mapping file (import-bom --mapping)",
    "expected a fit by likelihood": "expected --by likelihood",
    "or repaired systems with their power law": "or --repairable for repaired systems",
    "or an exponential distribution": "or --distribution exponential",
    "expected another distribution": "expected another --distribution",
    "a fit with parts that never fail says": "--some-never-fail says",
    "expected a stress of use": "expected --use STRESS=VALUE",
    "expected its threshold": "expected --threshold",
    "and the load at which readings are compared": "and --load, the load at which readings are compared",
    "expected one for each setting": "expected one for each of --settings",
    "cannot be told of alarms": "cannot be told of alarms (--notify)",
    "whose nodes do not speak DDS": "whose nodes do not speak DDS: --via zenoh",
    "no such store": "no such store; `robophm replay --store` makes it",
}
"""Words of the rooms below, each with the same words that name the option which a command has for it."""


def with_options(text: str) -> str:
    """Return an error or a note with the options of the command line that give what it asks for."""
    for words, named in OPTIONS.items():
        text = text.replace(words, named)
    return text
