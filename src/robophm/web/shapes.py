"""Shapes of requests and responses, named and described: the OpenAPI schema is made of these."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

Name = Annotated[str, Field(min_length=1, max_length=200)]
Place = Annotated[list[Annotated[str, Field(max_length=300)]], Field(max_length=100)]
"""Keys from the top of the design file down."""

Unit = Literal["1/h", "FIT", "FPMH", "MTBF"]

MOST_VALUES, MOST_LEVELS = 100_000, 50
"""Bounds of a value that is put into the design: millions would keep everybody waiting for minutes."""


def _bounded(value: Any) -> Any:
    """The same value, where it is within the bounds."""
    count, waiting = 1, [(value, 1)]
    while waiting:
        one, level = waiting.pop()
        inner = one.values() if isinstance(one, dict) else one if isinstance(one, list) else ()
        count += len(inner)
        if count > MOST_VALUES or (inner and level == MOST_LEVELS):
            says = f"expected at most {MOST_VALUES:,} values, nested at most {MOST_LEVELS} deep"
            raise PydanticCustomError("bounds", "{says}", {"says": says})
        waiting += ((each, level + 1) for each in inner)
    return value


class Shape(BaseModel):
    """Nothing beside what is named; no number is infinite or none."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Trouble(Shape):
    """Why something was refused: what, where, and what was expected."""

    message: str
    place: list[str] = []
    """Place in the design, where it is there."""


class Problem(Shape):
    """An error or a warning about the design."""

    level: Literal["error", "warning"]
    place: list[str]
    message: str
    line: int | None
    column: int | None
    """The column of the line, from 1 on: of the key or the value, or where the text is no YAML any more."""


class PastOfPart(Shape):
    """The fate of the past of one part under the design now."""

    path: str
    place: list[str]
    """Keys that lead to it in the document; none for a part that is removed."""
    kind: str
    said: str
    candidates: list[str]
    """Identities of parts that it may be, the likeliest first, where that is asked."""


class PastOfDesign(Shape):
    """The fate of the robot's past under the design now, without the parts that go on as they were."""

    kept: bool
    """Whether the robot has a past."""
    parts: list[PastOfPart]
    trouble: str
    """Why its past cannot be read; "" where it can."""


class DesignState(Shape):
    """The state of the design now."""

    revision: int
    state: int
    name: str
    file: str
    document: dict[str, Any]
    history: int
    """Number of the history in which states are numbered; another one begins where the edits' file is lost."""
    saved: bool
    undo: str | None
    """Latest edit of all, which would be undone; null where nothing is."""
    redo: str | None
    valid: bool
    problems: list[Problem]
    levels: dict[str, LevelFigures]
    """Figures of each level and part of a valid design when new, by path; "" is the robot."""
    unknown: dict[str, UnknownRates]
    """The effect of parts of unknown rate, for those that have some."""


class UnknownRates(Shape):
    """The effect of parts of unknown rate, which are left out of figures, on these figures."""

    parts: int
    hazard_rate: Literal["at least", "if they never fail"]
    reliability: Literal["at most"]
    ahead: Literal["at most", "if they never fail"]
    """Relation of the stated remaining life and task completion to the true ones."""
    failing: Literal["at least", "if they never fail"]
    """Relation of the stated probability of failing ahead to the true one."""
    sentence: str
    """Sentence about them beside these figures."""


class LevelFigures(Shape):
    """The nominal figures of a level or part when new."""

    kind: Literal["robot", "module", "component"]
    hazard_rate: float | None
    """Hazard rate of all equal parts together [1/h of operation]."""
    quantity: int = 1
    single_point: bool = False
    """Whether its failure alone fails the robot."""


class Stale(Trouble):
    """A write that was made of an older revision, and what the design is now."""

    yours: int
    current: DesignState


class Outside(Trouble):
    """The file has been changed by hand since it was read, and was not written over."""

    digest: str
    """Digest of what it holds now: with it, saving writes over it."""
    changes: list[str]
    """Lines of a unified diff of what was changed by hand; the first few hundred."""


class Put(Shape):
    """Put a value at a place of the design."""

    op: Literal["put"]
    path: Place
    value: Annotated[Any, AfterValidator(_bounded)]


class PutText(Shape):
    """Put a value at a place, written as YAML."""

    op: Literal["put_text"]
    path: Place
    text: Annotated[str, Field(max_length=200_000)]


class Delete(Shape):
    """Delete what is at a place."""

    op: Literal["delete"]
    path: Place


class Rename(Shape):
    """Give what is at a place another name."""

    op: Literal["rename"]
    path: Place
    name: Name


class Wire(Shape):
    """Draw a level anew; null: all in series."""

    op: Literal["wire"]
    path: Place
    diagram: Any


