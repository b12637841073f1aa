"""The 2020 tool's file (phm_configurations_*.yaml, last_configurations.yaml) → a design; what is odd in it is said.

That file nests System > module > sub-module > component as mappings in which names stand among keys. Groups (s1, p1 …)
wire the members of a level; its "Final Configuration" names the group, or the one member, that counts.
"""

from __future__ import annotations

import math
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NoReturn

from robophm.core.errors import DesignError
from robophm.design.file import Lines, parse, read, values
from robophm.design.legacy import parallel_rate, series_rate
from robophm.design.robot import Robot

MAX_CHARACTERS = 500_000
"""Of such a file; its own example has 13,000."""

MAX_NESTING = 40
"""Groups within groups."""

MAX_DRAWN = 100_000
"""Blocks in all diagrams together: groups that share groups can unfold to billions."""

HIGHEST_RATE = 1e6
"""[1/h]"""

LONGEST_NAME = 180
"""In the design."""

_LEVEL_KEYS = frozenset({"Configurations", "Failure Rate", "Final Configuration", "Reliability"})
_COMPONENT_KEYS = frozenset({"Elements", "Failure Rate", "Final Configuration", "Formula"})
_GROUP_KEYS = frozenset({"Configuration Count", "Depth Level"})
_RESERVED = _LEVEL_KEYS | _COMPONENT_KEYS | _GROUP_KEYS
_KINDS = ("the system", "a module", "a sub-module", "a component")

Kind = Literal[
    "double use",  # of one part; the 2020 tool counts it as often as it is used
    "unused",  # by what counts: no failure of it does
    "no rate",  # or zero: left out (ADR 0010)
    "unknown name",  # in a group, or as what counts
    "other rate",  # than the roll-up of the rates below
    "candidates",  # several groups that could be what counts
    "not wired",  # nothing is said to count
    "renamed",
    "ignored",
]


@dataclass(frozen=True)
class Finding:
    """Something odd in a file of the 2020 tool, and what the design makes of it."""

    kind: Kind
    place: str
    """Names from the system down, as that file has them."""
    line: int
    text: str

    def __str__(self) -> str:
        """For people."""
        return f"line {self.line}: {self.place}: {self.text}"


@dataclass(frozen=True)
class LegacyFigure:
    """The 2020 tool's failure rate of the system (empty path) or of a module, by its path in the design [1/h]."""

    path: str
    stored: float | None
    """As the file has it."""
    recomputed: float
    """Rolled up from the components' rates by that tool's rules, double use and redundancy as it counts them."""


@dataclass(frozen=True)
class Imported:
    """A design made of a file of the 2020 tool."""

    text: str
    """The design file."""
    findings: tuple[Finding, ...]
    figures: tuple[LegacyFigure, ...]
    robot: Robot
    """What the text describes."""


def import_legacy(path: str | os.PathLike[str]) -> Imported:
    """Make a design of a file of the 2020 tool. Formulas in it are not evaluated: their results are there.

    Raises DesignError, one line with file and line, for what is no such file, and for a rate that is none.
    """
    path = Path(path)
    root, lines = _document(path)
    if not isinstance(root, dict) or "System" not in root:
        found = f"; it has {_several(list(root))}" if isinstance(root, dict) else ""
        raise DesignError(f"{path}: has no 'System'; expected a file that the 2020 tool saved{found}")
    reader = _Reader(str(path), lines)
    system = reader.level(("System",), root["System"], 0)
    for key in sorted(root.keys() - {"System"}):
        system.note("ignored", f"the file's '{key}' is not the system")
    if system.drawing is None:
        raise DesignError(f"{path}: holds no part with a rate that counts; expected at least one")
    system.name = _name(path.stem)
    text = "\n".join(_design(system, _printable(path.name))) + "\n"
    figures = [LegacyFigure("", system.stored, system.rolled_up)]
    figures += [LegacyFigure(module.name, module.stored, module.rolled_up) for module in system.members.values()]
    return Imported(text, tuple(system.all_findings()), tuple(figures), parse(text, f"{path}, as a design"))


