"""The entries of the library: what one is, the reader of their files, and all that are there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

from robophm.core.errors import DesignError, PlugError, nearest
from robophm.core.registry import entry_points
from robophm.core.yaml_values import Lines, located, values

FIGURES = ("rate", "mtbf", "mttf", "l10", "b10")
"""Keys by which a design states how often a part fails; a mode has one of them, or a hazard model, or a life."""

GRADES: Mapping[str, str] = {
    "A": "a maker's statement about a part of this kind",
    "B": "a handbook or a standard, or a maker's figure converted by a stated rule",
    "C": "an estimate, with its reasoning",
}
"""The grades of an entry's source, from best to worst."""

_OF_A_MODE = (*FIGURES, "hazard", "life", "clock", "scaling", "acceleration", "uncertainty", "source")
_KEYS = ("title", "words", "grade", "statement", "source", "reasoning", "part")
_NEEDED = tuple(key for key in _KEYS if key != "reasoning")
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")
_GROUP = "robophm.parts"
_ORIGIN = "library: "
_GRADED = re.compile(rf"(?:^|; ){_ORIGIN}([a-z0-9_]+, grade [ABC]): ")

Place = tuple[str, ...]


@dataclass(frozen=True)
class Entry:
    """One kind of part in the library, as its file has it."""

    name: str
    kind: str
    """The name of its file: bearings, lidars …"""
    title: str
    words: tuple[str, ...]
    """Words that people type who look for it; the first are closest."""
    grade: str
    """A, B or C: see ``GRADES``."""
    statement: str
    """The figure as its source has it, with unit and condition."""
    source: str
    reasoning: str
    """Reasoning by which the figures follow from the statement; "" where they are what it says."""
    part: Mapping[str, Any]
    """A component as a design file has it, ready for its schema; its environment is where the robot states none."""

    @property
    def origin(self) -> str:
        """Return the source of its rate as a design that takes the entry states it."""
        return self.graded_origin(self.grade)

    def graded_origin(self, grade: str) -> str:
        """Return the same of a rate that follows from the entry's by a rule, and has a grade of its own."""
        return f"{_ORIGIN}{self.name}, grade {grade}: {self.source}"


def graded(source: str) -> str:
    """Return the entry and grade of a rate's source, "lidar_2d, grade A"; "" where it is not of the library."""
    found = _GRADED.search(source)
    return found[1] if found else ""


@cache
def library() -> Mapping[str, Entry]:
    """Return all entries by name, kinds and then names in the order of the alphabet.

    Raises DesignError with file and line for what is wrong in one, PlugError where somebody's package cannot be had.
    """
    found: dict[str, Entry] = {}
    homes: dict[str, str] = {}
    for folder in _folders():
        for file in folder.iterdir():
            if not file.name.endswith(".yaml"):
                continue
            for entry in read_entries(file.read_text(encoding="utf-8"), str(file), file.name.removesuffix(".yaml")):
                if entry.name in found:
                    raise DesignError(f"{file}: '{entry.name}' is in {homes[entry.name]} too; expected another name")
                found[entry.name], homes[entry.name] = entry, str(file)
    return {entry.name: entry for entry in sorted(found.values(), key=lambda one: (one.kind, one.name))}


def _folders() -> Iterator[Traversable]:
    """The folders of files of entries: our own, then those of other packages."""
    yield files("robophm.parts") / "library"
    for point in entry_points(group=_GROUP):
        try:
            yield files(point.load())
        except (ImportError, TypeError) as error:
            raise PlugError(f"parts of '{point.name}' ({point.value}) cannot be had: {error}") from error


def read_entries(text: str, file: str, kind: str) -> Iterator[Entry]:
    """Yield the entries of one file, checked key by key. Raises DesignError with the line of the first fault."""
    data, lines = values(text, file)
    reader = _Reader(file, lines)
    for name, said in reader.mapping((), data).items():
        yield reader.entry(name, said, kind)


class _Reader:
    def __init__(self, file: str, lines: Lines) -> None:
        self.file, self.lines = file, lines

    def entry(self, name: str, said: Any, kind: str) -> Entry:
        if not _NAME.fullmatch(name):
            raise self.wrong((name,), "is no name of an entry; expected lower case with underscores, e.g. ball_bearing")
        self.keys((name,), said, _KEYS, needed=_NEEDED)
        text = {key: self.text((name, key), said[key]) for key in ("title", "grade", "statement", "source")}
        if text["grade"] not in GRADES:
            raise self.wrong((name, "grade"), f"'{text['grade']}'; expected one of {', '.join(GRADES)}")
        reasoning = self.text((name, "reasoning"), said["reasoning"]) if "reasoning" in said else ""
        if text["grade"] == "C" and not reasoning:
            raise self.wrong((name,), "needs 'reasoning': it is an estimate")
        return Entry(
            name=name, kind=kind, words=self.words((name, "words"), said["words"]), reasoning=reasoning,
            part=self.component((name, "part"), said["part"]), **text,
        )  # fmt: skip

    def words(self, place: Place, said: Any) -> tuple[str, ...]:
        if not isinstance(said, list) or not said:
            raise self.wrong(place, "expected a list of what people type")
        return tuple(self.text((*place, str(i)), word) for i, word in enumerate(said))

    def component(self, place: Place, said: Any) -> dict[str, Any]:
        """A component with one statement of its rate, or with failure modes that have one each."""
        if "failure_modes" not in self.mapping(place, said):
            return self.mode(place, said, ("environment",))
        self.keys(place, said, ("failure_modes", "uncertainty", "environment"))
        for name, mode in self.mapping((*place, "failure_modes"), said["failure_modes"]).items():
            self.mode((*place, "failure_modes", name), mode)
        return dict(said)

    def mode(self, place: Place, said: Any, more: tuple[str, ...] = ()) -> dict[str, Any]:
        self.keys(place, said, (*_OF_A_MODE, *more))
        if len(said.keys() & {*FIGURES, "hazard"}) != 1:
            raise self.wrong(place, f"expected exactly one of {', '.join(FIGURES)}, hazard")
        return dict(said)

    def keys(self, place: Place, said: Any, known: tuple[str, ...], needed: tuple[str, ...] = ()) -> None:
        for key in self.mapping(place, said):
            if key not in known:
                raise self.wrong((*place, key), f"unknown key '{key}'{nearest(key, known)}")
        for key in needed:
            if key not in said:
                raise self.wrong(place, f"needs '{key}'")

    def mapping(self, place: Place, said: Any) -> dict[str, Any]:
        if not isinstance(said, dict) or not said:
            raise self.wrong(place, f"expected keys with values, not {said!r:.60}")
        return said

    def text(self, place: Place, said: Any) -> str:
        if not isinstance(said, str) or not said.strip():
            raise self.wrong(place, f"{said!r:.60}; expected text, in quotes where it looks like a number")
        return " ".join(said.split())

    def wrong(self, place: Place, message: str) -> DesignError:
        return DesignError(located(self.file, self.lines, place, message))
