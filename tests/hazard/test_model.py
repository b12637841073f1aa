"""A declared model: factors that remember, checks that a declaration makes."""

from dataclasses import replace

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.core.table import Source
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import BLOCK, Choice, Factor, Range, acceleration, hazard_model

from .handbooks.adapter import plausible

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
    return (
        Factor("a", 2.0 if kind == "bad" else 1.0)
        * (Factor("b", load, "nothing said", outside=np.asarray(load) > 5) + more)
        * 3
    )


@pytest.mark.parametrize(
    "said", ["rack-panel", "rack panel", "rack_panel", "Rack Panel", "RACK-PANEL", " rack  panel ", "rack_-panel"]
)
def test_an_option_is_meant_however_its_words_are_put_together(said):
    for option in ("rack-panel", "rack panel", "rack_panel"):
        assert Choice((option, "rectangular"), aliases={"d-sub": option}).option(said) == option


@pytest.mark.parametrize("said", ["D-sub", "d sub", "D_SUB"])
def test_another_name_of_an_option_is_read_like_the_option(said):
    assert Choice(("rack-panel", "rectangular"), aliases={"d-sub": "rack-panel"}).option(said) == "rack-panel"


@pytest.mark.parametrize("said", ["rackpanel", "rack", "panel", "rack panel 2", "", " ", "-", "dsub"])
def test_what_no_option_is_called_means_none(said):
    assert Choice(("rack-panel", "rectangular"), aliases={"d-sub": "rack-panel"}).option(said) is None


def test_a_word_that_may_mean_two_options_is_refused_with_both():
    """As it stands an option is itself; written otherwise it may be either."""
    choice = Choice(("power_rectifier", "rectifier_old"), aliases={"Power-Rectifier": "rectifier_old"})
    two = replace(model, inputs={**model.inputs, "kind": choice})
    assert two.settle({"load": "4 W", "kind": "power_rectifier"})["kind"] == "power_rectifier"
    assert choice.option("power rectifier") is None
    with pytest.raises(ModelError, match=r"not one of .*; it may be 'power_rectifier' or 'rectifier_old'"):
        two.settle({"load": "4 W", "kind": "power rectifier"})
    with pytest.raises(ModelError, match=r"kind 'power rectifer' is not .*; did you mean 'power_rectifier'"):
        two.settle({"load": "4 W", "kind": "power rectifer"})


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


@pytest.mark.parametrize(
    ("kind", "given", "name", "answers"),
    [
        ("capacitor", {"style": "CDR"}, "series_resistance", False),
        ("diode_low_frequency", {"kind": "zener"}, "voltage", False),
        ("microcircuit.processor", {}, "case_temperature", True),
        ("microcircuit.processor", {}, "screening_points", False),
        ("microcircuit.processor", {"quality": "custom", "screening_points": 80}, "screening_points", True),
        ("coil", {}, "power_loss", False),
        ("coil", {"rise_from": "39010/1C"}, "temperature_rise", False),
    ],
)
def test_what_is_left_open_counts_or_does_not(kind, given, name, answers):
    of = handbook_model(f"mil_hdbk_217f.{kind}")
    assert of.answers_to(name, of.settle({**plausible(of.name), **given})) == answers


def test_what_counts_only_with_others_counts():
    """A step of a shaft has a fillet, and without it there is no answer at all."""
    shaft = handbook_model("nswc_11.shaft")
    plain = {k: v for k, v in plausible(shaft.name).items() if not k.startswith(("step", "fillet", "groove"))}
    assert shaft.answers_to("step_diameter", shaft.settle(plain))
    assert model.answers_to("extra", {"load": 4.0, "kind": "good"})


def test_a_combination_outside_is_an_error_in_a_design_and_a_flag_live():
    with pytest.raises(ModelError, match="b: nothing said: outside the handbook's range"):
        model.settle({"load": "6 W"})
    value, extrapolated = model.evaluate({"load": np.array([4.0, 6.0, 11.0]), "kind": "good"})
    assert value.tolist() == [12.0, 18.0, 33.0]
    assert extrapolated.tolist() == [False, True, True]


def test_a_function_that_takes_something_else_is_not_declared():
    with pytest.raises(TypeError, match=r"declared \{'x'\}, takes \{'y'\}"):
        hazard_model(source=SOURCE, inputs={"x": Range(0, 1, "", "x")})(lambda y: Factor("y", y))
    with pytest.raises(TypeError, match="no docstring, whose first line is the formula"):
        acceleration(source=SOURCE, inputs={"x": Range(0, 1, "", "x")})(lambda x: Factor("x", x))


def test_many_samples_are_taken_in_blocks():
    """As many as one block, one more, and more blocks: each as it is in a handful, in its place."""
    capacitor = handbook_model("mil_hdbk_217f.capacitor")
    design = capacitor.settle({
        "style": "CDR", "capacitance": "1 uF", "temperature": "25 degC", "dc_voltage": "10 V", "rated_voltage": "50 V",
        "environment": "GM",
    })  # fmt: skip
    random = np.random.default_rng(8)
    for size in (BLOCK, BLOCK + 1, 2 * BLOCK + 7):
        samples = {"temperature": random.uniform(-80, 170, size), "dc_voltage": random.uniform(-10, 60, size)}
        value, extrapolated = capacitor.evaluate({**design, **samples})
        assert value.shape == extrapolated.shape == (size,)
        for start in (0, BLOCK - 5, size - 10):
            few = slice(start, start + 10)
            alone = capacitor.evaluate({**design, **{name: line[few] for name, line in samples.items()}})
            assert value[few].tolist() == alone.value.tolist()
            assert extrapolated[few].tolist() == alone.extrapolated.tolist()
