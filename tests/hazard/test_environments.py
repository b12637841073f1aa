"""Words for environments: every model and the design take the same, and no word means two."""

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.environments import ENVIRONMENTS, WORDS, environment, explained
from robophm.hazard.handbooks import handbook_model, handbook_models
from robophm.hazard.model import Choice

ASKING = [name for name in handbook_models() if "environment" in handbook_model(name).inputs]


@each_case(
    ("said", "symbol"),
    [  # what Table 3-2 describes: controlled rooms; racks, unheated buildings; wheels and tracks; ships; helicopters
        ("indoor", "GB"), ("laboratory", "GB"), ("unheated building", "GF"), ("vehicle", "GM"),
        ("Outdoor ground", "GM"),
        ("handheld", "GM"), ("below deck", "NS"), ("ship", "NS"), ("underwater", "NU"), ("flying", "ARW"),
        ("helicopter", "ARW"), ("fixed-wing", "AUC"), ("orbit", "SF"), ("space", "SF"), ("ground mobile", "GM"),
        ("gm", "GM"),
    ],
)  # fmt: skip
def test_a_word_is_the_row_that_describes_it(said, symbol):
    assert environment(said) == symbol


def test_no_word_means_two_environments():
    said = [word for entry in ENVIRONMENTS.values() for word in entry.words]
    assert len(said) == len(set(said))
    assert set(WORDS.values()) == set(ENVIRONMENTS)
    assert all(environment(word) == symbol for word, symbol in WORDS.items())


@each_case("name", ASKING)
def test_every_model_takes_the_words(name):
    choice = handbook_model(name).inputs["environment"]
    assert isinstance(choice, Choice)
    assert {word: choice.option(word) for word in WORDS} == {
        word: symbol if symbol in choice.options else None for word, symbol in WORDS.items()
    }
    assert "GM (vehicle)" in handbook_model(name).expected("environment")


def test_what_is_none_is_told_all_that_there_are():
    with pytest.raises(ModelError, match=r"'moon' is no environment .*; known: .*ARW \(flying\)"):
        environment("moon")
    with pytest.raises(ModelError, match="did you mean 'drone'"):
        environment("drones")


def test_a_meaning_is_explained():
    assert explained("GM").startswith("GM (Ground, Mobile: on wheels, tracks or legs")
