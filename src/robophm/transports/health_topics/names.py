"""Names of topics, made of paths in the design in letters that ROS takes."""

from __future__ import annotations

import re
from collections.abc import Iterable


def topics_of(paths: Iterable[str], root: str, others: Iterable[str] = ()) -> dict[str, str]:
    """Return a topic for each path: ``root/power/battery_control_board`` for ``Power/Battery Control Board``.

    Paths that would have the same topic, or one that is of ``others``, are numbered in their order.
    """
    found: dict[str, str] = {}
    taken = {*others}
    for path in paths:
        plain = "/".join([root, *map(_step, path.split("/"))])
        topic, number = plain, 1
        while topic in taken:
            number += 1
            topic = f"{plain}_{number}"
        taken.add(topic)
        found[path] = topic
    return found


def _step(name: str) -> str:
    """A name as one step of a topic: letters, digits and single underscores, a letter first."""
    plain = re.sub("[^a-z0-9]+", "_", name.lower()).strip("_")
    return plain if plain[:1].isalpha() else f"n{plain}"
