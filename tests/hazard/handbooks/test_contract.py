"""What every hazard model promises, whatever its file. A new model adds its plausible inputs to the folder."""

import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError, PlugError, UnitError
from robophm.core.units import quantity
from robophm.hazard.environments import ENVIRONMENTS
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice, Note, Range

FOLDER = Path(__file__).parents[2] / "data" / "plausible_inputs"
PLAUSIBLE = {file.stem: json.loads(file.read_text(encoding="utf-8")) for file in FOLDER.glob("*.json")}
NAMES = handbook_models()
every = each_case("name", NAMES)


def numbers():
    return [(name, key) for name in NAMES for key in handbook_model(name).numbers]


def choices():
    return [
        (name, key, option)
        for name in NAMES
        for key, entry in handbook_model(name).inputs.items()
        if isinstance(entry, Choice) and key != "environment"
        for option in entry.options
    ]


def plausible(name, **others):
    model = handbook_model(name)
    return model, model.settle({**PLAUSIBLE[name], **others})


def span(entry, at):
    """Values over an input's whole range."""
    low = entry.low if entry.low > 0 or entry.low < 0 else min(at / 1e3, entry.high / 1e6)
    return np.geomspace(low, entry.high, 200) if low > 0 else np.linspace(low, entry.high, 200)


def test_every_model_is_tested():
    assert set(NAMES) == set(PLAUSIBLE)
    with pytest.raises(PlugError, match=r"no hazard model 'mil_hdbk_217f\.capacitr'; did you mean"):
        handbook_model("mil_hdbk_217f.capacitr")


@every
def test_the_declaration_is_complete(name):
    model = handbook_model(name)
    assert model.name == name
    assert model.formula
    assert all((model.source.title, model.source.section, model.source.page, model.source.status))
    for key, entry in model.inputs.items():
        assert entry.description
        assert model.expected(key)
        if isinstance(entry, Range):
            assert quantity("1" + f" {entry.unit}".rstrip(), entry.unit) == 1
            assert entry.low < entry.high
            assert entry.monotone in (-1, 0, 1)
            assert entry.default is None or entry.low <= entry.default <= entry.high
        elif isinstance(entry, Choice):
            assert len(entry.options) > 1
            assert entry.default is None or entry.default in entry.options


@each_case(
    ("name", "of", "status"),
    [
        *((f"mil_hdbk_217f.microcircuit.{kind}", "200 screening points", "from memory") for kind in (
            "gaas", "hybrid", "linear", "logic", "memory", "processor", "programmable", "vhsic",
        )),
        *((f"mil_hdbk_217f.microcircuit.{kind}", "limits of 175 °C", "from memory") for kind in (
            "gaas", "linear", "logic", "memory", "processor", "programmable", "vhsic",
        )),
        ("mil_hdbk_217f.microcircuit.memory", "unknown kind is Flotox", "from memory"),
        ("mil_hdbk_217f.microcircuit.memory", "life of the system", "single transcription"),
        ("mil_hdbk_217f.diode_high_frequency", "πR ends at 3000 W", "from one of them"),
        ("mil_hdbk_217f.laser_diode", "limits of 25 A", "from one program"),
        ("mil_hdbk_217f.transistor_gaas_fet", "πE of MF", "unresolved"),
        ("mil_hdbk_217f.surface_mount", "8 mil", "from memory"),
        ("nswc_11.actuator_axial_load", "k2", "unverified"),
    ],
)  # fmt: skip
def test_what_is_not_sure_says_so(name, of, status):
    """In the source of a model, and so in the reference page."""
    (clause,) = (part for part in handbook_model(name).source.status.split("; ") if of in part)
    assert status in clause


@every
def test_the_rate_at_plausible_inputs_is_one_of_a_part(name):
    model, inputs = plausible(name)
    value, extrapolated = model.evaluate(inputs)
    assert 1e-13 < value < 1e-3
    assert not extrapolated


