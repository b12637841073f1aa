"""Parameters of a node as the command that is run for it, for as long as the node lives."""

import ctypes
import os
import signal
import subprocess
import sys

FLAGS = ("period", "store", "journal", "record", "frame", "speed", "via", "fleet", "every", "unit", "robot", "robots")
"""Parameters that are options of ``robophm watch`` by the same name; empty is none."""

LISTS = ("tasks", "function", "notify")
"""Parameters that are lists, each entry an option of the same name."""


def command(parameters, namespace="/"):
    """The words of ``robophm watch`` for a mapping of parameters. Raises ValueError where there is no design.

    ``namespace`` is the node's own, for health to be published in unless a parameter names another.
    """
    if not parameters.get("design"):
        raise ValueError("parameter 'design' is missing; expected the path of a robot.yaml")
    words = [os.path.expanduser(parameters.get("robophm") or "robophm"), "watch", parameters["design"]]
    root = parameters.get("namespace") or namespace.rstrip("/")
    if not parameters.get("robots") and (root or not parameters.get("robot")):  # published in namespaces of their own
        words += ["--namespace", root or "/"]
    for name in FLAGS:
        value = parameters.get(name)
        if value not in (None, ""):
            words += ["--" + name, str(value)]
    if parameters.get("reports"):
        words.append("--reports")
    for name in LISTS:
        for one in parameters.get(name) or ():
            if one:
                words += ["--" + name, one]
    return words


def start(words):
    """Run a command that ends when this process does, however that ends: a node that was killed leaves no watcher."""
    return subprocess.Popen(words, preexec_fn=_ends_with(os.getpid()) if sys.platform.startswith("linux") else None)


def _ends_with(parent):
    library, set_signal_of_parents_death = ctypes.CDLL(None), 1  # prctl(2): PR_SET_PDEATHSIG

    def prepare():
        library.prctl(set_signal_of_parents_death, signal.SIGTERM)
        if os.getppid() != parent:  # it has ended already
            os._exit(1)

    return prepare
