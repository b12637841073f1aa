"""The drawing of the house, and what CONTRIBUTING says of it, are what the import contracts hold."""

import re
import runpy
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DRAWN = runpy.run_path(str(ROOT / "tools" / "house-picture"))


def test_the_picture_is_drawn_anew():
    assert (ROOT / "docs" / "reference" / "house.svg").read_text() == DRAWN["picture"](), (
        "expected tools/house-picture run"
    )


def test_contributors_are_told_the_floors_that_hold():
    told = re.search(r"top to bottom: (.*?)\. Each", (ROOT / "CONTRIBUTING.md").read_text(), re.DOTALL)[1]
    floors = [re.findall(r"\w+", floor) for floor in " ".join(told.split()).split("→")]
    assert floors == DRAWN["floors"]()


def test_every_room_is_on_a_floor():
    rooms = {path.parent.name for path in (ROOT / "src" / "robophm").glob("*/__init__.py")}
    assert {room for floor in DRAWN["floors"]() for room in floor} == rooms - {"examples"}