@every
def test_the_factors_are_the_formula(name):
    model, inputs = plausible(name)
    explained = model.explain(inputs)
    leaves = list(explained.leaves())
    assert all(factor.symbol and factor.note for factor in leaves)
    assert np.asarray(explained.value) == model.evaluate(inputs).value
    assert worth(explained) == pytest.approx(float(np.asarray(explained.value)), rel=1e-14)


def worth(factor):
    """Of a product or sum, from its leaves alone."""
    of = {"·": math.prod, "+": math.fsum}.get(factor.symbol)
    return of(worth(part) for part in factor.parts) if of and factor.parts else float(np.asarray(factor.value))


@each_case("name", dict.fromkeys(name for name, _, _ in choices()))
def test_every_choice_has_an_answer(name):
    for _, key, option in (one for one in choices() if one[0] == name):
        model, inputs = plausible(name, **{key: option})
        assert 0 < model.evaluate(inputs).value < math.inf, (key, option)


@every
def test_an_option_is_meant_by_one_word_in_any_spelling(name):
    """Case, blanks, hyphens and underscores do not count, no two options become one, and no other name is needless."""
    for key, entry in handbook_model(name).inputs.items():
        if isinstance(entry, Choice):
            for option in entry.options:
                for said in (option, option.upper(), *(re.sub("[ _-]", mark, option) for mark in " -_")):
                    assert entry.option(said) == option, (key, said)
            plain = Choice(entry.options)
            for said, option in entry.aliases.items():
                assert entry.option(said) == option
                assert plain.option(said) is None, (key, said)


@each_case("name", [name for name in NAMES if "environment" in handbook_model(name).inputs])
def test_every_environment_has_an_answer_or_is_refused(name):
    """All fourteen; one without a printed πE is no choice."""
    entry = handbook_model(name).inputs["environment"]
    assert set(entry.options) <= set(ENVIRONMENTS)
    assert {"GB", "GF", "GM"} <= set(entry.options)
    for environment in ENVIRONMENTS:
        if environment in entry.options:
            model, inputs = plausible(name, environment=environment)
            value, extrapolated = model.evaluate(inputs)
            assert 0 < value < math.inf, environment
            assert not extrapolated, environment
        else:
            with pytest.raises(ModelError, match=f"^{name}: environment '{environment}' is not one of its choices"):
                plausible(name, environment=environment)


STRESS = {
    ("mil_hdbk_217f.capacitor", "dc_voltage", "rated_voltage"): 1,
    ("mil_hdbk_217f.diode_low_frequency", "voltage", "rated_voltage"): 1,
    ("mil_hdbk_217f.elapsed_time_meter", "temperature", "rated_temperature"): 1,
    ("mil_hdbk_217f.laser_diode", "required_optical_power", "rated_optical_power"): 0.95,
    ("mil_hdbk_217f.relay", "load_current", "rated_current"): 1,
    ("mil_hdbk_217f.resistor", "power", "rated_power"): 1,
    ("mil_hdbk_217f.switch", "load_current", "rated_current"): 1,
    ("mil_hdbk_217f.thyristor", "voltage", "rated_voltage"): 1,
    ("mil_hdbk_217f.transistor_bipolar_high_power_high_frequency", "voltage", "rated_voltage"): 0.55,
    ("mil_hdbk_217f.transistor_bipolar_low_frequency", "voltage", "rated_voltage"): 1,
    ("mil_hdbk_217f.transistor_bipolar_low_noise_high_frequency", "voltage", "rated_voltage"): 1,
}
"""What is applied, its rating, and the largest ratio of them."""
RATINGS_ALONE = {
    ("mil_hdbk_217f.diode_high_frequency", "rated_power"),  # πR
    ("mil_hdbk_217f.lamp", "rated_voltage"),  # λb
    ("mil_hdbk_217f.thyristor", "rated_current"),  # πR
    ("mil_hdbk_217f.transistor_bipolar_low_frequency", "rated_power"),  # πR
    ("mil_hdbk_217f.transistor_bipolar_low_noise_high_frequency", "rated_power"),  # πR
    ("mil_hdbk_217f.transistor_fet_low_frequency", "rated_power"),  # πA
    ("nswc_11.bearing_rated_life", "rated_life"),
    ("nswc_11.static_seal", "rated_temperature"),  # C_T, which goes on above it
}
"""Ratings of which the handbook takes no ratio."""


