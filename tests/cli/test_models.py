"""What models say of themselves, as a list and as the reference page."""

import json
from pathlib import Path

import pytest

from robophm.cli.models import all_models, find, reference
from robophm.core.errors import PlugError

ROOT = Path(__file__).parents[2]


def test_the_reference_page_is_of_these_models() -> None:
    page = (ROOT / "docs/reference/models.md").read_text(encoding="utf-8")
    assert page == "\n".join(reference()) + "\n", "made anew by: robophm models --reference > docs/reference/models.md"
    for name, model in all_models().items():
        assert f"## {name}\n" in page
        assert model.source.status in page


@pytest.mark.parametrize(("kind", "model"), [("mica", "mil_hdbk_217f.capacitor"), ("Arrhenius", "arrhenius")])
def test_a_kind_is_found_by_what_people_call_it(kind: str, model: str) -> None:
    assert model in find(kind)


def test_an_unknown_kind_is_told_with_the_nearest_word() -> None:
    with pytest.raises(PlugError, match=r"no hazard model of 'capacitr'; did you mean 'capacitor"):
        find("capacitr")


def test_every_model_says_what_it_is_of() -> None:
    assert not [name for name, model in all_models().items() if not model.source.status]
    assert json.dumps([model.description for model in find(None).values()])


def test_a_kind_of_part_is_found_by_words_not_by_letters_within_them() -> None:
    assert "mil_hdbk_217f.switch" in find("thumbwheel")
    with pytest.raises(PlugError, match="no hazard model of 'wheel'"):
        find("wheel")
    assert not any("actuator" in name for name in find("LED"))  # of a coupled one
    assert {*find("microcircuit")} < {*find("circuit")}
    assert "mil_hdbk_217f.optoelectronic" in find("coupler")  # the optocoupler
