"""A part of a list as a component of a design: what it says, how that is written, and how an edit of it is noticed."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from robophm.design.importers.bom.models import Rating
from robophm.design.importers.bom.references import ReferencesError, compressed, expand
from robophm.design.naming import printable, quoted
from robophm.design.robot import UNKNOWN

LONGEST_NAME = 80
LONGEST_DESCRIPTION = 300

Content = dict[str, Any]
"""A component as a design has it."""

NEEDS = "  # needs a rate: "
RATED_BY = ("hazard", "part", "rate")
"""Keys by which a part of a list has a rate, or says that it has none."""

ASSUMED = "  # assumed: "


@dataclass(frozen=True)
class Wanted:
    """A part as the list has it."""

    row: int
    name: str
    references: tuple[str, ...]
    quantity: int
    description: str
    rating: Rating | None
    needs: str
    """The reason why it has no rate; "" where it has one."""
    hazard_rate: float | None = None
    """Hazard rate of one of the parts [1/h]."""


@dataclass(frozen=True)
class Origin:
    """The origin of a component as its source states it: file, references and stamp."""

    file: str
    references: tuple[str, ...]
    stamp: str


def content(part: Wanted, file: str) -> Content:
    """A part as a component: with its model, or of unknown rate."""
    made: Content = {"description": part.description, "quantity": part.quantity}
    if part.rating is None:
        made["rate"] = UNKNOWN
    elif part.rating.entry:
        made["part"] = part.rating.entry.name
    else:
        made["hazard"] = {"model": part.rating.model, "inputs": dict(part.rating.inputs)}
    assumed = f"; assumed {', '.join(part.rating.assumed)}" if part.rating and part.rating.assumed else ""
    doubt = re.search(r"a guess[^;]*", part.rating.assumed.get("model", "")) if part.rating else None
    guess = f"; {doubt[0]}" if doubt else ""
    entry = f"; {part.rating.entry.origin}" if part.rating and part.rating.entry else ""
    return made | {"source": f"{_source(part, file)}{guess}{assumed}{entry} [import {stamp(made)}]"}


def stamp(made: Content) -> str:
    """Return a hash of all that a component says but its source: it changes when somebody edits the component."""

    def words(value: Any) -> Any:
        return {key: words(inner) for key, inner in value.items()} if isinstance(value, dict) else str(value)

    said = words({key: value for key, value in made.items() if key != "source"})
    return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:8]


def origin(source: object) -> Origin | None:
    """Return the import that a source tells of; None where it tells of none."""
    match = _SOURCE.match(source) if isinstance(source, str) else None
    if not match:
        return None
    try:
        references = expand(match["references"].removeprefix("no references"))
    except ReferencesError:
        return Origin(match["file"], (), "")
    return Origin(match["file"], references, match["stamp"] or "")


_SOURCE = re.compile(
    r"(?P<file>.*), row \d+: (?P<references>[^;\[]*)(?:.*\[import (?P<stamp>[0-9a-f]{8})\])?", re.DOTALL
)


def _source(part: Wanted, file: str) -> str:
    return f"{file}, row {part.row}: {compressed(part.references) or 'no references'}"


def lines(name: str, part: Wanted, file: str, pad: str) -> Iterator[str]:
    """A component, rated or of unknown rate, as lines of a design."""
    yield f"{pad}{quoted(name)}:\n"
    for key, value in content(part, file).items():
        text = rate_text(part, f"{pad}  ") if key in RATED_BY else line(key, value)
        yield f"{pad}  {text}\n"


def rate_text(part: Wanted, pad: str) -> str:
    """Return the lines on where its rate is from, or why it is unknown; the first without its indentation."""
    if part.rating and part.rating.entry:
        return hazard_line(part.rating, "part")
    if part.rating:
        return hazard_text(part.rating, pad)
    return f"{line('rate', UNKNOWN)}{NEEDS}{printable(part.needs)}"


def line(key: str, value: object) -> str:
    """Return a key and its value as a line of a design."""
    return f"{key}: {value if isinstance(value, int) else quoted(str(value))}"


def hazard_text(rating: Rating, pad: str) -> str:
    """Return the model and its inputs as lines; the first without its indentation."""
    return f"hazard:\n{pad}  {hazard_line(rating, 'model')}\n{pad}  {inputs_text(rating, f'{pad}  ')}"


def hazard_line(rating: Rating, key: str) -> str:
    """Return the model's line, or that of an input, with why it is assumed."""
    why = rating.assumed.get(key)
    text = line(key, rating.model if key == "model" else rating.inputs[key])
    return f"{text}{ASSUMED}{why}" if why else text


def inputs_text(rating: Rating, pad: str) -> str:
    """Return all inputs, line by line; the first without its indentation."""
    if not rating.inputs:
        return "inputs: {}"
    return "\n".join(("inputs:", *(f"{pad}  {hazard_line(rating, name)}" for name in rating.inputs)))


def differ(one: object, other: object) -> bool:
    """Whether two values differ as a design writes them: 4 equals '4'."""
    return stamp({"": one}) != stamp({"": other})


def short(value: object) -> str:
    """Return a value of a component as people would read it."""
    if isinstance(value, Mapping):
        inputs = value.get("inputs")
        model = str(value.get("model", "")).rpartition(".")[2]
        value = f"{model} {', '.join(map(str, inputs.values()))}" if isinstance(inputs, dict) else model
    text = str(value)
    return text if len(text) <= 80 else text[:79] + "…"