def test_every_rating_is_known_to_limit_something_or_nothing():
    ratings = {(name, key) for name, key in numbers() if key.startswith("rated_")}
    assert ratings == {(name, rated) for name, _, rated in STRESS} | RATINGS_ALONE


@each_case(("name", "applied", "rated"), STRESS)
def test_overstress_is_an_error_in_a_design_and_a_flag_live(name, applied, rated):
    model, inputs = plausible(name)
    limit = STRESS[name, applied, rated] * inputs[rated]
    unit = model.numbers[applied].unit
    assert plausible(name, **{applied: f"{limit * (1 - 1e-9)} {unit}"})
    with pytest.raises(
        ModelError, match=rf"^{name}: the .*{applied.split('_')[-1]}.* is more than .*: outside the handbook's range$"
    ):
        plausible(name, **{applied: f"{limit * (1 + 1e-6)} {unit}"})
    measured = np.array([limit * (1 - 1e-9), limit * (1 + 1e-6), limit * 2])
    value, extrapolated = model.evaluate({**inputs, applied: measured})
    assert extrapolated.tolist() == [False, True, True]
    assert np.all(np.isfinite(value))
    assert np.all(np.diff(value) >= 0)


@each_case(("name", "key"), numbers())
def test_arrays_are_scalars_side_by_side(name, key):
    model, inputs = plausible(name)
    values = span(model.numbers[key], inputs[key])[::20]
    value, extrapolated = model.evaluate({**inputs, key: values})
    alone = [model.evaluate({**inputs, key: one}) for one in values]
    assert value.shape == extrapolated.shape == values.shape
    assert value.tolist() == pytest.approx([float(one.value) for one in alone], rel=1e-14)
    assert extrapolated.tolist() == [bool(one.extrapolated) for one in alone]


@every
def test_arrays_broadcast(name):
    model, inputs = plausible(name)
    for a, b in itertools.combinations(model.numbers, 2):
        grid = {**inputs, a: np.full((3, 1), inputs[a]), b: np.full(4, inputs[b])}
        value, extrapolated = model.evaluate(grid)
        assert value.shape == extrapolated.shape == (3, 4)
        assert value == pytest.approx(float(model.evaluate(inputs).value), rel=1e-14)


@each_case(("name", "key"), numbers())
def test_monotone_where_declared(name, key):
    model, inputs = plausible(name)
    entry = model.numbers[key]
    value = model.evaluate({**inputs, key: span(entry, inputs[key])}).value
    assert np.all(np.isfinite(value))
    assert np.all(value >= 0)
    if entry.monotone:
        assert np.all(np.diff(value) * entry.monotone >= 0)
        assert value[0] != value[-1]


@each_case(("name", "key"), numbers())
def test_out_of_range_is_an_error_in_a_design_and_a_flag_live(name, key):
    model, inputs = plausible(name)
    entry = model.numbers[key]
    unit = f" {entry.unit}".rstrip()
    for beyond in (entry.low - abs(entry.low) * 1e-9 - 1e-9, entry.high * (1 + 1e-9) + 1e-9):
        with pytest.raises(ModelError, match=rf"^{name}: {key} .* is outside "):
            model.settle({**PLAUSIBLE[name], key: f"{beyond!r}{unit}"})
        value, extrapolated = model.evaluate({**inputs, key: np.array([inputs[key], beyond])})
        assert extrapolated.tolist() == [False, True]
        assert value.shape == (2,)


