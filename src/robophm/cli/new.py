"""``robophm new``: a first design of a robot from its URDF, its recordings and its parts lists, and its health."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli.shared.drafts import Bag, ask, print_bindings, print_look, print_parts_of
from robophm.cli.shared.options import Force, Json
from robophm.cli.shared.output import console, may_make, may_write, print_json, progress_console, warn
from robophm.cli.shared.progress import counted
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.design.file import parse, read, write_text
from robophm.drafting.answers import Answers, asked
from robophm.drafting.composing import Change, change_of
from robophm.drafting.drafting import Draft, drafted, evidence
from robophm.drafting.first_look import FirstLook, first_look, part_figures
from robophm.drafting.heard import hear
from robophm.drafting.seen import Seen
from robophm.drafting.updating import Outcome, Updated, evidence_left_out, updated
from robophm.drafting.writing import ASSUMPTIONS, TASKS, with_earlier, write_beside
from robophm.transports.running_robot import open_live

LISTENED = 10.0
"""Seconds that a robot that runs is listened to."""


@dataclass(frozen=True)
class Wishes:
    """The arguments of one call of ``robophm new``, after they have been read."""

    urdf: Path | None
    bags: tuple[Path, ...]
    parts_lists: dict[str, Path]
    answers: Answers
    changes: tuple[Change, ...]
    name: str
    update: bool
    force: bool
    silent: bool
    """Whether nothing is asked."""
    via: str | None = None
    """How a robot that runs is heard; None: it is not."""


def command(
    design: Annotated[Path, typer.Argument(help="design file to write", metavar="ROBOT.YAML")],
    urdf: Annotated[Path | None, typer.Option(help="URDF of the robot, expanded from xacro")] = None,
    bag: Bag = None,
    via: Annotated[
        str | None,
        typer.Option("--via", help="listen to a running robot for ten seconds: auto, ros1, ros2, dds, rclpy, mqtt://…"),
    ] = None,
    bom: Annotated[
        list[str] | None, typer.Option(help="a parts list and its module, e.g. main.csv=Drive/board")
    ] = None,
    hours: Annotated[str | None, typer.Option(help="hours of work a day")] = None,
    where: Annotated[
        str | None, typer.Option(help="where it works: indoor robot, outdoor robot, factory, flying …")
    ] = None,
    battery: Annotated[str | None, typer.Option(help="power supply: li-ion, lipo, lead acid …, mains or none")] = None,
    computer: Annotated[
        str | None, typer.Option(help="computer on board: raspberry pi, jetson, mini pc … or none")
    ] = None,
    sensors: Annotated[str | None, typer.Option(help="further sensors, in words, separated by commas")] = None,
    drive: Annotated[str | None, typer.Option(help="drive of wheels or joints: dynamixel, harmonic drive …")] = None,
    needs: Annotated[str | None, typer.Option(help="parts or modules that a task needs, separated by commas")] = None,
    part: Annotated[
        list[str] | None,
        typer.Option(help="NAME=WORDS: take a part as this entry of the library; NAME=none: leave it out"),
    ] = None,
    name: Annotated[str, typer.Option(help="name of the robot; default: that of the URDF")] = "",
    yes: Annotated[bool, typer.Option("--yes", help="ask nothing; use the default for each open question")] = False,
    update: Annotated[
        bool, typer.Option("--update", help="update an existing design; what you edited in it stays")
    ] = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Draft a design from a URDF, recordings and parts lists, and give the robot's first health figures."""
    wishes = Wishes(
        urdf, tuple(bag or ()), lists_of(bom or ()),
        Answers(hours, where, battery, computer, sensors, drive, needs), tuple(map(change_of, part or ())), name,
        update=update, force=force, silent=yes or as_json or not (sys.stdin.isatty() and sys.stdout.isatty()),
        via=via,
    )  # fmt: skip
    run(design, wishes, as_json=as_json)


def lists_of(said: Sequence[str]) -> dict[str, Path]:
    """Parts lists by the module that they are of. Raises RobophmError."""
    found: dict[str, Path] = {}
    for one in said:
        file, equals, module = one.rpartition("=")
        if not (file and equals and module.strip()):
            raise RobophmError(f"--bom {one!r:.60}: expected FILE=MODULE, such as main.csv=Drive/board")
        if module.strip() in found:
            raise RobophmError(f"--bom: two lists for {module.strip()!r:.60}; expected a module of its own for each")
        found[module.strip()] = Path(file)
    return found


