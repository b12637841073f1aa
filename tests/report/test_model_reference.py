"""The reference page that is kept is of the models that there are."""

from __future__ import annotations

from pathlib import Path

from robophm.hazard.search import all_models
from robophm.report.model_reference import reference

ROOT = Path(__file__).parents[2]


def test_the_reference_page_is_of_these_models() -> None:
    page = (ROOT / "docs/reference/models.md").read_text(encoding="utf-8")
    assert page == "\n".join(reference()) + "\n", "made anew by: robophm models --reference > docs/reference/models.md"
    for name, model in all_models().items():
        assert f"## {name}\n" in page
        assert model.source.status in page