def _document(path: Path) -> tuple[Any, Lines]:
    """The plain values of a file, and their lines; refused where it is too large, too deep, or has aliases."""
    text = read(path)
    if len(text) > MAX_CHARACTERS:
        raise DesignError(f"{path}: has more than {MAX_CHARACTERS:,} characters; expected a file of the 2020 tool")
    if "*" in text:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError
        from ruamel.yaml.events import AliasEvent

        with suppress(YAMLError, ValueError):  # which the values say better
            for event in YAML(typ="safe", pure=True).parse(text):
                if isinstance(event, AliasEvent):
                    line = event.start_mark.line + 1
                    raise DesignError(f"{path}:{line}: alias '*{event.anchor}' is not taken; expected plain values")
    return values(text, str(path))


@dataclass
class _Group:
    """s1, p1 …"""

    name: str
    serial: bool
    items: list[str]
    stored: float | None
    line: int

    def roll_up(self, rates: Iterable[float]) -> float:
        return series_rate(rates) if self.serial else parallel_rate(list(rates))


@dataclass
class _Drawing:
    """Members in series or in parallel; a member by its name in the file."""

    kind: Literal["series", "parallel"]
    blocks: list[str | _Drawing]

    def parts(self) -> int:
        """How many of its blocks are members themselves."""
        return sum(isinstance(block, str) for block in self.blocks)


@dataclass
class _Block:
    """The system, a module, a sub-module or a component."""

    place: str
    line: int
    name: str
    """In the design."""
    stored: float | None = None
    rolled_up: float = 0.0
    formula: str = ""
    members: dict[str, _Block] = field(default_factory=dict)
    drawing: _Drawing | None = None
    """Of its members that have a rate."""
    drawn_from: str = ""
    findings: list[Finding] = field(default_factory=list)

    @property
    def fails(self) -> bool:
        """Whether it has a place in the design: as a level that is drawn, or as a component with a rate."""
        return self.drawing is not None or bool(self.stored)

    def note(self, kind: Kind, text: str, line: int | None = None) -> None:
        self.findings.append(Finding(kind, self.place, line or self.line, _printable(text)))

    def all_findings(self) -> Iterator[Finding]:
        yield from self.findings
        for member in self.members.values():
            yield from member.all_findings()


