"""A declared model: factors that remember, checks that a declaration makes."""

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.core.table import Source
from robophm.hazard.model import Choice, Factor, Range, acceleration, hazard_model

SOURCE = Source("Handbook", "1.2", "3", "made up")


@hazard_model(
    source=SOURCE,
    inputs={
        "load": Range(0.0, 10.0, "W", "load"),
        "kind": Choice(("good", "bad"), "kind", default="good"),
        "extra": Range(0.0, 1.0, "", "extra", required=False),
    },
)
def model(load, kind, extra=None):
    """λ = a · (b + c)

    The formula is the first line.
    """
    more = Factor("c", 0.0 if extra is None else extra)
    return Factor("a", 2.0 if kind == "bad" else 1.0) * (Factor("b", load, outside=np.asarray(load) > 5) + more) * 3


def test_products_and_sums_remember_their_parts():
    explained = model.explain({"load": 4.0, "kind": "bad", "extra": 0.5})
    assert explained.value == 27.0
    assert explained.symbol == "·"
    assert [part.symbol for part in explained.parts] == ["a", "+", "3"]
    assert [(leaf.symbol, leaf.value) for leaf in explained.leaves()] == [("a", 2), ("b", 4), ("c", 0.5), ("3", 3)]


def test_declared_names_and_units():
    assert model.formula == "λ = a · (b + c)"
    assert model.unit == "1/h"
    assert list(model.numbers) == ["load", "extra"]
    assert model.expected("kind") == "one of good, bad"
    assert model.expected("load") == "0 … 10 W"


def test_defaults_and_what_is_optional():
    assert model.settle({"load": "4 W"}) == {"load": 4.0, "kind": "good"}
    assert model.settle({"load": "4000 mW", "kind": "bad", "extra": 1}) == {"load": 4.0, "kind": "bad", "extra": 1.0}


def test_a_combination_outside_is_an_error_in_a_design_and_a_flag_live():
    with pytest.raises(ModelError, match="b is outside the handbook's range"):
        model.settle({"load": "6 W"})
    value, extrapolated = model.evaluate({"load": np.array([4.0, 6.0, 11.0]), "kind": "good"})
    assert value.tolist() == [12.0, 18.0, 33.0]
    assert extrapolated.tolist() == [False, True, True]


def test_a_function_that_takes_something_else_is_not_declared():
    with pytest.raises(TypeError, match=r"declared \{'x'\}, takes \{'y'\}"):
        hazard_model(source=SOURCE, inputs={"x": Range(0, 1, "", "x")})(lambda y: Factor("y", y))
    with pytest.raises(TypeError, match="no docstring, whose first line is the formula"):
        acceleration(source=SOURCE, inputs={"x": Range(0, 1, "", "x")})(lambda x: Factor("x", x))
