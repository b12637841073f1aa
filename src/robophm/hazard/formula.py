"""A user's own equation as a hazard model: ``base * exp(0.05 * (temperature - 25))``.

Every variable is a number in the unit that its declaration states, and so is the result; the arithmetic itself knows
no units, so constants in the text are in those units too.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from robophm.core.errors import ModelError, UnitError
from robophm.core.expression import Expression, check_name, read
from robophm.core.table import Source
from robophm.core.units import conversion
from robophm.hazard.model import Array, Factor, Model, Range

MOST_VARIABLES = 50


def _value(expression: Expression, text: str, unit: Factor, **values: Array) -> Factor:
    return Factor("f", expression(values), text) * unit


def formula_model(text: str, unit: str, variables: Mapping[str, Range], source: str, inside: str = "1/h") -> Model:
    """A hazard model of an equation whose result is in ``unit``; the model's own is in ``inside``.

    Raises ModelError for what is no equation, an unknown or unused variable, and UnitError for a unit that is no rate.
    """
    if len(variables) > MOST_VARIABLES:
        raise ModelError(f"formula has {len(variables)} variables; expected at most {MOST_VARIABLES}")
    for name in variables:
        check_name(name)
    expression = read(text, variables)
    unused = [name for name in variables if name not in expression.names]
    if unused:
        raise ModelError(f"formula does not use its variable '{unused[0]}'; expected every one in it")
    if not unit:
        raise UnitError("formula has no unit; expected e.g. '1/h'")
    scale = conversion(unit, inside).scale

    function = partial(_value, expression, text, Factor("unit", scale, f"{unit} to {inside}"))
    # the key of a stress is made of name and formula: both say all that the result depends on
    said = f"λ = {' '.join(text.split())} [{unit}]"
    return Model(
        "formula", said, Source(source, "–", "–", "as stated in the design"), inside, dict(variables), function
    )
