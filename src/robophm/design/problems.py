"""A design under edit: what it holds, whether it is one yet, and all that is wrong or odd in it, each at its place."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from robophm.core.errors import DesignError
from robophm.core.yaml_values import Lines
from robophm.design.file import mapping, place_and_message
from robophm.design.located_error import LocatedError, Path
from robophm.design.robot import Robot

if TYPE_CHECKING:
    from robophm.design.known_parts import KnownParts

MOST_PROBLEMS = 500
"""The most problems that are reported of one design."""


@dataclass(frozen=True)
class Problem:
    """A mistake ("error": no robot can be made of it, or no figures given) or an oddity ("warning") at a place."""

    level: Literal["error", "warning"]
    place: Path
    message: str
    line: int | None
    column: int | None = None
    """The column of the line, from 1 on: of the key or the value, or where the text is no YAML any more."""


@dataclass(frozen=True)
class CheckResult:
    """The result of checking a text that is meant to be a design."""

    document: dict[str, Any]
    """Plain values of the text; empty where it is no YAML mapping."""
    robot: Robot | None
    """The robot that it describes; None where there is an error."""
    problems: tuple[Problem, ...]
    lines: Lines = field(default_factory=Lines, repr=False)
    """The line of each of its values."""

    @property
    def refused(self) -> bool:
        """Whether there is a robot, and an error all the same: no figures can be given for it."""
        return self.robot is not None and any(one.level == "error" for one in self.problems)


def check(text: str, known: KnownParts | None = None) -> CheckResult:
    """Check a text and return all that can be said of it; no mistake in it raises an error.

    ``known``: parts that need not be built again.
    """
    try:
        document, lines = mapping(text, "design", "design")
    except DesignError as error:
        line = str(error).removeprefix("design:").partition(":")[0]
        column = re.search(r", in column (\d+)$", str(error))
        at = int(line) if line.isdigit() else None, int(column[1]) if column else None
        return CheckResult({}, None, (Problem("error", (), _said(str(error)), *at),))
    robot, wrong = built(document, lines, known)
    odd = _odd(robot, lines) if robot else ()
    return CheckResult(document, robot, tuple([*wrong, *odd][:MOST_PROBLEMS]), lines)


def _said(text: str) -> str:
    """An error's text without the name of a file that the reader knows."""
    first, colon, rest = text.removeprefix("design:").partition(": ")
    return rest if colon and (first.isdigit() or not first) else text


def built(
    document: dict[str, Any], lines: Lines, known: KnownParts | None = None
) -> tuple[Robot | None, list[Problem]]:
    """Return the robot of a document, or the mistakes for which there is none, with lines where these are known."""
    from pydantic import ValidationError

    from robophm.design.build import build
    from robophm.design.schema import RobotFile

    try:
        return build(RobotFile.model_validate(document), document, known), []
    except ValidationError as error:
        places = [place_and_message(detail, lines, RobotFile) for detail in error.errors(include_url=False)]
    except LocatedError as fault:
        places = [(fault.place, str(fault))]
    return None, [Problem("error", place, message, *_spot(place, lines)) for place, message in dict.fromkeys(places)]


def _spot(place: Path, lines: Lines) -> tuple[int | None, int | None]:
    return lines.nearest(place) or (None, None)


def _odd(robot: Robot, lines: Lines) -> Iterator[Problem]:
    """The warnings of a design with their places, and parts that a diagram draws twice at one level."""
    by_name = {_names(place): place for place in reversed(lines)}
    for warning in robot.warnings:
        said, _, message = warning.partition(": ")
        place = by_name.get(said.partition("[")[0], tuple(said.split("/")))
        yield Problem("warning", place, message, *_spot(place, lines))
    for part in robot.all_components():
        if part.unknown:
            place = by_name.get(part.path, ())
            message = "its rate is unknown: what it is part of leaves it out, and says so"
            yield Problem("warning", place, message, *_spot(place, lines))
    from robophm.blocks.diagram import units

    for module in (robot, *robot.all_modules()):
        for name, times in Counter(units(module.wiring)).items():
            if times > 1:
                place = by_name.get(name.partition("[")[0], ())
                yield Problem("warning", place, f"drawn in {times} places; it counts as one part", *_spot(place, lines))


def _names(place: Path) -> str:
    """The path of a module or component at a place, as a robot names it; the place itself of anything else."""
    if len(place) % 2 == 0 and all(key in ("modules", "components") for key in place[::2]):
        return "/".join(place[1::2])
    return "/".join(place)
