"""Rating of parts: the model of each kind, its inputs as stated or assumed, and the hazard rates."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robophm.core.errors import ModelError, UnitError, nearest
from robophm.core.spread import Spread
from robophm.design.importers.bom.assumptions import Assumptions, TooLittle
from robophm.design.importers.bom.by_library import of_library, stated_rate
from robophm.design.importers.bom.kinds import DEVICE, is_guess
from robophm.design.importers.bom.parts import Recognised
from robophm.design.importers.bom.rules import RULES
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Array, Choice
from robophm.hazard.qualities import QUALITIES, UNKNOWN, level, spread_of_unknown
from robophm.parts import Entry
from robophm.parts import part as library_part


@dataclass(frozen=True)
class Rating:
    """A model and its inputs, as the design has them, and settled for evaluation."""

    model: str
    """Name of its hazard model; "" where it is rated as an entry of the library of parts."""
    inputs: Mapping[str, str]
    assumed: Mapping[str, str]
    """Inputs that the list does not say, and why they are what they are."""
    settled: Mapping[str, str | float]
    spread: Spread | None = None
    """The factor that a quality of the board that is unknown leaves open; None where it leaves none."""
    entry: Entry | None = None
    """The entry of the library that it is rated as; None where a model rates it."""

    @property
    def by(self) -> str:
        """Return the name of the model that rates it, or "part: name" of an entry of the library."""
        return f"part: {self.entry.name}" if self.entry else self.model


BEYOND = {
    "mechanical part": "it is a mechanical part: state its rate, or a model of nswc_11 with its loads",
    DEVICE: "it is a whole device, not one electronic part: state its maker's figure, or its own parts",
    "cable": "it is a cable, of which no handbook has a model: state its rate",
}
"""The reasons why things that are no electronic parts are not rated as such."""


class Rater:
    """Rates parts under the same assumptions; equal inputs are settled once.

    Raises ModelError where the quality is none that any model knows.
    """

    def __init__(self, assumed: Assumptions) -> None:
        self.assumed = assumed
        self.settled: dict[tuple[str, ...], tuple[dict[str, str | float], Spread | None]] = {}
        models = [handbook_model(name) for name in dict.fromkeys(rule.model for rule in RULES.values())]
        levels = [choice for model in models if isinstance(choice := model.inputs.get("quality"), Choice)]
        board = assumed.quality and assumed.quality.casefold() in QUALITIES
        if assumed.quality and not board and not any(choice.option(assumed.quality) for choice in levels):
            known = [level for choice in levels for level in (*choice.options, *choice.aliases)]
            raise ModelError(f"quality '{assumed.quality}' is a level of no model{nearest(assumed.quality, known)}")

    def rating(self, part: Recognised) -> Rating:
        """The model of a part with its inputs. Raises TooLittle where there is none, or it needs more."""
        if not part.kind:
            raise TooLittle("what kind of part it is, is not clear from its reference and words")
        if part.kind in BEYOND:
            raise TooLittle(BEYOND[part.kind])
        if found := of_library(part):
            name, why = found
            return Rating("", {"part": name}, {"part": why}, {}, entry=library_part(name))
        if part.kind not in RULES:
            raise TooLittle(f"no handbook has a model of a {part.kind}")
        rule = RULES[part.kind]
        model = handbook_model(rule.model)
        try:
            inputs, assumed = rule.inputs(part, self.assumed)
            if is_guess(why := part.concluded.get("kind", "")):
                assumed["model"] = "; ".join(filter(None, (f"{part.kind} is {why}", assumed.get("model", ""))))
            said, choices = self.assumed.quality, model.inputs.get("quality")
            if said and isinstance(choices, Choice):
                if known := level(model, said, inputs):
                    inputs["quality"] = said if choices.option(said) else known
                elif choices.default:
                    inputs["quality"], assumed["quality"] = choices.default, f"this model knows no {said}"
            given: dict[str, Any] = dict(inputs)
            board = self.assumed.board_quality
            if board and "quality" not in inputs and (known := level(model, board, inputs)):
                given["quality"] = known
            if "environment" in model.inputs:
                given["environment"] = self.assumed.environment
            key = (rule.model, *(f"{name}={text}" for name, text in given.items()))
            if key not in self.settled:
                settled = model.settle(given)
                unknown = board == UNKNOWN and "quality" not in inputs
                self.settled[key] = settled, spread_of_unknown(model, settled) if unknown else None
            return Rating(rule.model, inputs, assumed, *self.settled[key])
        except (ModelError, UnitError) as error:
            raise TooLittle(str(error)) from None


def rates(ratings: Sequence[Rating]) -> Array:
    """The hazard rate of one part of each [1/h]; parts that share a model and its words are rated at once.

    Where the quality is unknown it is the mean of what the rate may be.
    """
    result = np.zeros(len(ratings))
    groups: dict[tuple[Any, ...], list[int]] = defaultdict(list)
    for i, rating in enumerate(ratings):
        if rating.entry:
            result[i] = stated_rate(rating.entry)
            continue
        words = ((name, value if isinstance(value, str) else None) for name, value in rating.settled.items())
        groups[(rating.model, *words)].append(i)
    for (name, *_), members in groups.items():
        first = ratings[members[0]].settled
        inputs = {
            key: value if isinstance(value, str) else _column(ratings, members, key) for key, value in first.items()
        }
        result[members] = handbook_model(name).evaluate(inputs).value
    result *= [one.spread.mean if one.spread else 1.0 for one in ratings]
    return result


def _column(ratings: Sequence[Rating], members: Iterable[int], key: str) -> Array:
    return np.array([ratings[i].settled[key] for i in members], dtype=float)
