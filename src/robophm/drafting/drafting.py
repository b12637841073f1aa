"""A design drafted from what there is of a robot: its URDF, its recordings, its parts lists, and a few answers."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from robophm.core.argument_checks import instance, shown
from robophm.core.argument_checks import path as given_path
from robophm.core.errors import RobophmError, nearest
from robophm.design.draft import DraftPart, assumed_usage, design_text
from robophm.design.file import parse
from robophm.design.importers.bom import import_bom
from robophm.design.importers.urdf import read_urdf
from robophm.design.naming import design_name, printable
from robophm.design.robot import Robot
from robophm.drafting.answers import Answers, Known, Question, listed, settled, share_of_day
from robophm.drafting.bindings import Proposal, proposals
from robophm.drafting.composing import Change, composed, left_to_others
from robophm.drafting.gear_lives import at_work
from robophm.drafting.seen import look
from robophm.drafting.tasks import SeenTask, driven, tasks_seen, tasks_text
from robophm.hazard.environments import environment, explained
from robophm.parts import part as entry_of
from robophm.transports.recordings.remote import here

FUNCTION = "task"
"""The name of what must work for a task, where that is not everything."""

STANDING = ("GB", "GF")
"""Environments of what stands still."""

OF_HANDBOOK = 3
"""Error factor of what a handbook says of a part on a list."""

ANSWERED = "answers: "
DRAFTED = "drafted parts: "
EVIDENCE = "drafted of: "

_NOT_IN = (
    "cables, plugs and fasteners are not in the draft: robophm parts cable, robophm parts connector",
    "the frame does not fail here, software is not covered, people are not either",
    "all parts are in series: whatever fails stops the robot; redundancy is for you to draw (diagram)",
)


@dataclass(frozen=True)
class Draft:
    """A design that is drafted, and what it rests on; nothing of it is written yet."""

    text: str
    """The text of the design file."""
    robot: Robot
    parts: tuple[DraftPart, ...]
    """The parts that the description, topics and answers tell of; those of parts lists are in ``text`` alone."""
    lists: Mapping[str, Path]
    """The parts lists by the module that they are of."""
    bound: tuple[Proposal, ...]
    """The signals that it listens to."""
    unbound: tuple[str, ...]
    """Why other inputs have none."""
    doubts: tuple[str, ...]
    """Answers that do not go with what is seen, in words."""
    tasks: tuple[SeenTask, ...]
    assumptions: str
    """The page of everything that was assumed, as Markdown."""
    known: Known

    @property
    def tasks_file(self) -> str:
        """The text of a task file; "" where no task was seen."""
        return tasks_text(self.tasks, list(self.robot.functions), "Tasks as recorded.") if self.tasks else ""


def evidence(urdf: Path | None = None, recordings: Sequence[Path] = ()) -> Known:
    """Read a robot's URDF, if there is one, and look through its recordings.

    Raises DesignError or SourceError for a file that cannot be read.
    """
    files = {
        "urdf": (urdf.name,) if urdf else (),
        "recordings": tuple(here(path).name for path in recordings),  # without what an address is signed by
    }
    return Known(
        read_urdf(urdf) if urdf else None, look(recordings), {what: names for what, names in files.items() if names}
    )


def new(
    urdf: str | Path | None = None,
    recordings: Sequence[str | Path] = (),
    parts_lists: Mapping[str, str | Path] | None = None,
    answers: Answers | None = None,
    changes: Sequence[Change] = (),
    *,
    name: str = "",
) -> Draft:
    """Draft a robot's design from its URDF, its recordings, and parts lists by the module that they are of.

    What nobody answers is assumed, and said so. Raises RobophmError of what cannot be read, or where nothing tells of
    a part.
    """
    description = None if urdf is None else given_path(urdf, "URDF", RobophmError)
    if isinstance(recordings, str | os.PathLike) or not isinstance(recordings, Iterable):
        raise RobophmError(f"recordings {shown(recordings)}: expected a list of paths")
    bags = [given_path(one, "recording", RobophmError) for one in recordings]
    lists = instance({} if parts_lists is None else parts_lists, Mapping, "parts lists", "paths by module")
    for module, source in lists.items():
        instance(module, str, "module", "names with / between them")
        given_path(source, "parts list", RobophmError)
    instance(answers or Answers(), Answers, "answers", "robophm.Answers")
    instance(name, str, "name", "text")
    return drafted(evidence(description, bags), answers or Answers(), list(changes), lists, name=name)


def drafted(
    known: Known, answers: Answers, changes: Sequence[Change], parts_lists: Mapping[str, str | Path], *, name: str = ""
) -> Draft:
    """Draft a design as ``new`` does, from evidence that has been read already. Raises RobophmError as it does."""
    said, assumed = settled(answers, known)
    parts = composed(known, said, changes)
    tasks = tasks_seen(known.seen)
    keys, of_keys = _robot_keys(known, said, parts, tasks, name)
    if parts_lists:
        keys["uncertainty"] = {"error_factor": OF_HANDBOOK}
        of_keys.append(f"parts of lists have rates of a handbook, which may well be {OF_HANDBOOK} times off")
    head = _head(answers, changes, known)
    bare = parse(design_text(head, keys, parts), "the draft")
    efforts = {one.joint: one.effort for one in parts if one.joint and one.effort is not None}
    bound, unbound = proposals(bare, known.seen, efforts)
    parts = at_work([_bound(one, bound) for one in parts], known.seen)
    clocks = {one.input: dict(one.binding) for one in bound if one.place[0] == "clocks"}
    keys |= {"clocks": clocks} if clocks else {}
    text = design_text([*head, DRAFTED + json.dumps([one.path for one in parts], ensure_ascii=False)], keys, parts)
    robot, lists = parse(text, "the draft"), []
    for module, source in parts_lists.items():
        text, said_of = with_list(text, Path(source), module, keys["environment"])
        lists.append(said_of)
    robot = parse(text, "the draft")
    doubts = tuple(_doubts(known, said))
    page = _page(robot, parts, bound, unbound, assumed, [*doubts, *of_keys, *left_to_others(known, said)], lists)
    files = {module: Path(source) for module, source in parts_lists.items()}
    return Draft(text, robot, tuple(parts), files, tuple(bound), tuple(unbound), doubts, tuple(tasks), page, known)


def _head(answers: Answers, changes: Sequence[Change], known: Known) -> list[str]:
    given = {key: text for key, text in asdict(answers).items() if text is not None}
    given |= {"changes": [f"{one.part}={one.words}" for one in changes]} if changes else {}
    return [
        "Drafted by `robophm new`. What of it is assumed stands in assumptions.md; correct what is not so: a part",
        "that you edited is yours, and `robophm new --update` leaves it as it is.",
        ANSWERED + json.dumps(given, ensure_ascii=False),
        *([EVIDENCE + json.dumps(known.files, ensure_ascii=False)] if known.files else []),
    ]


def _robot_keys(
    known: Known, answers: Answers, parts: Sequence[DraftPart], tasks: Sequence[SeenTask], name: str
) -> tuple[dict[str, Any], list[str]]:
    """The keys of the robot, and what of them is assumed."""
    stated = name or (known.description.name if known.description else "robot")
    usage: dict[str, Any] = {"operating": round(share_of_day(answers.hours or "8"), 6)}
    notes = []
    metres, hours = driven(known.seen)
    for clock, pace in assumed_usage(parts).items():
        if clock == "kilometres" and metres > 0:
            usage[clock] = f"{metres / 1000 / hours:.3g} km/h"
            notes.append(f"usage: {usage[clock]}, as it drove {metres:.3g} m in {hours * 60:.3g} min of recordings")
        else:
            usage[clock] = pace
            notes.append(f"usage: {pace}, assumed")
    where = environment(answers.where or "mobile robot")
    notes.append(f"environment: {explained(where)}")
    keys: dict[str, Any] = {"name": design_name(stated), "environment": where, "usage": usage}
    leg: dict[str, Any] = dict(tasks[len(tasks) // 2].leg()) if tasks else {"duration": "1 h"}
    if not tasks:
        notes.append("task: an hour of work, assumed: no recording shows one")
    if needed := listed(answers.needs):
        keys["functions"] = {FUNCTION: {"series": [_drawn(word, parts) for word in needed]}}
        keys["task"] = {"legs": [{**leg, "functions": [FUNCTION]}]}
    else:
        keys["task"] = leg
    return keys, notes


def _doubts(known: Known, answers: Answers) -> Iterator[str]:
    """What somebody said that does not go with what is seen, in words."""
    said = (answers.where or "").strip()
    where = environment(said)
    if (known.travels or known.flies) and where in STANDING and said != where:
        better = "'flying' (ARW)" if known.flies else "'mobile robot' (GM)"
        yield f"where {said!r:.40} is {explained(where)}; this robot moves: {better} is what the handbook has for it"


def _drawn(word: str, parts: Sequence[DraftPart]) -> str:
    """A part or module as a diagram names it."""
    for one in parts:
        if word in (one.module, one.path):
            return word
        if word == one.name:
            return one.path
    names = [name for one in parts for name in (one.module, one.name, one.path)]
    raise RobophmError(f"needs {word!r:.40}: no such part or module{nearest(word, names)}")


def _bound(one: DraftPart, bound: Sequence[Proposal]) -> DraftPart:
    """A part with the bindings that are of it."""
    keys = dict(one.keys)
    for each in bound:
        if each.part == one.path:
            keys[each.place[-2]] = {**keys.get(each.place[-2], {}), each.input: dict(each.binding)}
    return replace(one, keys=keys)


def with_list(text: str, source: Path, module: str, environment: str | None = None) -> tuple[str, str]:
    """A design with the parts of a list in one of its modules, and what was made of the list. Raises DesignError.

    ``environment`` is the design's unless given.
    """
    steps = [step.strip() for step in module.split("/")]
    if not all(steps):
        raise RobophmError(f"{source}: module {module!r:.60}: expected names with / between them")
    with tempfile.TemporaryDirectory() as folder:
        design = Path(folder) / "draft.yaml"
        design.write_text(text, encoding="utf-8")
        found = import_bom(source, design, environment=environment, module=steps)
    needing = len(found.of_state("needs a rate"))
    return found.text, (
        f"{source.name}: {len(found.parts)} components in {module}, {needing} of which need a rate; where the list "
        f"says nothing else, {found.assumptions.temperature} around them, {found.assumptions.stress:g} of the rated, "
        f"quality {found.assumptions.board_quality or 'of each model'}"
    )


def _page(
    robot: Robot, parts: Sequence[DraftPart], bound: Sequence[Proposal], unbound: Sequence[str],
    assumed: Sequence[tuple[Question, str]], notes: Sequence[str], lists: Sequence[str],
) -> str:  # fmt: skip
    """What the draft rests on, as Markdown."""
    lines = [f"# What the draft of {robot.name} assumes", ""]
    lines += ["Each line is for you to confirm or to correct in the design.", "", "## Not answered", ""]
    lines += [f"- {one.text} Taken: {said or 'as found'} ({one.because})." for one, said in assumed] or ["- nothing"]
    lines += ["", "## Parts", ""]
    lines += [f"- {one.path}: {entry_of(one.entry).title}; {one.seen}"
              + (f"; assumed: {one.assumed}" if one.assumed else "") for one in parts]  # fmt: skip
    lines += ["", "## Signals", ""]
    lines += [f"- {one.part or robot.name}: {one.input} from {' and '.join(one.signals)}: {one.seen}"
              + (f"; assumed: {one.assumed}" if one.assumed else "") for one in bound]  # fmt: skip
    lines += [f"- not bound: {one}" for one in unbound]
    lines += [] if bound or unbound else ["- none: neither a recording nor a robot that runs told of any"]
    lines += ["", "## Else", "", *(f"- {one}" for one in (*notes, *lists, *_NOT_IN))]
    return "\n".join(printable(line) for line in lines) + "\n"
