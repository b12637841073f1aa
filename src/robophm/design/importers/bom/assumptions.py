"""The source of each input of a model: the list itself, an assumption about all parts, or one about a kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from robophm.core.units import quantity
from robophm.design.importers.bom.parts import Recognised
from robophm.hazard.environments import environment


@dataclass(frozen=True)
class Assumptions:
    """Assumptions for every part of which the list says nothing else."""

    temperature: str = "40 degC"
    """Temperature around the parts."""
    stress: float = 0.5
    """Applied over rated voltage, current or power."""
    rise: str = "10 K"
    """Rise of what warms itself, junctions and windings, above its surroundings."""
    environment: str = "GM"
    """Symbol of MIL-HDBK-217F Table 3-2, or a word for one; a mobile robot is GM by the handbook's definition."""
    quality: str | None = None
    """A level, of the models that know it; None for each model's own default, its lowest or 'commercial'."""
    board_quality: str | None = None
    """The quality that the robot or module of these parts states, or will state, and that its parts inherit."""

    def __post_init__(self) -> None:
        """Words are taken as their symbol. Raises ModelError for an environment that there is none of."""
        object.__setattr__(self, "environment", environment(self.environment))


OF_ALL = frozenset({
    "temperature", "case_temperature", "temperature_rise", "power", "voltage", "dc_voltage", "load_current",
    "required_optical_power", "environment", "quality",
})  # fmt: skip
"""Inputs that are as assumed of all parts, where the list says nothing else."""


class TooLittle(Exception):  # noqa: N818  no error: what it says is what the part still needs
    """Raised where the list says too little of a part for a rate; its text says what is missing."""


Entry = Callable[[Recognised, Assumptions], tuple[str, str] | None]
"""An input's text, and why it is assumed, '' where the list says it; None where this part does not need it."""


@dataclass(frozen=True)
class Rule:
    """The rule by which a kind is rated: its model, and the source of each input."""

    model: str
    entries: Mapping[str, Entry]
    taken_for: str = ""
    """The kind as which another kind is rated, for want of a model of its own."""

    def inputs(self, part: Recognised, assumed: Assumptions) -> tuple[dict[str, str], dict[str, str]]:
        """Return the inputs of a part, and why those that are assumed are. Raises TooLittle, or UnitError for a
        fact."""
        inputs: dict[str, str] = {}
        reasons = {"model": f"taken for {self.taken_for}"} if self.taken_for else {}
        for name, entry in self.entries.items():
            if found := entry(part, assumed):
                inputs[name], why = found
                if why:
                    reasons[name] = why
        return inputs, reasons


def assume(text: str, why: str) -> Entry:
    """Return an entry that is the same for all parts of a kind."""
    return lambda part, assumed: (text, why)


def required_in_list(fact: str, expected: str) -> Entry:
    """Return an entry that the list has to state. It raises TooLittle where the list does not."""

    def entry(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
        if fact not in part.facts:
            raise TooLittle(f"the list does not say {expected}")
        return part.facts[fact], part.concluded.get(fact, "")

    return entry


def said_or(fact: str, otherwise: str, why: str) -> Entry:
    """Return an entry that the list states, or else a stated assumption."""

    def entry(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
        return (part.facts[fact], part.concluded.get(fact, "")) if fact in part.facts else (otherwise, why)

    return entry


def by_type(options: Mapping[str, str], otherwise: str, why: str) -> Entry:
    """Return an entry that is the model's word for the part's type, or else a stated assumption."""

    def entry(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
        kind = part.facts.get("type", "")
        return (options[kind], part.concluded.get("type", "")) if kind in options else (otherwise, why)

    return entry


def at_most(fact: str, unit: str, most: float, otherwise: Entry) -> Entry:
    """Return an entry that the list states, cut to the largest number that the handbook has."""

    def entry(part: Recognised, assumed: Assumptions) -> tuple[str, str] | None:
        text = part.facts.get(fact)
        if text is None or quantity(text, unit) <= most:
            return otherwise(part, assumed)
        return f"{most:.10g} {unit}".strip(), f"the most that the handbook has; the list says {text}"

    return entry


def share(fact: str, unit: str, otherwise: str = "") -> Entry:
    """Return an entry for an applied voltage, current or power: the assumed share of the rated one."""

    def entry(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
        rated = quantity(part.facts.get(fact, otherwise), unit)
        return f"{assumed.stress * rated:.6g} {unit}", f"{assumed.stress:g} of the rated"

    return entry


def around(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    """Return the temperature around the parts."""
    return assumed.temperature, "around it"


def junction(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    """Return the junction's own temperature, at which no power warms it further."""
    warm = quantity(assumed.temperature, "degC") + quantity(assumed.rise, "K")
    return f"{warm:.6g} degC", f"of the junction, {assumed.rise} above what is around it"


def rise(part: Recognised, assumed: Assumptions) -> tuple[str, str]:
    """Return how much warmer windings are than what is around them."""
    return assumed.rise, "above what is around it"


NO_MORE_HEAT = assume("0 W", "in the temperature already")
