"""The parts of the design that was built last: those that are stated alike, at the same place, are not built again.

A part is built of what the file says of it, of what the levels around it state, and of whether its equal parts are told
apart. All of that is in the key by which it is known, so that a design is the same whether its parts were known or not.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from robophm.design import schema
from robophm.design.located_error import Path
from robophm.design.robot import Component
from robophm.design.scope import Scope
from robophm.design.sensor_inputs import SensorCover

_INSIDE = {"modules", "components"}
_written = json.JSONEncoder(sort_keys=True, ensure_ascii=False).encode

LevelKey = tuple[object, ...]
"""All that parts take from the levels around them: place and settings of each, and the temperature there."""
PartKey = tuple[str, bool, str]
"""Name of a part in its level, whether its equal parts are told apart, and what is stated of it."""


class BuiltPart(NamedTuple):
    """A part that was built, with what else its design is to know of it."""

    component: Component
    cover: SensorCover | None
    """Sensors that may accelerate it; None where it is said not to be."""
    drivers: tuple[Path, ...]
    """Places of the signals that drive it."""
    notes: tuple[str, ...]
    """Remarks on what was assumed of it."""
    content: str
    """Everything that is stated of it, as JSON in one order."""


class KnownParts:
    """The parts of the last valid design, as many as it has: for one thread at a time."""

    def __init__(self) -> None:
        self._last: dict[LevelKey, dict[PartKey, BuiltPart]] = {}
        self._now: dict[LevelKey, dict[PartKey, BuiltPart]] = {}

    def begin(self) -> None:
        """Begin with the parts of another design."""
        self._now = {}

    def keep(self) -> None:
        """Keep the parts of the design that was begun in place of those before: it is a valid one."""
        self._last, self._now = self._now, {}

    def level(self, around: LevelKey, place: Path, said: Mapping[str, Any], scope: Scope) -> KnownLevel:
        """Return the known parts of a level of which the file says this, inside the levels ``around``."""
        key = (around, place, repr({name: value for name, value in said.items() if name not in _INSIDE}), scope.ambient)
        return KnownLevel(key, said, self._last.get(key, {}), self._now.setdefault(key, {}))


class KnownLevel:
    """The known parts of one level."""

    def __init__(
        self,
        key: LevelKey,
        said: Mapping[str, Any],
        last: Mapping[PartKey, BuiltPart],
        now: dict[PartKey, BuiltPart],
    ) -> None:
        self.key = key
        self.said = said
        """The values of the file for this level."""
        self._last, self._now = last, now

    def part(self, name: str, apart: bool, make: Callable[[], BuiltPart]) -> BuiltPart:
        """Return a part as it is known, else as it is made now."""
        key = name, apart, repr(self.said["components"][name])  # as it is written: 1, 1.0 and True are equal
        found = self._now[key] = self._last.get(key) or make()
        return found


def content_of(stated: schema.Component) -> str:
    """Return everything that is stated of a part as JSON in one order."""
    return _written(stated.model_dump(mode="json"))


def content(level: Any, parts: Callable[[Path], str], path: Path = ()) -> str:
    """Return everything that is stated of a level as JSON in one order; ``parts`` gives that of a part, by its path."""
    texts = {name: _written(value) for name, value in level.model_dump(mode="json", exclude=_INSIDE).items()}
    texts["modules"] = _object({name: content(one, parts, (*path, name)) for name, one in level.modules.items()})
    texts["components"] = _object({name: parts((*path, name)) for name in level.components})
    return _object(texts)


def _object(texts: Mapping[str, str]) -> str:
    return "{" + ", ".join(f"{_written(name)}: {texts[name]}" for name in sorted(texts)) + "}"
