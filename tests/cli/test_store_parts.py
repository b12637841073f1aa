"""``robophm store parts``: a design edited by hand asks what became of its parts, and takes the answers."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import load
from robophm.health.ledger import Ledger
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore

START = 1_795_000_020 * SECOND
DESIGN = """\
schema_version: 1
name: cart  # the first of them
max_gap: 3 h
modules:
  drive:
    signals:
      temperature: {topic: /t, field: c, max_age: 2 h}
    components:
      motor: {rate: 1e-4 /h, acceleration: {model: q10, reference_temperature: 25 degC}}  # a good one
      brake: {rate: 2e-4 /h}
components:
  lamp:
    rate: 3e-4 /h
    quantity: 2
"""


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    """A cart that has lived for ten hours."""
    path = tmp_path / "robot.yaml"
    path.write_text(DESIGN)
    robot = load(path)
    monitor = Monitor(robot)
    for half in range(21):
        monitor.observe(Sample(START + half * HOUR // 2, "/t.c", 35.0))
    with SqliteStore(tmp_path / "past.db") as store:
        store.save("cart", monitor.exposure.settled(monitor.ledger).to_json())
    return path


def changed(path: Path, *pairs: tuple[str, str]) -> None:
    text = path.read_text()
    for old, new in pairs:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path.write_text(text)


def ages(path: Path) -> dict[str, float]:
    robot = load(path)
    with SqliteStore(path.with_name("past.db")) as store:
        ledger = Ledger.of(robot, store.ledger(robot.identity) or {})
    return {mode.path: round(float(age), 9) for mode, age in zip(robot.modes, ledger.age.value, strict=True)}


def test_a_design_as_it_was_asks_nothing(inside, cart):
    done = inside("store", "parts", "robot.yaml", "--store", "past.db")
    assert (done.returncode, done.stdout, done.stderr) == (0, "3 parts go on as they are\n", "")


def test_what_was_renamed_by_hand_is_asked_about_answered_and_followed(inside, cart):
    changed(cart, ("motor:", "engine:"), ("drive:", "traction:"), ("lamp:", "light:"))
    asked = inside("service", "robot.yaml", "light", "--store", "past.db", "--history")
    assert asked.returncode != 0
    assert "'traction/engine' has no past, and 'drive/motor' has one, but is gone" in asked.stderr
    seen = inside("store", "parts", "robot.yaml", "--store", "past.db", "--json")
    found = {one["path"]: one for one in json.loads(seen.stdout)["parts"]}
    assert {path: one["kind"] for path, one in found.items()} == {
        "traction/engine": "asked",
        "traction/brake": "asked",
        "light": "asked",
        "drive/motor": "removed",
        "drive/brake": "removed",
        "lamp": "removed",
    }
    assert [found[path]["candidates"][0] for path in ("traction/engine", "traction/brake", "light")] == [
        "drive/motor",
        "drive/brake",
        "lamp",
    ]
    answers = ("--same", "drive=traction", "--same", "drive/motor=traction/engine", "--same", "lamp=light")
    done = inside("store", "parts", "robot.yaml", "--store", "past.db", *answers)
    assert (done.returncode, done.stderr) == (0, "")
    for words in ("goes on; was drive/motor", "goes on; was drive/brake", "goes on; was lamp"):
        assert words in done.stdout
    assert ages(cart) == {"traction/engine": 10, "traction/brake": 10, "light": 10}
    text = cart.read_text()
    assert "# a good one" in text
    assert "# the first of them" in text


def test_what_is_new_is_said_to_be_new(inside, cart):
    changed(cart, ("brake:", "gear:"))
    done = inside("store", "parts", "robot.yaml", "--store", "past.db", "--new", "drive/gear")
    assert (done.returncode, done.stderr) == (0, "")
    assert "begins new" in done.stdout
    assert ages(cart) == {"drive/motor": 10, "drive/gear": 0, "lamp": 10}


def test_each_of_equal_parts_goes_on_by_itself(inside, cart):
    text = "  lamp:\n    rate: 3e-4 /h\n    quantity: 2\n"
    changed(cart, (text, "  left: {rate: 3e-4 /h}\n  right: {rate: 3e-4 /h}\n"))
    done = inside(
        "store", "parts", "robot.yaml", "--store", "past.db", "--same", "lamp[1]=left", "--same", "lamp[2]=right"
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "has the past of lamp, of which it was one" in done.stdout
    assert ages(cart) == {"drive/motor": 10, "drive/brake": 10, "left": 10, "right": 10}


def test_a_robot_of_another_name_is_another_until_it_is_said_to_be_the_same(inside, cart):
    changed(cart, ("name: cart", "name: wagon"))
    lost = inside("store", "parts", "robot.yaml", "--store", "past.db")
    assert lost.returncode != 0
    assert "knows no robot 'wagon'" in lost.stderr
    assert "where it is 'cart' under another name" in lost.stderr
    done = inside("store", "parts", "robot.yaml", "--store", "past.db", "--same", "cart=wagon")
    assert (done.returncode, done.stderr) == (0, "")
    assert cart.read_text().startswith("schema_version: 1\nname: wagon  # the first of them\nidentity: cart\n")
    assert ages(cart)["lamp"] == 10


def test_a_wrong_answer_changes_nothing(inside, cart):
    before = cart.read_bytes()
    for answer, words in (
        (("--same", "drive/motr=lamp"), "there is no 'drive/motr' in the past; did you mean 'drive/motor'?"),
        (("--same", "lamp=lmap"), "no part or module 'lmap' in the design; did you mean 'lamp'?"),
        (("--same", "lamp"), "expected OLD=NEW"),
        (("--same", "lamp=drive/brake"), "its past would be that of drive/brake, whose identity is 'lamp'"),
        (("--new", "lmap"), "no part or module 'lmap'"),
    ):
        done = inside("store", "parts", "robot.yaml", "--store", "past.db", *answer)
        assert done.returncode != 0
        assert words in done.stderr
        assert len(done.stderr.splitlines()) == 1
    assert cart.read_bytes() == before
