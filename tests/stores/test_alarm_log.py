"""The log of alarms, of every store: what is kept, who has taken note, how much; and after a kill."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robophm.stores import alarm_log as logs
from robophm.stores import open_store, sqlite_alarms, stores
from robophm.stores.store import Store


@pytest.fixture(params=stores())
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    with open_store(f"{request.param}:{tmp_path / 'robots'}") as opened:
        yield opened


def alarm(what: str, begin: int, end: int | None = None, **more: Any) -> dict[str, Any]:
    return {
        "what": what, "path": "a/b", "severity": "error", "begin": begin, "cause": "λ", "end": end, "doubt": "",
        "ended_by": "", "number": 0, "acknowledged_by": "", "acknowledged_at": None,
    } | more  # fmt: skip


def test_what_is_kept_is_there_and_people_are_not_written_over(store: Store) -> None:
    log = store.alarm_log("R")
    assert log.alarms() == []
    assert [one["number"] for one in log.keep([alarm("hot", 1), alarm("cold", 2)])] == [1, 2]
    assert log.acknowledge(1, "Ada", 77)
    assert log.acknowledge(1, "Bob", 78)  # who did it first stays
    assert not log.acknowledge(3, "Ada", 77)
    log.keep([alarm("hot", 1, 9, ended_by="cooled")])
    assert log.alarms(open_only=True) == [alarm("cold", 2, number=2)]
    said = alarm("hot", 1, 9, ended_by="cooled", number=1, acknowledged_by="Ada", acknowledged_at=77)
    assert log.alarms() == [alarm("cold", 2, number=2), said]
    assert log.alarms(most=1) == [alarm("cold", 2, number=2)]
    (kept,) = log.keep([alarm("hot", 1, 10)])
    assert (kept["number"], kept["acknowledged_by"]) == (1, "Ada")
    other = store.alarm_log("S")
    assert other.alarms() == []
    assert not other.acknowledge(1, "Ada", 77)
    assert store.alarm_log("R").alarms()[0]["number"] == 2


def test_the_oldest_that_ended_are_forgotten(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (logs, sqlite_alarms):
        monkeypatch.setattr(module, "MOST_ALARMS", 3)
    log = store.alarm_log("R")
    log.keep([alarm("open", 0)])
    for begin in range(1, 6):
        log.keep([alarm("hot", begin, begin + 1)])
    assert [(one["what"], one["begin"]) for one in log.alarms(most=9)] == [
        ("hot", 5), ("hot", 4), ("hot", 3), ("open", 0),
    ]  # fmt: skip


def test_a_store_of_before_has_no_alarms_and_takes_them(tmp_path: Path) -> None:
    """A table of its own, made with the first alarm: a file that is only read is not changed."""
    path = tmp_path / "past.db"
    with open_store(path) as store:
        store.save("R", {"a": 1})
        assert store.alarm_log("R").alarms(open_only=True) == []
    before = path.read_bytes()
    with open_store(path) as store:
        assert store.alarm_log("R").alarms() == []
    assert path.read_bytes() == before


KILLED = """
import os, signal, sys
sys.path.insert(0, sys.argv[2])
from robophm.stores import open_store
from tests.stores.test_alarm_log import alarm
open_store(sys.argv[1]).alarm_log("R").keep([alarm("hot", 1)])
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_an_alarm_outlives_a_kill(tmp_path: Path) -> None:
    words = [sys.executable, "-c", KILLED, str(tmp_path / "past.db"), str(Path(__file__).parents[2])]
    assert subprocess.run(words, env=os.environ, check=False).returncode == -signal.SIGKILL
    with open_store(tmp_path / "past.db") as store:
        assert store.alarm_log("R").alarms(open_only=True) == [alarm("hot", 1, number=1)]
