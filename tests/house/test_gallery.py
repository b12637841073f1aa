"""The pages of the gallery: their code prints what stands there, and their pictures are those that it draws."""

import re
from pathlib import Path

import matplotlib as mpl
import pytest
from book.gallery import GALLERY, pages, printed, run
from tests.cases import some

from .test_pictures import shape

PAGES = pages()


@pytest.fixture(autouse=True)
def _without_windows() -> None:
    mpl.use("svg")


@pytest.mark.parametrize("page", some(PAGES), ids=lambda page: page.stem)
def test_a_page_prints_and_draws_what_it_shows(page: Path, tmp_path: Path) -> None:
    pytest.importorskip("surpyval")
    assert run(page, tmp_path / "new.svg") == printed(page)
    new, kept = shape(tmp_path / "new.svg"), shape(page.with_suffix(".svg"))
    assert new[0] == kept[0], "python -m book.gallery draws it anew"
    assert new[1] == pytest.approx(kept[1], abs=0.01), "python -m book.gallery draws it anew"


def test_each_page_has_its_own_picture_and_is_in_the_index() -> None:
    index = (GALLERY / "README.md").read_text("utf-8")
    assert len(PAGES) >= 12
    for page in PAGES:
        text = page.read_text("utf-8")
        assert len(text.split()) < 500, page
        assert re.findall(r"!\[[^]]+\]\(([^)]+)\)", text) == [f"{page.stem}.svg"]
        assert f"]({page.name})" in index
        assert f"]({page.stem}.svg)" in index
    assert sorted(one.stem for one in GALLERY.glob("*.svg")) == sorted(page.stem for page in PAGES)
