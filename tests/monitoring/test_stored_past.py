"""A past in a store is found by its identity, and is changed by one at a time."""

from pathlib import Path

import pytest

import robophm
from robophm.core.errors import StoreError
from robophm.design.file import load
from robophm.health.ledger import Ledger
from robophm.stores.sqlite import SqliteStore

CART = """\
schema_version: 1
name: cart of today
identity: old cart
components: {motor: {rate: 1e-4 /h}, lamp: {rate: 1e-5 /h}}
"""


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    path = tmp_path / "cart.yaml"
    path.write_text(CART)
    robot = load(path)
    with SqliteStore(tmp_path / "past.db") as store:
        store.save(robot.identity, Ledger.new(robot).to_json())
    return path


def test_a_service_is_of_the_past_that_the_robot_has_whatever_it_is_called_now(cart: Path, tmp_path: Path) -> None:
    past = tmp_path / "past.db"
    robophm.service(str(cart), "motor", str(past), replaced=True)
    with SqliteStore(past) as store:
        assert store.robots() == ["old cart"]
    assert [one.kind for one in robophm.service(str(cart), "motor", str(past))] == ["replaced"]


def test_what_somebody_goes_on_with_is_looked_at_and_not_changed(cart: Path, tmp_path: Path) -> None:
    past = tmp_path / "past.db"
    with SqliteStore(past) as store, store.alone("old cart"):
        assert robophm.service(str(cart), "motor", str(past)) == []
        words = r"nobody answered within 0 s, and nothing was noted: .* goes on with the past"
        with pytest.raises(StoreError, match=words):
            robophm.service(str(cart), "motor", str(past), replaced=True, wait=0)
        state = store.ledger("old cart")
        assert state
        store.save("old cart", state)  # whoever goes on with it is not disturbed
