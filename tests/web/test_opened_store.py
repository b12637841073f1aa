"""A store that stays open is the one that is at its place, whatever was done to its file meanwhile."""

from __future__ import annotations

import shutil
from pathlib import Path

from robophm.stores.sqlite import SqliteStore
from robophm.web.opened_store import OpenedStore


def alarm(what: str, begin: int) -> dict[str, object]:
    said = {"what": what, "path": "", "begin": begin, "end": None, "cause": "", "severity": "warn"}
    return {**said, "acknowledged_by": "", "acknowledged_at": None}


def told(opened: OpenedStore) -> list[str] | None:
    with opened.opened() as store:
        return None if store is None else [one["what"] for one in store.alarm_log("R").alarms(open_only=True)]


def test_it_stays_open_and_reads_what_others_write(tmp_path: Path) -> None:
    opened = OpenedStore(tmp_path / "past.db")
    assert told(opened) is None
    assert not (tmp_path / "past.db").exists(), "whoever only asks makes none"
    with SqliteStore(tmp_path / "past.db") as writer:
        writer.alarm_log("R").keep([alarm("hot", 1)])
        assert told(opened) == ["hot"]
        with opened.opened() as first:
            pass
        writer.alarm_log("R").keep([alarm("worn", 2)])
        assert told(opened) == ["worn", "hot"]
        with opened.opened() as second:
            assert second is first
    opened.close()
    opened.close()
    assert told(opened) == ["worn", "hot"]
    opened.close()


def test_a_file_that_was_replaced_or_taken_away_is_read_no_more_and_not_harmed(tmp_path: Path) -> None:
    """As ``robophm store repair`` and people do it."""
    place, other = tmp_path / "past.db", tmp_path / "other.db"
    for path, what in ((place, "hot"), (other, "worn")):
        with SqliteStore(path) as store:
            store.alarm_log("R").keep([alarm(what, 1)])
    opened = OpenedStore(place)
    assert told(opened) == ["hot"]
    shutil.move(place, tmp_path / "past.db.damaged")
    shutil.move(other, place)
    with SqliteStore(place) as writer:
        writer.alarm_log("R").keep([alarm("cold", 2)])  # in its log, which has the name of the other's
        assert told(opened) == ["cold", "worn"]
    assert told(opened) == ["cold", "worn"]
    place.unlink()
    assert told(opened) is None
