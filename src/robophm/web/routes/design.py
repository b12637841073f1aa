"""The design: what it is, edits, undo, saving, its drawing."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query
from fastapi.responses import PlainTextResponse

from robophm.core.errors import DesignError, StoreError
from robophm.core.yaml_values import values
from robophm.design import editing, identity_edits
from robophm.design.identity_edits import NOTHING, Lived, place_at
from robophm.design.located_error import LocatedError
from robophm.design.schema import json_schema
from robophm.web.access.roles import needs
from robophm.web.drawing import drawing
from robophm.web.service import Served, told
from robophm.web.shapes import (
    Delete,
    DesignState,
    DesignStates,
    DesignText,
    Drawing,
    Edits,
    Group,
    Move,
    OfEdit,
    OfRevision,
    Operation,
    Outside,
    PastOfDesign,
    PastOfPart,
    PastState,
    PlaceParts,
    Problems,
    Put,
    PutText,
    Rename,
    SaveAsked,
    Stale,
    TextToCheck,
    Trouble,
    Ungroup,
    Unit,
    WholeText,
    Wire,
)

REFUSED: dict[int | str, dict[str, Any]] = {422: {"model": Trouble, "description": "Refused, and why"}}
WRITES: dict[int | str, dict[str, Any]] = {
    **REFUSED, 409: {"model": Stale, "description": "The design has changed since that revision"}
}  # fmt: skip
SAVES: dict[int | str, dict[str, Any]] = {
    **REFUSED, 409: {"model": Stale | Outside, "description": "The design, or its file, has changed since"}
}  # fmt: skip
MOST_STATES = 500

router = APIRouter(prefix="/api/design", tags=["design"])


@router.get("")
def get_design(service: Served) -> DesignState:
    """The design now, all that is wrong or odd in it, and what its parts promise when new."""
    return service.design_state()


@router.post("/edits", responses=WRITES)
@needs("editor")
def edit_design(edits: Edits, service: Served) -> DesignState:
    """Edit the design: all of the operations, or none."""

    def change(document: Any) -> None:
        lived = service.lived()
        for operation in edits.operations:
            apply(document, operation, lived)

    scalar = None
    match edits.operations:
        case [Put(path=path, value=value)] if path[-1:] not in (["name"], ["identity"]):
            scalar = path, value
    draft = service.workspace.edit(edits.revision, change, edits.what or edits.operations[0].op, scalar)
    return service.design_state(draft)


@router.post("/undo", responses=WRITES)
@needs("editor")
def undo(asked: OfEdit, service: Served) -> DesignState:
    """Take back the latest edit, or an earlier one where no later edit touches what it changed."""
    return service.design_state(service.workspace.undo(asked.revision, asked.edit))


@router.post("/redo", responses=WRITES)
@needs("editor")
def redo(asked: OfEdit, service: Served) -> DesignState:
    """Do again what was undone last, or another edit where no edit since touches what it changed."""
    return service.design_state(service.workspace.redo(asked.revision, asked.edit))


@router.post("/save", responses=SAVES)
@needs("editor")
def save(asked: SaveAsked, service: Served) -> DesignState:
    """Write the design file, what was there kept beside it; not over what somebody has changed in it by hand."""
    return service.design_state(service.workspace.save(asked.revision, asked.over))


@router.get("/past")
def get_past(service: Served) -> PastOfDesign:
    """Tell what becomes of the past of each part under the design now, before it is saved or watched."""
    try:
        found = service.fates()
    except StoreError as error:
        return PastOfDesign(kept=True, parts=[], trouble=str(error))
    document = service.workspace.checked.of(service.workspace.draft().text).document
    parts = [
        PastOfPart(path=one.path, kind=one.kind, said=one.said, candidates=list(one.candidates),
                   place=[] if one.kind == "removed" else list(place_at(document, one.path)))
        for one in found or () if one.kind != "same"
    ]  # fmt: skip
    return PastOfDesign(kept=found is not None, parts=parts, trouble="")


@router.post("/take", responses=WRITES)
@needs("editor")
def take(asked: OfRevision, service: Served) -> DesignState:
    """Take what the file holds now in place of the design; this is undone as any edit."""
    return service.design_state(service.workspace.take(asked.revision))


@router.get("/text")
def get_text(service: Served) -> DesignText:
    """The text of the design, as its file would be."""
    draft = service.workspace.draft()
    return DesignText(revision=draft.revision, text=draft.text)


@router.put("/text", responses=WRITES)
@needs("editor")
def put_text(asked: WholeText, service: Served) -> DesignState:
    """Put a whole text in place of the design; that is undone as any edit."""
    return service.design_state(service.workspace.replace(asked.revision, asked.text, asked.what))


@router.post("/check")
@needs("viewer")
def check_text(asked: TextToCheck, service: Served) -> Problems:
    """Tell all that is wrong or odd in the text of a design; the design stays as it is."""
    return Problems(problems=told(service.workspace.checked.problems(asked.text)))


@router.get("/schema")
def get_schema() -> dict[str, Any]:
    """The JSON Schema of the design file, by which an editor completes and explains its keys."""
    return json_schema()


@router.get("/download", response_class=PlainTextResponse)
def download(service: Served) -> PlainTextResponse:
    """The design file, as it would be saved."""
    name = "".join(letter for letter in service.settings.design.name if letter.isascii() and letter not in '"\\')
    headers = {"content-disposition": f'attachment; filename="{name or "robot.yaml"}"'}
    return PlainTextResponse(service.workspace.draft().text, headers=headers, media_type="application/yaml")


@router.get("/states")
def get_states(service: Served) -> DesignStates:
    """The states on the way here, the latest first."""
    found = service.workspace.states(MOST_STATES)
    return DesignStates(states=[PastState(state=state, what=what) for state, what in found])


@router.get("/part", responses=REFUSED)
def get_part_text(service: Served, path: Annotated[list[str] | None, Query(max_length=100)] = None) -> DesignText:
    """The value at a place of the design, as YAML."""
    draft = service.workspace.draft()
    if not path:  # all of it, also where it is no YAML and is to be mended
        return DesignText(revision=draft.revision, text=draft.text)
    return DesignText(revision=draft.revision, text=service.part_texts.of(draft.text, tuple(path)))


@router.get("/drawing", responses=REFUSED)
def get_drawing(
    service: Served,
    path: Annotated[str, Query(max_length=5000)] = "",
    width: Annotated[float, Query(ge=100, le=20_000)] = 1000,
    unit: Unit = "1/h",
    whole: bool = False,
    around: Annotated[str, Query(max_length=5000)] = "",
) -> Drawing:
    """The block diagram of a level, laid out; of one with more parts than are drawn the stretch ``around`` a part."""
    return drawing(*service.to_draw(), path, width, unit, whole=whole, around=around)


def apply(document: Any, operation: Operation, lived: Lived = NOTHING) -> None:
    """Make one edit in a document; what has ``lived`` keeps its identity. Raises LocatedError."""
    match operation:
        case Put():
            identity_edits.put(document, operation.path, operation.value, lived)
        case PutText():
            identity_edits.put(document, operation.path, _read(operation), lived)
        case Delete():
            editing.delete(document, operation.path)
        case Rename():
            identity_edits.rename(document, operation.path, operation.name, lived)
        case Wire():
            editing.wire(document, operation.path, operation.diagram)
        case Group():
            editing.group(document, operation.path, operation.members, operation.kind, operation.k)
        case Move():
            identity_edits.move(document, operation.path, operation.to, lived)
        case PlaceParts():
            editing.place(document, operation.path, operation.members, operation.beside, before=operation.before)
        case Ungroup():
            editing.ungroup(document, operation.path, operation.members)


def _read(operation: PutText) -> Any:
    """The value of a text, its comments kept. Raises LocatedError."""
    from robophm.web.documents import load_value

    try:
        values(operation.text, "text")
    except DesignError as error:
        raise LocatedError(tuple(operation.path), str(error)) from None
    return load_value(operation.text)