class _Reader:
    """From the values of a file to blocks."""

    def __init__(self, file: str, lines: Lines) -> None:
        self.file = file
        self.lines = lines
        self.drawn = 0

    def fail(self, place: tuple[str, ...], message: str) -> NoReturn:
        known = next(place[:n] for n in range(len(place), -1, -1) if place[:n] in self.lines)
        raise DesignError(f"{self.file}:{self.lines[known]}: {'/'.join(place)}: {message}")

    def level(self, place: tuple[str, ...], value: object, depth: int) -> _Block:
        """What a mapping of the file describes, with all below it."""
        data = self.mapping(place, value, f"{_KINDS[depth]} with its 'Failure Rate'")
        for key in sorted(data.keys() & _RESERVED) if depth < 3 else ():
            if isinstance(data[key], dict) and data[key].keys() & (_LEVEL_KEYS | _COMPONENT_KEYS):
                self.fail(
                    (*place, key), f"a part named '{key}', which is a key of the 2020 tool; expected another name"
                )
        block = _Block("/".join(_printable(step) for step in place[1:]) or "System", self.lines[place], "")
        block.stored = self.rate((*place, "Failure Rate"), data.get("Failure Rate"))
        names = [key for key in data if key not in _RESERVED]
        if depth == 3:
            block.formula = _printable(str(data.get("Formula") or ""))
            for name in names:
                block.note("ignored", f"'{name}' is below a component", self.lines[(*place, name)])
        else:
            block.members = {name: self.level((*place, name), data[name], depth + 1) for name in names}
            _rename(block.members)
            self.wire(block, place, data)
        if not block.members:
            block.rolled_up = block.stored or 0.0
        without = "no part with a rate that counts" if block.members else "no rate"
        if depth and not block.fails:
            said = without if block.members or block.stored is None else "the rate 0"
            block.note("no rate", f"has {said}; left out: a part that never fails is none, so state its rate")
        elif depth and block.members and block.drawing is None:
            block.note("no rate", f"has {without}; it is drawn as one part with its own rate")
        return block

    def mapping(self, place: tuple[str, ...], value: object, expected: str) -> Mapping[str, Any]:
        if not isinstance(value, dict):
            self.fail(place, f"{value!r:.60} is not {expected}; expected a mapping")
        return value

    def rate(self, place: tuple[str, ...], value: object) -> float | None:
        """[1/h]; None where that tool has none."""
        if isinstance(value, dict):
            place, value = (*place, "Nominal"), value.get("Nominal")
        if value in (None, "", "None"):
            return None
        number = math.nan
        if isinstance(value, str | int | float) and not isinstance(value, bool):
            with suppress(ValueError, OverflowError):
                number = float(value)
        if not 0 <= number <= HIGHEST_RATE:
            self.fail(place, f"{value!r:.60} is not a rate per hour; expected a number from 0 to {HIGHEST_RATE:g}")
        return number

    def groups(self, place: tuple[str, ...], value: object) -> dict[str, _Group]:
        """The groups of a level by name."""
        groups = {}
        for name, given in self.mapping(place, value or {}, "the groups of a level").items():
            if name in _GROUP_KEYS:
                continue
            at = (*place, name)
            data = self.mapping(at, given, "a group with its 'Components'")
            kind, items = data.get("Type"), data.get("Components")
            if kind not in ("Serial", "Parallel"):
                self.fail((*at, "Type"), f"{kind!r:.60} is no type of group; expected Serial or Parallel")
            if not isinstance(items, list) or any(isinstance(item, dict | list) for item in items):
                self.fail((*at, "Components"), "expected a list of names")
            rate = self.rate((*at, "Failure Rate"), data.get("Failure Rate"))
            groups[name] = _Group(name, kind == "Serial", [str(item) for item in items], rate, self.lines[at])
        return groups

    def wire(self, block: _Block, place: tuple[str, ...], data: Mapping[str, Any]) -> None:
        """Draw a level as its file says, and compare the rates that it says."""
        groups = self.groups((*place, "Configurations"), data.get("Configurations"))
        wiring = _Wiring(self, place, block, groups)
        final = data.get("Final Configuration") or ""
        if isinstance(final, dict | list):
            self.fail((*place, "Final Configuration"), "expected the name of a group or member")
        chosen = str(final)
        rates = {name: wiring.rolled_up(name) for name in groups}
        wiring.check()
        within = {item for group in groups.values() for item in group.items}
        outermost = [name for name in groups if name not in within]
        counts = chosen in groups or chosen in block.members
        if counts:
            others = [name for name in outermost if name != chosen]
            if others:
                block.note("candidates", f"{chosen} counts and is drawn; {_several(others)} could be what counts too")
            block.rolled_up = rates[chosen] if chosen in groups else block.members[chosen].rolled_up
            self.compare(block, chosen, groups)
        else:
            block.rolled_up = block.stored or 0.0
            if chosen:
                block.note("unknown name", f"'{chosen}' is to count, and there is none")
            chosen = outermost[0] if len(outermost) == 1 else ""
            drawn = f"{chosen}, its only outermost group, is drawn" if chosen else "all its members are drawn in series"
            said = f"so the 2020 tool counts {block.rolled_up:g} /h"
            if len(outermost) > 1:
                block.note("candidates", f"none of {_several(outermost)} is chosen, {said}; {drawn}")
            elif block.members:
                block.note("not wired", f"nothing in it is chosen, {said}; {drawn}")
        wiring.draw(chosen)

    def compare(self, block: _Block, chosen: str, groups: Mapping[str, _Group]) -> None:
        """Say where a rate in the file is not what its rates below give."""
        stored = {name: member.stored for name, member in block.members.items()}
        stored |= {name: group.stored for name, group in groups.items()}
        for group in groups.values():
            rates = [rate for item in group.items if (rate := stored.get(item)) is not None]
            self.differ(block, group.name, group.stored, group.roll_up(rates), group.line)
        self.differ(block, "it", block.stored, stored[chosen], block.line)

    def differ(self, block: _Block, what: str, said: float | None, below: float | None, line: int) -> None:
        if said is not None and below is not None and not math.isclose(said, below, rel_tol=1e-9):
            block.note("other rate", f"{what} has {said:g} /h in the file, what is below it gives {below:g} /h", line)