def run(design: Path, wishes: Wishes, *, as_json: bool) -> None:
    """Write the design and what goes with it. Raises RobophmError, nothing written, of what cannot be read."""
    _folder_of(design)
    beside = design.parent / ASSUMPTIONS, design.parent / TASKS
    inputs = [*filter(None, [wishes.urdf]), *wishes.parts_lists.values(), *wishes.bags]
    for path in (design, *beside):
        if wishes.update:
            may_write(path, *inputs)
        else:
            may_make(path, *inputs, force=wishes.force)
    before = read(design) if wishes.update else ""
    answers, changes = with_earlier(wishes.answers, wishes.changes, before)
    with counted(progress_console(), "reading") as advance:
        advance(0, 1)
        known = evidence(wishes.urdf, wishes.bags)
    if wishes.via:
        listened = {"recordings": (*known.files.get("recordings", ()), wishes.via)}
        known = replace(known, seen=known.seen.and_of(_heard(wishes.via)), files={**known.files, **listened})
    _refuse_less(design, evidence_left_out(before, known))
    if not wishes.silent:
        for line in known.summary:
            console().print(line, markup=False)
        answers = asked(answers, known, ask)
    draft = drafted(known, answers, changes, wishes.parts_lists, name=wishes.name)
    while not wishes.silent:
        print_parts_of(part_figures(draft.robot))
        if not (
            wish := typer.prompt("A part to change (NAME=WORDS, NAME=none), or Enter", default="", show_default=False)
        ):
            break
        try:
            draft = drafted(known, answers, [*changes, change_of(wish)], wishes.parts_lists, name=wishes.name)
            changes = [*changes, change_of(wish)]
        except RobophmError as error:
            warn(str(error))
    brought = updated(before, draft, str(design)) if before else Updated(draft.text, ())
    look = first_look(parse(brought.text, str(design)), wishes.bags)
    write_text(design, brought.text)
    files = [design, *write_beside(design, draft, again=bool(before))]
    outcomes = brought.outcomes
    if as_json:
        print_json(_document(design, draft, look, outcomes))
        return
    if wishes.silent:
        print_parts_of(part_figures(draft.robot))
    _print(files, draft, look, outcomes)


def _refuse_less(design: Path, left_out: Mapping[str, Sequence[str]]) -> None:
    """Raise RobophmError where an update is not given what the design was drafted of, which it would then take out."""
    if left_out:
        options = {"urdf": "--urdf", "recordings": "--bag"}
        said = " and ".join(f"{options.get(what, what)} {' '.join(names)}" for what, names in left_out.items())
        raise RobophmError(
            f"{design}: was drafted of {said}; an update without would take out what that told of: expected it again, "
            "or a later one"
        )


def _heard(via: str) -> Seen:
    """What a robot that runs publishes. Raises RobophmError where nothing is heard."""
    opened = open_live(via)
    print(opened.said, file=sys.stderr)
    with opened.source as source:
        heard = hear(source, LISTENED)
        hidden = source.hidden_by()
    if not heard.topics:
        raise RobophmError(f"nothing is published at {opened.source.place}{'; '.join(['', *hidden])}")
    return heard


def _folder_of(design: Path) -> None:
    """Make the folder of a new robot, in one that is there. Raises RobophmError."""
    if design.suffix not in (".yaml", ".yml"):
        raise RobophmError(f"{design}: cannot be a design; expected a name that ends in .yaml or .yml")
    try:
        design.parent.mkdir(exist_ok=True)
    except OSError as error:
        raise RobophmError(f"{design.parent}: cannot be made: {error.strerror}") from None


def _document(design: Path, draft: Draft, look: FirstLook, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    return {
        "robot": draft.robot.name,
        "design": str(design),
        "parts": [asdict(one) for one in part_figures(draft.robot)],
        "bound": [{"part": one.part, "input": one.input, "signals": one.signals, "seen": one.seen,
                   "assumed": one.assumed} for one in draft.bound],
        "unbound": list(draft.unbound),
        "doubts": list(draft.doubts),
        "tasks": [asdict(one) for one in draft.tasks],
        "outcomes": [asdict(one) for one in outcomes],
        "lived": look.lived,
        "ranges": plain(asdict(look.ranges)),
        "largest_unknowns": [
            {"parts": [part.path for part in one.parts], "entry": one.entry, "model": one.model,
             "left": one.left, "quality_of": one.quality_of}
            for one in look.unknowns
        ],
        "parts_of_unknown_rate": look.left_out.parts if look.left_out else 0,
    }  # fmt: skip


def _print(files: Sequence[Path], draft: Draft, look: FirstLook, outcomes: Sequence[Outcome]) -> None:
    out = console()
    for doubt in draft.doubts:
        warn(doubt)
    print_bindings(draft.bound, draft.unbound)
    for one in outcomes:
        if one.state != "unchanged":
            out.print(f"{one.state}: {one.name}{': ' * bool(one.text)}{one.text}", markup=False, soft_wrap=True)
    print_look(look)
    written = ", ".join(map(str, files))
    out.print(f"\nwritten: {written}; next: robophm check {files[0]}", markup=False, soft_wrap=True)
