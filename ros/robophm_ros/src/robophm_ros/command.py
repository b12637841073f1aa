"""Parameters of a node as the command that is run for it."""

import os

FLAGS = ("period", "store", "journal", "frame", "speed", "via")
"""Parameters that are options of ``robophm watch`` by the same name; empty is none."""


def command(parameters):
    """The words of ``robophm watch`` for a mapping of parameters. Raises ValueError where there is no design."""
    if not parameters.get("design"):
        raise ValueError("parameter 'design' is missing; expected the path of a robot.yaml")
    words = [os.path.expanduser(parameters.get("robophm") or "robophm"), "watch", parameters["design"]]
    words += ["--namespace", parameters.get("namespace") or "/"]
    for name in FLAGS:
        value = parameters.get(name)
        if value not in (None, ""):
            words += ["--" + name, str(value)]
    for topic in parameters.get("tasks") or ():
        if topic:
            words += ["--tasks", topic]
    return words