class _Wiring:
    """The groups of one level."""

    def __init__(self, reader: _Reader, place: tuple[str, ...], block: _Block, groups: Mapping[str, _Group]) -> None:
        self.reader = reader
        self.place = place
        self.block = block
        self.groups = groups
        self.rates: dict[str, float] = {}
        self.depths: Counter[str] = Counter()
        self.uses: Counter[str] = Counter()
        self.lost: dict[tuple[str, str], int] = {}
        self.under_way: list[str] = []

    def check(self) -> None:
        """Say which names are odd."""
        block, members, groups = self.block, self.block.members, self.groups
        for group in groups.values():
            counts = Counter(group.items)
            known = [name for name in counts if name in groups or name in members]
            unknown = counts.keys() - set(known)
            if unknown:
                block.note("unknown name", f"{group.name} names {_several(sorted(unknown))}, left out here", group.line)
            doubled = [name for name in known if counts[name] > 1]
            if doubled:
                often = group.roll_up([self.rolled_up(name) for name in counts.elements() if name not in unknown])
                once = group.roll_up(map(self.rolled_up, known))
                text = f"{group.name} names {_several(doubled)} more than once; it is one part, drawn once"
                said = f"the 2020 tool makes {often:.5g} /h of it instead of {once:.5g} /h"
                block.note("double use", f"{text}, but {said}", group.line)
        for name in sorted(groups.keys() & members.keys()):
            block.note("ignored", f"{name} is a group and a member; the group is meant, as in the 2020 tool")

    def rolled_up(self, name: str) -> float:
        """That tool's rate of a group or member, from the components up. Raises DesignError for a circle."""
        if name not in self.groups:
            return self.block.members[name].rolled_up
        if name in self.under_way:
            circle = " → ".join([*self.under_way[self.under_way.index(name) :], name])
            self.reader.fail((*self.place, "Configurations", name), f"cycle: {circle} contains itself")
        if name not in self.rates:
            group = self.groups[name]
            self.under_way.append(name)
            known = [item for item in group.items if item in self.groups or item in self.block.members]
            if len(self.under_way) <= MAX_NESTING:
                self.rates[name] = group.roll_up([self.rolled_up(item) for item in known])
                self.depths[name] = 1 + max((self.depths[item] for item in known), default=0)
            if self.depths[name] > MAX_NESTING or len(self.under_way) > MAX_NESTING:
                self.reader.fail((*self.place, "Configurations", name), f"is nested more than {MAX_NESTING} deep")
            self.under_way.pop()
        return self.rates[name]

    def draw(self, chosen: str) -> None:
        """Draw what counts, or all in series where nothing is chosen."""
        block = self.block
        if chosen:
            used = self.used(chosen, set())
            for name, member in block.members.items():
                if name not in used or name in self.groups:
                    member.note("unused", f"is not in {chosen}, which is drawn; its failures count for nothing")
            drawing = self.drawing(chosen)
            block.drawing = _Drawing("series", [drawing]) if isinstance(drawing, str) else drawing
            group = self.groups.get(chosen)
            block.drawn_from = f"{chosen}, line {group.line}" if group else f"{chosen} alone"
        else:
            parts: list[str | _Drawing] = [name for name, member in block.members.items() if member.fails]
            block.drawing = _Drawing("series", parts) if parts else None
        for (name, item), line in self.lost.items():
            block.note("no rate", f"{name}: '{item}' has no rate; left out, and with it the redundancy it gave", line)
        for name, count in self.uses.items():
            if count > 1:
                text = f"'{name}' stands in {count} places of {chosen}; it is one part in all"
                block.note("double use", f"{text}, the 2020 tool counts it {count} times")

    def used(self, name: str, found: set[str]) -> set[str]:
        """The names that a group reaches."""
        if name not in found:
            found.add(name)
            for item in self.groups[name].items if name in self.groups else ():
                self.used(item, found)
        return found

    def drawing(self, name: str) -> str | _Drawing | None:
        """A group or member without what has no rate; series within series are one."""
        self.reader.drawn += 1
        if self.reader.drawn > MAX_DRAWN:
            self.reader.fail((*self.place, "Configurations"), f"unfolds to more than {MAX_DRAWN:,} blocks")
        group = self.groups.get(name)
        if group is None:
            if name not in self.block.members or not self.block.members[name].fails:
                return None
            self.uses[name] += 1
            return name
        blocks: list[str | _Drawing] = []
        drawn: set[str] = set()
        for item in dict.fromkeys(group.items):
            inner = self.drawing(item)
            if inner is None:
                if not group.serial and (item in self.groups or item in self.block.members):
                    self.lost[name, item] = group.line
                continue
            merged = (
                inner.blocks if group.serial and isinstance(inner, _Drawing) and inner.kind == "series" else [inner]
            )
            blocks += [block for block in merged if not isinstance(block, str) or block not in drawn]
            drawn.update(block for block in merged if isinstance(block, str))
        return _joined("series" if group.serial else "parallel", blocks)


