"""The pictures of the concepts are those that robophm draws now."""

import re
from pathlib import Path

import pytest
from book.pictures import CONCEPTS, curves

pytestmark = pytest.mark.full
NUMBER = re.compile(r"-?\d+\.\d+")


def shape(picture: Path) -> tuple[str, list[float]]:
    """What a picture consists of without its coordinates and names, and its coordinates."""
    text = re.sub(r"<metadata>.*?</metadata>", "", picture.read_text("utf-8"), flags=re.S)
    text = re.sub(r"#?\b[mp][0-9a-f]{10}\b", "", text)
    return NUMBER.sub("", text), [float(one) for one in NUMBER.findall(text)]


def test_the_pictures_of_the_concepts_are_current(tmp_path: Path) -> None:
    curves(tmp_path)
    drawn = sorted(path.name for path in tmp_path.iterdir())
    assert drawn == sorted(path.name for path in CONCEPTS.glob("*.svg"))
    for name in drawn:
        new, kept = shape(tmp_path / name), shape(CONCEPTS / name)
        assert new[0] == kept[0], f"{name}: python -m book.pictures draws it anew"
        assert new[1] == pytest.approx(kept[1], abs=0.01), f"{name}: python -m book.pictures draws it anew"
