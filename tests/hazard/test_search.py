"""Hazard models by what people call the parts that they are of."""

import json

import pytest

from robophm.core.errors import PlugError
from robophm.hazard.search import all_models, find_models


@pytest.mark.parametrize(("kind", "model"), [("mica", "mil_hdbk_217f.capacitor"), ("Arrhenius", "arrhenius")])
def test_a_kind_is_found_by_what_people_call_it(kind: str, model: str) -> None:
    assert model in find_models(kind)


def test_an_unknown_kind_is_told_with_the_nearest_word() -> None:
    with pytest.raises(PlugError, match=r"no hazard model of 'capacitr'; did you mean 'capacitor"):
        find_models("capacitr")


def test_every_model_says_what_it_is_of() -> None:
    assert not [name for name, model in all_models().items() if not model.source.status]
    assert json.dumps([model.description for model in find_models().values()])


def test_a_kind_of_part_is_found_by_words_not_by_letters_within_them() -> None:
    assert "mil_hdbk_217f.switch" in find_models("thumbwheel")
    with pytest.raises(PlugError, match="no hazard model of 'wheel'"):
        find_models("wheel")
    assert not any("actuator" in name for name in find_models("LED"))  # of a coupled one
    assert {*find_models("microcircuit")} < {*find_models("circuit")}
    assert "mil_hdbk_217f.optoelectronic" in find_models("coupler")  # the optocoupler


def test_who_is_called_so_comes_before_who_speaks_of_it():
    assert next(iter(find_models("gear"))) == "nswc_11.gear"
    assert next(iter(find_models("belt"))) == "nswc_11.belt"


@pytest.mark.parametrize("words", ["an", "a", "of the", " "])
def test_words_that_name_no_part_find_no_model(words):
    with pytest.raises(PlugError, match="no hazard model of"):
        find_models(words)
