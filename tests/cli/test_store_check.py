"""A store checked, copied while it is written, and made smaller."""

from __future__ import annotations

import json

import pytest

from robophm.stores.sqlite import SqliteStore

LEDGER = {"sum": [0.1] * 1000}


@pytest.fixture
def kept(tmp_path):
    """A store in use, with much in it that was forgotten."""
    with SqliteStore(tmp_path / "past.db") as store:
        for hour in range(0, 24 * 60, 6):
            report = {"time": hour * 3600 * 10**9, "much": [f"{hour * i % 9973}" for i in range(2000)]}
            store.save("R", LEDGER, (), [report])
        yield store


def test_a_sound_store_is_said_to_be_and_a_damaged_one_not(inside, tmp_path, kept):
    done = inside("store", "check", "--store", "past.db")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "past.db: all of it is what was written; robots: R\n"
    kept.close()
    raw = (tmp_path / "past.db").read_bytes()
    (tmp_path / "past.db").write_bytes(raw.replace(b'"sum": [0.1', b'"sum": [0.7', 1))
    done = inside("store", "check", "--store", "past.db")
    assert done.returncode == 3
    assert "the ledger of R is damaged: its checksum is another" in done.stderr
    assert "robophm store repair goes back to the last good state" in done.stderr
    done = inside("store", "check", "--store", "past.db", "--json")
    assert done.returncode == 3
    assert json.loads(done.stdout)["faults"] == ["the ledger of R is damaged: its checksum is another"]


def test_the_good_state_is_checked_too(inside, tmp_path, kept):
    kept.close()
    (tmp_path / "past.db.good").write_text("00000000\n{}\n")
    done = inside("store", "check", "--store", "past.db")
    assert done.returncode == 3
    assert "past.db.good is damaged; it is made anew when the store is saved next" in done.stderr


def test_a_copy_is_of_one_moment_while_it_is_written(inside, tmp_path, kept):
    with kept.alone("R"):
        done = inside("store", "copy", "--store", "past.db", "--to", "copy.db")
    assert (done.returncode, done.stderr) == (0, "")
    kept.save("R", {"sum": []})
    with SqliteStore(tmp_path / "copy.db") as copy:
        assert copy.ledger("R") == LEDGER
        assert list(copy.history("R").reports()) == list(kept.history("R").reports())
        assert copy.upkeep().faults() == []
    done = inside("store", "copy", "--store", "past.db", "--to", "copy.db")
    assert done.returncode == 3
    assert "copy.db" in done.stderr


def test_space_is_given_back_where_nobody_goes_on_with_it(inside, tmp_path, kept):
    with kept.alone("R"):
        done = inside("store", "compact", "--store", "past.db")
    assert done.returncode == 3
    assert "goes on with the past of R" in done.stderr
    before = list(kept.history("R").reports())
    kept.close()
    size = (tmp_path / "past.db").stat().st_size
    done = inside("store", "compact", "--store", "past.db", "--json")
    told = json.loads(done.stdout)["bytes"]
    assert told == {"before": size, "after": (tmp_path / "past.db").stat().st_size}
    assert told["after"] < size
    with SqliteStore(tmp_path / "past.db") as store:
        assert list(store.history("R").reports()) == before
        assert store.upkeep().faults() == []
