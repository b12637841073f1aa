"""Which hazard model rates a kind of part, and its inputs from what is known. The only place that names models."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robophm.core.errors import ModelError, UnitError, nearest
from robophm.core.units import quantity
from robophm.design.bom.parts import Recognised
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.handbooks.mil_hdbk_217f import ENVIRONMENTS
from robophm.hazard.model import Array, Choice


@dataclass(frozen=True)
class Assumptions:
    """What holds for every part of which the list says nothing else."""

    temperature: str = "40 degC"
    """Around the parts."""
    stress: float = 0.5
    """Applied by rated voltage or power."""
    rise: str = "10 K"
    """Of what warms itself, junctions and windings, above what is around it."""
    environment: str = "GM"
    """Symbol of MIL-HDBK-217F Table 3-2; a mobile robot is GM by the handbook's definition."""
    quality: str | None = None
    """A level, of the models that know it; None for each model's own default, its lowest or 'commercial'."""


@dataclass(frozen=True)
class Rating:
    """A model and its inputs, as the design has them, and settled for evaluation."""

    model: str
    inputs: Mapping[str, str]
    assumed: tuple[str, ...]
    """Inputs that the list does not say, and what was concluded for them."""
    settled: Mapping[str, str | float]


class TooLittle(Exception):  # noqa: N818  no error: what it says is what the part still needs
    """Why a part has no rate."""


Inputs = dict[str, str]
_Rule = Callable[[Mapping[str, str], Assumptions], tuple[Inputs, list[str]]]


def _known(facts: Mapping[str, str], name: str, expected: str) -> str:
    if name not in facts:
        raise TooLittle(f"the list does not say {expected}")
    return facts[name]


