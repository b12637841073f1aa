"""Identities are written where something that has a past gets another path, and nowhere else."""

from __future__ import annotations

import json
from typing import Any

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.identities import TRAITS, identities
from robophm.design.identity_edits import Lived, move, put, rename, state

RATE = {"rate": "1e-4 /h"}


def document() -> dict[str, Any]:
    return {
        "schema_version": 1,
        "name": "R",
        "modules": {"drive": {"components": {"motor": dict(RATE), "brake": {"failure_modes": {"wear": dict(RATE)}}}}},
        "components": {"lamp": dict(RATE)},
    }


LIVED = Lived({"R", "drive/motor", "drive/brake/wear", "lamp"})


def found(design: dict[str, Any]) -> dict[str, str]:
    """The identities of all failure modes, by their paths."""
    return {mode.path: mode.identity for mode in parse(json.dumps(design)).modes}


def test_without_a_past_nothing_is_written() -> None:
    design = document()
    rename(design, ("components", "lamp"), "light")
    move(design, ("modules", "drive", "components", "motor"), ())
    put(design, ("components", "fan"), dict(RATE))
    put(design, ("name",), "S")
    assert "identity" not in json.dumps(design)


def test_a_rename_keeps_the_identity_and_back_again_nothing_is_left() -> None:
    design = document()
    rename(design, ("components", "lamp"), "light", LIVED)
    assert design["components"]["light"] == {**RATE, "identity": "lamp"}
    rename(design, ("components", "light"), "beam", LIVED)
    assert found(design)["beam"] == "lamp"
    rename(design, ("components", "beam"), "lamp", LIVED)
    assert design == document()


def test_a_module_states_it_for_all_that_is_in_it() -> None:
    design = document()
    rename(design, ("modules", "drive"), "traction", LIVED)
    assert design["modules"]["traction"]["identity"] == "drive"
    assert found(design)["traction/motor"] == "drive/motor"
    assert found(design)["traction/brake/wear"] == "drive/brake/wear"
    move(design, ("modules", "traction", "components", "motor"), (), LIVED)
    assert found(design)["motor"] == "drive/motor"
    move(design, ("components", "motor"), ("modules", "traction"), LIVED)
    assert "identity" not in design["modules"]["traction"]["components"]["motor"]


def test_a_failure_mode_and_the_robot_have_one_too() -> None:
    design = document()
    rename(design, ("modules", "drive", "components", "brake", "failure_modes", "wear"), "glazing", LIVED)
    put(design, ("name",), "S", LIVED)
    assert found(design)["drive/brake/glazing"] == "drive/brake/wear"
    assert parse(json.dumps(design)).identity == "R"
    put(design, ("name",), "T", LIVED)
    assert design["identity"] == "R"


def test_a_new_part_is_not_one_that_had_its_name() -> None:
    design = document()
    rename(design, ("components", "lamp"), "light", LIVED)
    put(design, ("components", "lamp"), dict(RATE), LIVED)
    assert (found(design)["lamp"], found(design)["light"]) == ("lamp 2", "lamp")
    del design["modules"]["drive"]["components"]["motor"]
    put(design, ("modules", "drive", "components", "motor"), dict(RATE), LIVED)
    assert found(design)["drive/motor"] == "drive/motor 2"


def test_what_is_in_question_is_not_stated() -> None:
    for doubted in (("lamp",), None):
        design = document()
        rename(design, ("components", "lamp"), "light", LIVED._replace(doubted=doubted))
        assert "identity" not in json.dumps(design)


def test_two_of_one_identity_are_no_design() -> None:
    design = document()
    state(design, "drive/motor", "lamp")
    with pytest.raises(
        DesignError, match=r"components/lamp: its past would be that of drive/motor, whose identity is 'lamp'"
    ):
        parse(json.dumps(design))


def test_the_name_and_place_of_a_part_are_none_of_its_traits() -> None:
    one, other = document(), document()
    rename(other, ("components", "lamp"), "light")
    rename(other, ("modules", "drive"), "traction")
    before, after = ([part.traits for part in identities(parse(json.dumps(design)))] for design in (one, other))
    assert before == after
    assert {len(traits) for traits in before} == {len(TRAITS)}


@pytest.mark.parametrize(
    ("change", "traits"),
    [
        ({"rate": "2e-4 /h"}, {"rate", "life, clock or scaling"}),
        ({"quantity": 3}, {"number of parts"}),
        ({"description": "left"}, {"description"}),
        ({"initial_exposure": "5 h"}, {"initial exposure or uncertainty"}),
        ({"source": "elsewhere"}, set()),
    ],
)
def test_what_differs_is_named(change: dict[str, Any], traits: set[str]) -> None:
    other = document()
    other["components"]["lamp"] |= change
    before, after = (identities(parse(json.dumps(design)))[-1].traits for design in (document(), other))
    assert {name for name, a, b in zip(TRAITS, before, after, strict=True) if a != b} == traits
