"""The robot of a design that is no valid one yet, for its drawing: what is wrong stands in it without its rate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robophm.core.errors import DesignError
from robophm.design.file import mapping
from robophm.design.problems import built
from robophm.design.robot import UNKNOWN, Robot

MOST_ROUNDS = 20
"""Times that a design is built without what was wrong the time before."""

_DRAWN = ("modules", "components", "diagram", "quantity", "required", "depends_on")
"""Keys that say what is drawn, and are never left out."""

NAMELESS = "robot"
"""Name under which a robot without a name is drawn."""

_NEEDED = (*_DRAWN, "name", "schema_version")


def drawable(text: str) -> Robot | None:
    """Return the robot of a text to be drawn, parts that are wrong of unknown rate; None where it cannot be drawn."""
    try:
        document, lines = mapping(text, "design", "design")
    except DesignError:
        return None
    for _ in range(MOST_ROUNDS):
        robot, wrong = built(document, lines)
        if robot:
            return robot
        changed = [_left_out(document, one.place) for one in wrong]
        if not any(changed):
            return None
    return None


def _left_out(document: dict[str, Any], place: Sequence[str]) -> bool:
    """Leave out what is wrong; whether that is possible and had not been done before."""
    here: Any = document
    for n, key in enumerate(place):
        if n and place[n - 1] == "components" and key in here:
            stated = here[key] if isinstance(here[key], dict) else {}
            drawn = {one: value for one, value in stated.items() if one in _DRAWN and one not in place[n:]}
            bare = {**drawn, "rate": UNKNOWN}
            changed = here[key] != bare
            here[key] = bare
            return bool(changed)
        if not n and key == "name" and here.get(key) != NAMELESS:
            here[key] = NAMELESS
            return True
        if n and place[n - 1] == "modules" and not isinstance(here.get(key), dict):
            here[key] = {}
            return True
        if key in _DRAWN[:2] or (n and place[n - 1] == "modules"):
            here = here.get(key)
        elif key in here and key not in _NEEDED:
            del here[key]
            return True
        else:
            return False
        if not isinstance(here, dict):
            return False
    return False