class Group(Shape):
    """Put parts that stand side by side into a group."""

    op: Literal["group"]
    path: Place
    members: Annotated[list[Name], Field(max_length=10_000)]
    kind: Literal["series", "parallel", "k_of_n", "standby", "load_sharing", "network"]
    k: Annotated[int, Field(ge=1, le=100_000)] | None = None


class Ungroup(Shape):
    """Dissolve the smallest group that holds all these parts."""

    op: Literal["ungroup"]
    path: Place
    members: Annotated[list[Name], Field(max_length=10_000)]


class Move(Shape):
    """Take a part to another level; whoever names it names it there."""

    op: Literal["move"]
    path: Place
    to: Place
    """Place of a module; empty: the robot."""


class PlaceParts(Shape):
    """Draw parts of a level elsewhere in its diagram."""

    op: Literal["place"]
    path: Place
    members: Annotated[list[Name], Field(max_length=10_000)]
    beside: Annotated[list[Name], Field(max_length=10_000)] = []
    """Parts in whose smallest common group they are drawn; none: at the end of the outermost series."""
    before: bool = False


Operation = Annotated[
    Put | PutText | Delete | Rename | Wire | Group | Ungroup | Move | PlaceParts, Field(discriminator="op")
]


class Edits(Shape):
    """Edits of one revision, done all or not at all."""

    revision: int
    operations: Annotated[list[Operation], Field(min_length=1, max_length=10_000)]
    what: Annotated[str, Field(max_length=200)] = ""
    """Edit in words, for undo."""


class OfRevision(Shape):
    """Which revision a write is made of."""

    revision: int


class OfEdit(OfRevision):
    """Which edit is undone or done again."""

    edit: int | None = None
    """The state that it made; null is the latest of all. Edits after it stay."""


class SaveAsked(OfRevision):
    """A wish to save the design to its file."""

    over: Annotated[str, Field(max_length=64)] | None = None
    """Digest of a file that was changed by hand, and is to be written over; what it holds is kept beside it."""


class WholeText(OfRevision):
    """The text of a whole design, to replace the present one."""

    text: Annotated[str, Field(max_length=20_000_000)]
    what: Annotated[str, Field(max_length=200)] = "replace the design"


class TextToCheck(Shape):
    """The text of a whole design that is being written."""

    text: Annotated[str, Field(max_length=20_000_000)]


class Problems(Shape):
    """The errors and warnings about a text."""

    problems: list[Problem]


class DesignText(Shape):
    """The text of the design, as its file would be."""

    revision: int
    text: str


class DesignStates(Shape):
    """The states on the way to the design now, the latest first."""

    states: list[PastState]


class PastState(Shape):
    """A state that the design was in."""

    state: int
    what: str


class Imported(Shape):
    """The design that a file would make, to be looked at; nothing is changed yet."""

    text: str
    """Text of the design then."""
    findings: list[str]
    columns: list[str]
    rows: list[list[str]]
    mapping: dict[str, str] = {}
    """Headers, in a parts list, under which the fields of a part stand, by field."""
    unused: list[str] = []
    """Headers that were taken for nothing."""
    fields: list[str] = []
    """Fields that headers can be taken for."""


class Box(Shape):
    """A part, or parts left out, in a drawing."""

    x: float
    y: float
    width: float
    height: float
    part: str | None
    title: str
    detail: str
    badge: str
    kind: Literal["module", "component", "more"]
    spare: bool
    places: int
    single_point: bool
    wrong: list[str] = []
    """Mistakes in the design of the part, or of what is in the module: what of it could not be drawn."""


class Gate(Shape):
    """The mark behind parallel branches: "1/2"."""

    x: float
    y: float
    width: float
    text: str
    parts: list[str]
    """Parts that are drawn in the branches."""


class Line(Shape):
    """A line that joins boxes in a drawing."""

    points: list[tuple[float, float]]
    dashed: bool


class Drawing(Shape):
    """The laid-out diagram of a level [px]."""

    path: str
    width: float
    height: float
    boxes: list[Box]
    gates: list[Gate]
    wires: list[Line]
    ends: list[tuple[float, float]]
    notes: list[str]
    words: str
    """Drawing as words for a reader."""
    wrong: list[str] = []
    """Mistakes of this level itself; none of a valid design."""
    elsewhere: int = 0
    """Number of mistakes that are of no part of this level."""
    wired: bool = True
    """Whether its wires are known; where its diagram is wrong, its parts are drawn side by side."""
    earlier: str | None = None
    """First part of the stretch before the one that is drawn, where a level has more parts than are drawn at once."""
    later: str | None = None


DesignState.model_rebuild()
DesignStates.model_rebuild()