@every
def test_inputs_that_are_not_taken(name):
    model = handbook_model(name)
    given = PLAUSIBLE[name]
    first = next(iter(model.inputs), "")
    with pytest.raises(ModelError, match=f"has no input '{first}x'" + ("; (did you mean|known)" if first else "")):
        model.settle({**given, f"{first}x": "1"})
    for key, entry in model.inputs.items():
        if entry.default is None and getattr(entry, "required", True):
            with pytest.raises(ModelError, match=rf"^{name} needs the input '{key}' \("):
                model.settle({other: value for other, value in given.items() if other != key})
        if isinstance(entry, Choice):
            wrong = next(iter(entry.options)) + "q"
            for word in (wrong, 5, 5.0, ["x"], "x\ny"):
                with pytest.raises(ModelError, match=f"^{name}: {key} '.*' is not one of its choices"):
                    model.settle({**given, key: word})
        elif isinstance(entry, Note):
            for word in (5, "", " \t", ["x"], True, "x" * 501):
                with pytest.raises(ModelError, match=f"^{name}: {key} .*; expected words, at most 500 characters"):
                    model.settle({**given, key: word})
        else:
            for word in ("5 parsec^7", "x", "nan", "1e400 K", float("nan"), True, [1], "9**9**9"):
                with pytest.raises(UnitError, match=f"^{name}: {key}: "):
                    model.settle({**given, key: word})
            if entry.unit:
                with pytest.raises(
                    UnitError, match=f"{key}: '5' has no unit; expected e.g. '5 {re.escape(entry.unit)}'"
                ):
                    model.settle({**given, key: 5})


@every
def test_settled_inputs_settle_nothing_new(name):
    """Defaults are filled in, and what was given is kept in the model's units."""
    model, inputs = plausible(name)
    assert set(PLAUSIBLE[name]) <= set(inputs)
    for key, entry in model.inputs.items():
        if entry.default is not None and key not in PLAUSIBLE[name]:
            assert inputs[key] == entry.default
        assert isinstance(inputs.get(key, ""), float | str if isinstance(entry, Range) else str)


@every
def test_what_is_assumed_is_told_and_is_what_counts(name):
    """With all that is said to be assumed given, the rate is the same; nothing that counts is left out."""
    model = handbook_model(name)
    bare = {
        key: ("0.5 W" if "high_power" in name else "0.1 W") if key == "power" else value
        for key, value in PLAUSIBLE[name].items()
        if model.inputs[key].default is None and not getattr(model.inputs[key], "otherwise", None)
    }
    settled = model.settle(bare)
    told = model.assumed(bare, settled)
    values = {key: one.value for key, one in told.items() if one.value is not None}
    assert model.evaluate({**settled, **values}).value == pytest.approx(model.evaluate(settled).value, rel=1e-14)
    assert all(one.why for one in told.values())
    for key in model.numbers.keys() - settled.keys() - told.keys():
        assert not model.answers_to(key, settled), f"{key} counts, and is not told"
    assert not model.assumed(settled.keys() | values.keys(), {**settled, **values}).keys() - {
        key for key, one in told.items() if one.value is None
    }


COUNTS = re.compile(
    r"(pins|gates|transistors|elements|contacts|\w*holes|planes|brushes|junctions|characters|waves|bits|programming_cycles)"
)


def test_counts_are_whole_numbers():
    """By their names: a new input that counts things has to say so."""
    whole = {(name, key) for name, key in numbers() if handbook_model(name).numbers[key].whole}
    assert whole == {(name, key) for name, key in numbers() if COUNTS.fullmatch(key)}
    for name, key in whole:
        model, entry = handbook_model(name), handbook_model(name).numbers[key]
        wrong = {**PLAUSIBLE[name], key: f"{(entry.low + entry.high) // 2 + 0.5} {entry.unit}"}
        with pytest.raises(ModelError, match=rf"{key} .*\.5.*; expected a whole number of "):
            model.settle(wrong)
