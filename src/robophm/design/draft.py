"""A design that is drafted from evidence: parts with why they are there, written with a remark and a stamp each.

The stamp, at the end of a part's ``description``, is how a later draft notices that somebody has edited the part, which
is then theirs.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from robophm.design.naming import quoted
from robophm.parts import part as entry_of

STAMP = re.compile(r"; drafted ([0-9a-f]{8})$")


@dataclass(frozen=True)
class DraftPart:
    """A part that a robot is taken to have."""

    module: str
    name: str
    entry: str
    """The name of the entry of the library of parts that it is."""
    seen: str
    """The evidence that the robot has this part, in words: a joint, a link, a topic or an answer."""
    assumed: str = ""
    """The assumption that was made about this part, in words; "" where none was."""
    joint: str = ""
    """The joint that it moves, if it does."""
    effort: float | None = None
    """The largest torque [N·m] or force [N] that this joint may be driven with; None where it is not known."""
    velocity: float | None = None
    """The largest speed [rad/s or m/s] of this joint; None where it is not known."""
    keys: Mapping[str, Any] = field(default_factory=dict)
    """Further keys of the component: quantity, signals, clocks."""

    @property
    def path(self) -> str:
        """The path of this part in the design: the names of its module and itself, with / between them."""
        return f"{self.module}/{self.name}"

    def content(self) -> dict[str, Any]:
        """The component as a design has it, with its stamp."""
        said = {"part": self.entry, **self.keys}
        return {**said, "description": f"{self.seen}; drafted {stamp(said)}"}


ASSUMED_USAGE = {"kilometres": "1 km/h", "cycles": "10 cycle/h", "starts": "1 start/h"}
"""The progress of each clock in an hour of operation that is assumed where nothing states it."""


def assumed_usage(parts: Iterable[DraftPart]) -> dict[str, str]:
    """The assumed progress of each clock that these parts age by, in an hour of operation, as a design states usage."""
    modes = [
        mode
        for one in parts
        for said in (entry_of(one.entry).part,)
        for mode in (said, *said.get("failure_modes", {}).values())
    ]
    used = {mode.get("clock") for mode in modes}
    return {clock: pace for clock, pace in ASSUMED_USAGE.items() if clock in used}


def stamp(said: Mapping[str, Any]) -> str:
    """Eight digits of what a component says, less its description, whatever way it is written."""
    plain = json.dumps(_plain({key: value for key, value in said.items() if key != "description"}), sort_keys=True)
    return hashlib.sha256(plain.encode()).hexdigest()[:8]


def untouched(said: Mapping[str, Any]) -> bool:
    """Whether a component is as a draft wrote it."""
    found = STAMP.search(str(said.get("description", "")))
    return found is not None and found[1] == stamp(said)


def drafted(said: Mapping[str, Any]) -> bool:
    """Whether a draft wrote a component, whoever edited it since."""
    return STAMP.search(str(said.get("description", ""))) is not None


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else inline(value).strip('"')


def design_text(head: Iterable[str], robot: Mapping[str, Any], parts: Iterable[DraftPart]) -> str:
    """The text of a design: remarks at its head, keys of the robot, and its modules with their parts."""
    lines = [f"# {line}".rstrip() for line in head]
    for key, value in {"schema_version": 1, **robot}.items():
        own = key in ("schema_version", "name")
        lines.append(f"{quoted(key)}: {inline(value)}" + ("" if own else f"  # drafted {stamp({'value': value})}"))
    lines.append("modules:")
    modules: dict[str, list[DraftPart]] = {}
    for one in parts:
        modules.setdefault(one.module, []).append(one)
    for module, inside in modules.items():
        lines += module_lines(module, inside)
    return "\n".join(lines) + "\n"


def module_lines(module: str, parts: Iterable[DraftPart]) -> Iterator[str]:
    """A module of a draft."""
    yield f"  {quoted(module)}:"
    yield "    components:"
    for one in parts:
        yield from part_lines(one, " " * 6)


def part_lines(one: DraftPart, pad: str) -> Iterator[str]:
    """A component of a draft, with what it is in words."""
    entry = entry_of(one.entry)
    yield f"{pad}{quoted(one.name)}:"
    yield f"{pad}  part: {one.entry}  # {entry.title}, grade {entry.grade}"
    if one.assumed:
        yield f"{pad}  # assumed: {one.assumed}"
    for key, value in one.content().items():
        if key != "part":
            yield from key_lines(key, value, pad + "  ")


def key_lines(key: str, value: Any, pad: str) -> Iterator[str]:
    """A key with its value; what is under ``signals`` and ``clocks`` has a line for each."""
    if key in ("signals", "clocks") and isinstance(value, Mapping):
        yield f"{pad}{key}:"
        for name, binding in value.items():
            yield f"{pad}  {quoted(name)}: {inline(binding)}"
    else:
        yield f"{pad}{quoted(key)}: {inline(value)}"


def inline(value: Any) -> str:
    """A value as YAML writes it on one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{quoted(str(key))}: {inline(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(inline, value)) + "]"
    return quoted(value) if isinstance(value, str) else f"{value:.10g}" if isinstance(value, float) else str(value)
