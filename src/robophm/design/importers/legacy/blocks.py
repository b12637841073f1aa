"""The contents of a file of the 2020 tool: blocks with their groups and drawings, and what is odd in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from robophm.design.importers.legacy.figures import parallel_rate, series_rate
from robophm.design.naming import LONGEST_NAME, design_names, printable

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
        """Return the finding as a sentence for people."""
        return f"line {self.line}: {self.place}: {self.text}"


@dataclass
class Group:
    """A group of members in series or in parallel, as the 2020 tool names them: s1, p1 …"""

    name: str
    serial: bool
    items: list[str]
    stored: float | None
    line: int

    def roll_up(self, rates: Iterable[float]) -> float:
        """Return that tool's rate of the group from its items' rates [1/h]."""
        return series_rate(rates) if self.serial else parallel_rate(list(rates))


@dataclass
class Drawing:
    """Members in series or in parallel; a member by its name in the file."""

    kind: Literal["series", "parallel"]
    blocks: list[str | Drawing]

    def parts(self) -> int:
        """Return how many of its blocks are members themselves."""
        return sum(isinstance(block, str) for block in self.blocks)


@dataclass
class Block:
    """The system, a module, a sub-module or a component."""

    place: str
    line: int
    name: str
    """Name of the block in the design."""
    stored: float | None = None
    rolled_up: float = 0.0
    formula: str = ""
    members: dict[str, Block] = field(default_factory=dict)
    drawing: Drawing | None = None
    """Drawing of the members that have a rate."""
    drawn_from: str = ""
    findings: list[Finding] = field(default_factory=list)

    @property
    def fails(self) -> bool:
        """Whether it has a place in the design: as a level that is drawn, or as a component with a rate."""
        return self.drawing is not None or bool(self.stored)

    def note(self, kind: Kind, text: str, line: int | None = None) -> None:
        """Record a finding: what is odd, and where."""
        self.findings.append(Finding(kind, self.place, line or self.line, printable(text)))

    def all_findings(self) -> Iterator[Finding]:
        """Yield its own findings, then those of all blocks below it."""
        yield from self.findings
        for member in self.members.values():
            yield from member.all_findings()


def rename(members: Mapping[str, Block]) -> None:
    """Give members names that a design may have, each another."""
    for name, new in design_names(members).items():
        members[name].name = new
        if new != name:
            text = f"is '{new}' in the design, whose names hold no / [ ] and at most {LONGEST_NAME} letters"
            members[name].note("renamed", text)


def several(names: list[str]) -> str:
    """Names for people; of many the first five."""
    more = f" and {len(names) - 5} more" if len(names) > 5 else ""
    return ", ".join(f"'{name}'" for name in names[:5]) + more
