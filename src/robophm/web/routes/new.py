"""A new robot: files handed in, questions answered, a draft looked at and used; or an example that runs at once."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path as File
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Request
from pydantic import Field
from starlette.concurrency import run_in_threadpool

from robophm.core.errors import RobophmError, SourceError
from robophm.core.files import shipped
from robophm.drafting.answers import Answers, Known, faults, questions
from robophm.drafting.composing import Change, change_of
from robophm.drafting.drafting import Draft, drafted
from robophm.drafting.first_look import PartFigures, part_figures
from robophm.drafting.received import endings
from robophm.drafting.updating import earlier_answers, updated, was_drafted
from robophm.drafting.writing import write_beside
from robophm.parts import library, part
from robophm.web.access.roles import needs
from robophm.web.prepared_robot import finite
from robophm.web.routes.design import REFUSED, SAVES, WRITES
from robophm.web.service import Served, Service
from robophm.web.shapes import DesignState, OfRevision, Shape

router = APIRouter(prefix="/api/new", tags=["new robot"])

FileName = Annotated[str, Query(min_length=1, max_length=200)]
Words = Annotated[str, Field(max_length=1000)]

EXAMPLE, SEED, PACE = "examples/ota/robot.yaml", 1, 50.0
"""The example that runs at once: its design, the seed of its synthetic drive, and the multiple of its own speed."""


class HandedIn(Shape):
    """A file that was handed in."""

    name: str
    kind: Literal["description", "recording", "parts list"]
    size: int


class LibraryEntry(Shape):
    """An entry of the library of parts."""

    name: str
    title: str


class PartChange(Shape):
    """A part that is to be another entry of the library, by words; "none" leaves it out, a new name adds one."""

    part: Annotated[str, Field(min_length=1, max_length=300)]
    words: Annotated[str, Field(min_length=1, max_length=300)]


class NewRobot(Shape):
    """The evidence of a new robot so far, and what has been said of it."""

    files: list[HandedIn]
    elsewhere: list[str]
    """Recordings that the service was started with."""
    room: int
    """Bytes that may still be handed in."""
    becomes: Literal["new", "update", "replacement"]
    """The effect of a draft on the design that is there: an update changes only what nobody touched."""
    answers: dict[str, str]
    """The answers that the design was drafted with."""
    parts: list[PartChange]
    library: list[LibraryEntry]
    endings: dict[str, list[str]]
    """Usual endings of the names of files that tell of a robot, by their kind."""


class DraftAsked(Shape):
    """The answers to questions, by their keys, and what else is said of a robot."""

    answers: Annotated[dict[str, Words], Field(max_length=20)] = {}
    parts: Annotated[list[PartChange], Field(max_length=500)] = []
    modules: Annotated[dict[str, Annotated[str, Field(max_length=300)]], Field(max_length=100)] = {}
    """The module that each parts list is of, by the name of its file."""
    name: Annotated[str, Field(max_length=200)] = ""


class UseAsked(DraftAsked, OfRevision):
    """A draft that is to be the design."""


class DraftQuestion(Shape):
    """A question, what was answered, and what is taken where nobody does."""

    key: str
    text: str
    default: str
    because: str
    answer: str
    wrong: str
    """Why the answer cannot be had; "" where it can."""


class ProposedPart(Shape):
    """A part of a draft: what it is taken for, how often it fails, and what it listens to."""

    path: str
    quantity: int
    entry: str
    """Name of its entry of the library; "" of a part of a list."""
    title: str
    grade: str
    source: str
    rate: float | None
    """The stated rate [1/h]; null where nobody knows it."""
    low: float | None
    high: float | None
    """The ends of its range, 5 and 95 % [1/h]."""
    stresses: list[str]
    signals: list[str]
    seen: str
    assumed: str


class BoundSignal(Shape):
    """A signal that a draft listens to."""

    part: str
    input: str
    signals: list[str]
    seen: str
    assumed: str


class Drafted(Shape):
    """A draft of a robot; nothing is changed by it yet."""

    name: str
    says: list[str]
    """Sentences that say what there is of the robot."""
    doubts: list[str]
    questions: list[DraftQuestion]
    parts: list[ProposedPart]
    bound: list[BoundSignal]
    unbound: list[str]
    tasks: list[str]
    refused: str
    """Why nothing can be drafted; "" where it can."""


@router.get("")
def get_new(service: Served) -> NewRobot:
    """The files that were handed in, and what the design was drafted with, if it was."""
    text = service.workspace.draft().text
    told = earlier_answers(text)
    changes = [change_of(str(one)) for one in told.pop("changes", [])]
    empty = not service.workspace.checked.of(text).document.keys() & {"modules", "components"}
    return NewRobot(
        files=[HandedIn(name=one.name, kind=one.kind, size=one.size) for one in service.received.all()],
        elsewhere=[one.name for one in service.settings.recordings],
        room=service.received.room,
        becomes="new" if empty else "update" if was_drafted(text) else "replacement",
        answers={key: str(said) for key, said in told.items()},
        parts=[PartChange(part=one.part, words=one.words) for one in changes],
        library=[LibraryEntry(name=one.name, title=one.title) for one in library().values()],
        endings={kind: list(some) for kind, some in endings().items()},
    )


@router.post(
    "/files", responses=REFUSED,
    openapi_extra={"requestBody": {"required": True, "content": {
        "application/octet-stream": {"schema": {"type": "string", "format": "binary"}}}}},
)  # fmt: skip
@needs("editor")
async def hand_in(request: Request, service: Served, name: FileName) -> NewRobot:
    """Hand in a URDF, a recording or a parts list: told by its content, kept in a folder beside the design."""
    arrival = await run_in_threadpool(service.received.begin, name)
    try:
        async for piece in request.stream():
            await run_in_threadpool(arrival.write, piece)
        await run_in_threadpool(arrival.keep)
    finally:
        await run_in_threadpool(arrival.close)
    return await run_in_threadpool(get_new, service)


@router.delete("/files/{name}", responses=REFUSED)
@needs("editor")
def take_away(service: Served, name: Annotated[str, Path(max_length=200)]) -> NewRobot:
    """Take a file away that was handed in."""
    service.received.remove(name)
    return get_new(service)


@router.post("/draft", responses=REFUSED)
@needs("editor")
def draft(asked: DraftAsked, service: Served) -> Drafted:
    """Draft a robot of what there is; nothing is changed by it."""
    known = service.received.evidence()
    answers = Answers().with_(**asked.answers)
    wrong = faults(answers)
    fitting = Answers().with_(**{key: said for key, said in asked.answers.items() if said and key not in wrong})
    refused, found = "", None
    try:
        found = _drafted(service, known, fitting, asked)
    except RobophmError as error:
        refused = str(error)
    return Drafted(
        name=found.robot.name if found else "",
        says=list(known.summary),
        doubts=list(found.doubts) if found else [],
        questions=[
            DraftQuestion(**asdict(one), answer=asked.answers.get(one.key, ""), wrong=wrong.get(one.key, ""))
            for one in questions(known)
        ],
        parts=_parts(found) if found else [],
        bound=[
            BoundSignal(part=one.part, input=one.input, signals=list(one.signals), seen=one.seen, assumed=one.assumed)
            for one in (found.bound if found else ())
        ],
        unbound=list(found.unbound) if found else [],
        tasks=[one.name for one in found.tasks] if found else [],
        refused=refused,
    )


@router.post("/use", responses=SAVES)
@needs("editor")
def use(asked: UseAsked, service: Served) -> DesignState:
    """Make a draft the design, and save it; beside it are written what it assumes, and the tasks that were seen."""
    answers = Answers().with_(**{key: said for key, said in asked.answers.items() if said})
    found = _drafted(service, service.received.evidence(), answers, asked)
    design, before = service.settings.design, service.workspace.draft().text
    again = was_drafted(before)
    text = updated(before, found, design.name).text if again else found.text
    state = service.workspace.replace(asked.revision, text, f"draft {found.robot.name}")
    state = service.workspace.save(state.revision)
    write_beside(design, found, again=again)
    return service.design_state(state)


@router.post("/example", responses=WRITES)
@needs("editor")
def run_example(asked: OfRevision, service: Served) -> DesignState:
    """Open the example robot, and watch it drive at once; this is undone as any edit."""
    if service.monitoring.state == "running":
        raise SourceError("monitoring runs already; stop it first")
    text = shipped(EXAMPLE).read_text(encoding="utf-8")
    state = service.workspace.replace(asked.revision, text, "open the example robot")
    service.seed = SEED if service.seed is None else service.seed
    service.watch("synthetic", PACE)
    return service.design_state(state)


def _drafted(service: Service, known: Known, answers: Answers, asked: DraftAsked) -> Draft:
    lists: dict[str, str | File] = {}
    for one in service.received.of_kind("parts list"):
        module = asked.modules.get(one.name, "").strip() or f"electronics/{one.path.stem}"
        if module in lists:
            raise RobophmError(f"two parts lists for {module!r:.60}; expected a module of its own for each")
        lists[module] = one.path
    changes = [Change(one.part.strip(), one.words.strip()) for one in asked.parts]
    return drafted(known, answers, changes, lists, name=asked.name.strip())


def _parts(found: Draft) -> list[ProposedPart]:
    of_library = {one.path: one for one in found.parts}
    return [_part(one, of_library) for one in part_figures(found.robot)]


def _part(one: PartFigures, of_library: dict[str, Any]) -> ProposedPart:
    mine = of_library.get(one.path)
    exact = not one.rate.low < one.rate.high
    return ProposedPart(
        path=one.path,
        quantity=one.quantity,
        entry=mine.entry if mine else "",
        title=part(mine.entry).title if mine else one.source.partition(";")[0] or "stated",
        grade=one.grade,
        source=one.source,
        rate=finite(one.stated) if one.stated > 0 else None,
        low=None if exact or not math.isfinite(one.rate.low) else one.rate.low,
        high=None if exact or not math.isfinite(one.rate.high) else one.rate.high,
        stresses=list(one.stresses),
        signals=list(one.signals),
        seen=mine.seen if mine else "on the parts list",
        assumed=mine.assumed if mine else "",
    )
