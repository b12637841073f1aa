"""Hazard rates of handbooks: ``robophm.rate`` and ``robophm.models``."""

from __future__ import annotations

from robophm.core.argument_checks import instance
from robophm.core.errors import ModelError, PlugError
from robophm.hazard.answer import Answer, answer
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Model
from robophm.hazard.search import find_models


def rate(model: str, /, **inputs: str | float) -> Answer:
    """The hazard rate that a handbook's model gives for a part, with every factor and all that was assumed.

    Inputs as ``robophm rate --set`` takes them: ``rate("mil_hdbk_217f.fuse", environment="vehicle").value`` [1/h].
    Raises PlugError for an unknown model, ModelError or UnitError for inputs that cannot be, each with the nearest
    known name.
    """
    chosen = handbook_model(instance(model, str, "model", "a name, e.g. 'mil_hdbk_217f.capacitor'", PlugError))
    for name, given in inputs.items():
        instance(given, str | int | float, name, "text such as '60 degC', or a plain number", ModelError)
    return answer(chosen, inputs)


def models(kind: str | None = None) -> dict[str, Model]:
    """The hazard models and accelerations of a kind of part, such as "chip resistor", by name; of none all.

    Raises PlugError, with the nearest known word, where there is none of that kind.
    """
    return find_models(None if kind is None else instance(kind, str, "kind", "words, e.g. 'motor'", PlugError))