def _joined(kind: Literal["series", "parallel"], blocks: list[str | _Drawing]) -> str | _Drawing | None:
    return _Drawing(kind, blocks) if len(blocks) > 1 else blocks[0] if blocks else None


def _rename(members: Mapping[str, _Block]) -> None:
    """Give members names that a design may have, each another."""
    taken = {name for name in members if _name(name) == name}
    tried: Counter[str] = Counter()
    for name, member in members.items():
        member.name = new = _name(name)
        while new != name and member.name in taken:
            tried[new] += 1
            member.name = f"{new} {tried[new] + 1}"
        taken.add(member.name)
        if new != name:
            text = f"is '{member.name}' in the design, whose names hold no / [ ] and at most {LONGEST_NAME} letters"
            member.note("renamed", text)


def _name(text: str) -> str:
    """A name as near to a text as a design allows."""
    return _printable(text).translate(str.maketrans("/[]", "-()")).strip()[:LONGEST_NAME].strip() or "unnamed"


def _several(names: list[str]) -> str:
    more = f" and {len(names) - 5} more" if len(names) > 5 else ""
    return ", ".join(f"'{name}'" for name in names[:5]) + more


def _printable(text: str) -> str:
    """One line that can be written."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def _design(system: _Block, source: str) -> Iterator[str]:
    """The lines of the design file."""
    yield f"# Made of {source:.80} by `robophm import-legacy`; lines named below are that file's,"
    yield "# and so are the rates: per hour, already multiplied by quantity."
    yield from _remarks(system, "")
    yield "schema_version: 1"
    yield f"name: {_quoted(system.name)}"
    yield ""
    yield "# What the 2020 tool does with temperature: twice the rate for every 10 K above 25 °C. Bind it by"
    yield "# signals: {temperature: {topic: /power/temperature, field: temperature, unit: degC, range: [-40, 125]}}"
    yield "acceleration: {model: q10, reference_temperature: 25 degC, q: 2}"
    yield ""
    yield from _members(system, "")


def _members(level: _Block, pad: str) -> Iterator[str]:
    kept = [member for member in level.members.values() if member.fails]
    modules = [member for member in kept if member.drawing is not None]
    components = [member for member in kept if member.drawing is None]
    if modules:
        yield f"{pad}modules:"
    for module in modules:
        yield f"{pad}  {_quoted(module.name)}:  # line {module.line}"
        yield from _remarks(module, f"{pad}    ")
        yield from _members(module, f"{pad}    ")
    if components:
        yield f"{pad}components:"
    for component in components:
        yield from _remarks(component, f"{pad}  ")
        by = f", by the formula {component.formula:.100} (not evaluated)" if component.formula else ""
        yield f"{pad}  {_quoted(component.name)}: {{rate: {component.stored!r} /h}}  # line {component.line}{by}"
    for member in level.members.values():
        if not member.fails:
            yield f"{pad}# Left out: {_printable(member.place)}, line {member.line}"
            yield from _remarks(member, pad)
    drawing = level.drawing
    if drawing and not (drawing.kind == "series" and drawing.parts() == len(drawing.blocks) == len(kept)):
        names = {name: member.name for name, member in level.members.items()}
        yield f"{pad}diagram:" + (f"  # {_printable(level.drawn_from)}" if level.drawn_from else "")
        yield from _diagram(drawing, names, f"{pad}  ")


def _remarks(block: _Block, pad: str) -> Iterator[str]:
    yield from (f"{pad}# {finding.text}" for finding in block.findings)


def _diagram(drawing: _Drawing, names: Mapping[str, str], pad: str) -> Iterator[str]:
    yield f"{pad}{drawing.kind}:"
    for block in drawing.blocks:
        if isinstance(block, str):
            yield f"{pad}  - {_quoted(names[block])}"
        else:
            lines = list(_diagram(block, names, f"{pad}    "))
            yield f"{pad}  - {lines[0].strip()}"
            yield from lines[1:]


def _quoted(name: str) -> str:
    """A name as YAML writes it, in quotes where it might be taken for something else."""
    if re.fullmatch(r"[A-Za-z][\w .()+-]*", name, re.ASCII) and name.lower() not in ("true", "false", "null"):
        return name
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
