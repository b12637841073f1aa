"""How well parts are made, in words that hold for a whole board: what each model's own quality levels make of them."""

from __future__ import annotations

import re
from collections.abc import Mapping

from robophm.core.errors import ModelError, nearest
from robophm.core.spread import Spread
from robophm.core.table import Source
from robophm.hazard.model import Choice, Model

VITA = Source(
    "ANSI/VITA 51.1-2013 (R2018)",
    "2.1",
    "–",
    "single source: a public program's account of its rules; the standard's own text was not to be had",
)

UNKNOWN = "unknown"
"""The word for a quality that nobody knows."""

QUALITIES: Mapping[str, str] = {
    "commercial": "as anybody buys them: the handbook's commercial, plastic or lowest level, with up to ten times "
    "the rate of its military one; it is of 1995, and pessimistic",
    "known pedigree": "commercial, of known makers and through known hands, so that none is counterfeit: by ANSI/VITA "
    "51.1 as good as military ones, and chip resistors, ceramic chip and solid tantalum capacitors ten times as good",
    "military": "by military specification and qualified to it",
    UNKNOWN: "nobody has said how they were bought: between known pedigree and commercial, taken as 5 and 95 % of "
    "what the rate may be, for all parts of the board alike",
}
"""The words for the quality of all parts of a robot or board, each with its meaning."""

_MIL = "mil_hdbk_217f."
_TEN_TIMES = {
    f"{_MIL}capacitor": frozenset({"CDR", "CKR", "CSR", "CLR", "CWR"}),
    f"{_MIL}resistor": frozenset({"RM", "RZ"}),
}
"""Rules 2.1.4-1 and 2.1.5-1: πQ 0.1; of CWR from 0.1 µF on, which those of fewer are not told from here."""

_NOT_IN_VITA = frozenset({f"{_MIL}{name}" for name in ("coil", "transformer", "circuit_breaker", "connector_socket")})
"""Models of parts that the rules of ANSI/VITA 51.1 do not mention, so that their own level stays."""

_MILITARY = ("JANTX", "MIL-SPEC", "M", "B")
"""The level by which πQ is 1 (of relays 1.5): the first that a model has."""


def quality(said: str) -> str:
    """One of ``QUALITIES`` as somebody writes it. Raises ModelError with all that there are."""
    folded = re.sub(r"[\s_-]+", " ", said.strip().casefold())
    if folded not in QUALITIES:
        hint = nearest(folded, QUALITIES)
        raise ModelError(
            f"'{said:.60}' is no quality of a whole board{hint}; a level of one model is an input of its own"
        )
    return folded


def level(model: Model, said: str, inputs: Mapping[str, object]) -> str | None:
    """The level of a model that a word means for a part with these inputs; None where its own stays."""
    choices = model.inputs.get("quality")
    if not isinstance(choices, Choice):
        return None
    if option := choices.option(said):
        return option
    if said.casefold() not in ("known pedigree", "military"):
        return None
    if said.casefold() == "known pedigree":
        if model.name in _NOT_IN_VITA:
            return None
        style = model.inputs.get("style")
        if isinstance(style, Choice) and style.option(str(inputs.get("style"))) in _TEN_TIMES.get(model.name, ()):
            return "R"
    return next((option for option in _MILITARY if option in choices.options), None)


def spread_of_unknown(model: Model, settled: Mapping[str, str | float]) -> Spread | None:
    """The factor of a rate, at the level of settled inputs, that an unknown quality leaves open.

    Its ends are the model's rates of known pedigree and of that level; None where the model has but one of the two.
    """
    best, here = level(model, "known pedigree", settled), settled.get("quality")
    if best is None or best == here:
        return None
    factor = float(model.evaluate({**settled, "quality": best}).value / model.evaluate(settled).value)
    return Spread(min(factor, 1.0), max(factor, 1.0)) if factor != 1.0 else None


def explained(said: str) -> str:
    """A word and what it means, in a sentence's part."""
    return f"{said} ({QUALITIES[said]})"