def _capacitor(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    kind = _known(facts, "type", "whether it is ceramic, electrolytic, tantalum or film")
    through = facts.get("mounting") == "through hole"
    ceramic = ("CC" if facts.get("dielectric") == "C0G" else "CK") if through else "CDR"
    styles = {
        "ceramic": ceramic, "electrolytic": "CE", "tantalum": "CSR" if through else "CWR", "film": "CFR", "paper": "CP",
        "mica": "CM", "variable": "CV",
    }  # fmt: skip
    if kind not in styles:
        raise TooLittle(f"the handbook has no {kind} capacitors")
    inputs = {"style": styles[kind], "capacitance": _known(facts, "capacitance", "its capacitance")}
    guesses = [f"style {inputs['style']}"]
    inputs |= _voltages("dc_voltage", facts, assumed, guesses) | {"temperature": assumed.temperature}
    guesses.append("temperature")
    if styles[kind] in ("CWR", "CSR"):
        inputs["series_resistance"] = "0.1 ohm/V"
        guesses.append("series_resistance, the least")
    return inputs, guesses


def _voltages(name: str, facts: Mapping[str, str], assumed: Assumptions, guesses: list[str]) -> Inputs:
    """The rated voltage and its assumed share; formulas take their ratio alone."""
    rated = facts.get("rated_voltage")
    if rated is None:
        rated = "1 V"
        guesses.append(f"rated_voltage, a stand-in: only its ratio to {name} counts")
    guesses.append(name)
    return {name: _share(rated, assumed.stress, "V"), "rated_voltage": rated}


def _resistor(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    styles = {
        "metal film": "RN", "carbon film": "RL", "carbon composition": "RC", "wirewound": "RW", "thick film": "RM",
        "thin film": "RM", "network": "RZ",
    }  # fmt: skip
    surface = facts.get("mounting") == "surface" and facts.get("type") not in ("wirewound", "network")
    kind = "thick film" if surface else _known(facts, "type", "whether it is film, wirewound or composition")
    rated = _known(facts, "rated_power", "its rated power")
    inputs = {"style": styles[kind], "power": _share(rated, assumed.stress, "W"), "rated_power": rated}
    return inputs | {"temperature": assumed.temperature}, [f"style {styles[kind]}", "power", "temperature"]


def _network(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    return _resistor({**facts, "type": "network"}, assumed)


def _junction(assumed: Assumptions) -> Inputs:
    """The junction's own temperature, at which no power warms it further."""
    warm = quantity(assumed.temperature, "degC") + quantity(assumed.rise, "K")
    return {"temperature": f"{warm:.6g} degC", "power": "0 W"}


def _diode(kind: str, guessed: bool = False) -> _Rule:
    def rule(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
        inputs = {"kind": kind, "contact": "bonded"} | _junction(assumed)
        guesses = [*([f"kind {kind}"] if guessed else []), "contact", "temperature of the junction"]
        if kind in ("general_purpose_analog", "power_rectifier_schottky"):
            inputs |= _voltages("voltage", facts, assumed, guesses)
        return inputs, guesses

    return rule


def _optoelectronic(kind: str) -> _Rule:
    def rule(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
        guesses = [] if kind == "led" else [f"kind {kind}"]
        return {"kind": kind} | _junction(assumed), [*guesses, "temperature of the junction"]

    return rule


def _coil(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    inputs = {"kind": "fixed", "temperature": assumed.temperature, "temperature_rise": assumed.rise}
    return inputs, ["temperature", "temperature_rise"]


def _crystal(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    return {"frequency": _known(facts, "frequency", "its frequency")}, []


def _socket(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    return {"style": "IC", "contacts": _known(facts, "pins", "how many contacts it has")}, ["all contacts active"]


def _as_it_is(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
    return {}, []


def _needs(what: str) -> _Rule:
    """Of a kind whose model asks for what no parts list says."""

    def rule(facts: Mapping[str, str], assumed: Assumptions) -> tuple[Inputs, list[str]]:
        raise TooLittle(f"the list does not say {what}")

    return rule


def _share(rated: str, stress: float, unit: str) -> str:
    return f"{stress * quantity(rated, unit):.6g} {unit}"


MODELS: Mapping[str, tuple[str, _Rule]] = {
    "capacitor": ("mil_hdbk_217f.capacitor", _capacitor),
    "resistor": ("mil_hdbk_217f.resistor", _resistor),
    "resistor network": ("mil_hdbk_217f.resistor", _network),
    "diode": ("mil_hdbk_217f.diode_low_frequency", _diode("general_purpose_analog", guessed=True)),
    "schottky diode": ("mil_hdbk_217f.diode_low_frequency", _diode("power_rectifier_schottky")),
    "rectifier": ("mil_hdbk_217f.diode_low_frequency", _diode("power_rectifier_schottky")),
    "zener diode": ("mil_hdbk_217f.diode_low_frequency", _diode("voltage_regulator_zener")),
    "tvs diode": ("mil_hdbk_217f.diode_low_frequency", _diode("transient_suppressor_varistor")),
    "varistor": ("mil_hdbk_217f.diode_low_frequency", _diode("transient_suppressor_varistor")),
    "led": ("mil_hdbk_217f.optoelectronic", _optoelectronic("led")),
    "optocoupler": ("mil_hdbk_217f.optoelectronic", _optoelectronic("isolator_phototransistor_single")),
    "inductor": ("mil_hdbk_217f.coil", _coil),
    "ferrite bead": ("mil_hdbk_217f.coil", _coil),
    "crystal": ("mil_hdbk_217f.crystal", _crystal),
    "fuse": ("mil_hdbk_217f.fuse", _as_it_is),
    "socket": ("mil_hdbk_217f.connector_socket", _socket),
    "solid state relay": ("mil_hdbk_217f.relay_solid_state", _as_it_is),
    "microcircuit": ("general.constant", _needs("its technology and complexity, and no maker's rate is in it")),
    "transistor": ("general.constant", _needs("whether it is bipolar or a FET, and its ratings")),
    "connector": ("mil_hdbk_217f.connector", _needs("what current its contacts carry and how often it is mated")),
    "relay": ("mil_hdbk_217f.relay", _needs("its construction, contacts and how often it switches")),
    "switch": ("mil_hdbk_217f.switch", _needs("its contacts and their load")),
    "thermistor": ("mil_hdbk_217f.resistor", _needs("its dissipated power")),
    "potentiometer": ("mil_hdbk_217f.resistor", _needs("its construction")),
    "transformer": ("mil_hdbk_217f.transformer", _needs("its kind and losses")),
    "bipolar transistor": ("mil_hdbk_217f.transistor_bipolar_low_frequency", _needs("its rated power and voltage")),
    "fet": ("mil_hdbk_217f.transistor_fet_low_frequency", _needs("its rated power and what it is used for")),
    "thyristor": ("mil_hdbk_217f.thyristor", _needs("its rated current and voltage")),
}
"""By kind; a model that is not installed counts as none."""


class Rater:
    """Rates parts under the same assumptions; equal parts are settled once.

    Raises ModelError where the environment or the quality is none that any model knows.
    """

    def __init__(self, assumed: Assumptions) -> None:
        self.assumed = assumed
        self.installed = set(handbook_models())
        self.settled: dict[tuple[str, ...], dict[str, str | float]] = {}
        if assumed.environment not in ENVIRONMENTS:
            hint = nearest(assumed.environment, ENVIRONMENTS)
            raise ModelError(f"environment '{assumed.environment}' is no symbol of Table 3-2{hint}")
        used = {name for name, _ in MODELS.values()} & self.installed
        levels = [choice for name in used if isinstance(choice := handbook_model(name).inputs.get("quality"), Choice)]
        if assumed.quality and not any(choice.option(assumed.quality) for choice in levels):
            hint = nearest(
                assumed.quality, [level for choice in levels for level in (*choice.options, *choice.aliases)]
            )
            raise ModelError(f"quality '{assumed.quality}' is a level of no model{hint}")

    def rating(self, part: Recognised) -> Rating:
        """The model of a part with its inputs. Raises TooLittle where there is none, or it needs more."""
        if part.kind == "no part":
            raise TooLittle("it is no electrical part, for which no handbook has a model")
        if not part.kind:
            raise TooLittle("what kind of part it is, is not clear from its reference and words")
        name, rule = MODELS.get(part.kind, ("", None))
        if rule is None or name not in self.installed:
            raise TooLittle(f"there is no model of a {part.kind}")
        try:
            inputs, guesses = rule(part.facts, self.assumed)
        except UnitError as error:
            raise TooLittle(str(error)) from None
        model = handbook_model(name)
        level, choices = self.assumed.quality, model.inputs.get("quality")
        if level and isinstance(choices, Choice):
            if choices.option(level) is not None:
                inputs["quality"] = level
            elif choices.default:
                guesses.append(f"quality {choices.default}: this model knows no {level}")
        given: dict[str, Any] = dict(inputs)
        if "environment" in model.inputs:
            given["environment"] = self.assumed.environment
        key = (name, *(f"{key}={value}" for key, value in given.items()))
        if key not in self.settled:
            try:
                self.settled[key] = model.settle(given)
            except (ModelError, UnitError) as error:
                raise TooLittle(str(error)) from None
        return Rating(name, inputs, tuple(dict.fromkeys((*part.because, *guesses))), self.settled[key])


def rates(ratings: Sequence[Rating]) -> Array:
    """The hazard rate of one part of each [1/h]; parts that share a model and its words are rated at once."""
    result = np.zeros(len(ratings))
    groups: dict[tuple[Any, ...], list[int]] = defaultdict(list)
    for i, rating in enumerate(ratings):
        words = ((name, value if isinstance(value, str) else None) for name, value in rating.settled.items())
        groups[(rating.model, *words)].append(i)
    for (name, *_), members in groups.items():
        first = ratings[members[0]].settled
        inputs = {
            key: value if isinstance(value, str) else _column(ratings, members, key) for key, value in first.items()
        }
        result[members] = handbook_model(name).evaluate(inputs).value
    return result


def _column(ratings: Sequence[Rating], members: Iterable[int], key: str) -> Array:
    return np.array([ratings[i].settled[key] for i in members], dtype=float)
