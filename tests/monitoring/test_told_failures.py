"""A person serves a part of which software told a moment before: that failure is the one that is served, and none."""

from __future__ import annotations

from pathlib import Path

from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.health.service import ServiceNote
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.rate_history import rate_history
from robophm.monitoring.replay import kept_ledger
from robophm.monitoring.service_notes import note_in
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore

ROBOT = parse(
    "schema_version: 1\nname: R\npowered: {topic: /on, field: data}\n"
    "components: {lidar: {rate: 0.01 /h, failed_when: [{topic: /lidar, field: fault, values: [1]}]}}"
)
START = 1_700_000_000 * SECOND


def watched(seconds: range, monitor: Monitor) -> Monitor:
    for second in seconds:
        monitor.observe(Sample(START + second * SECOND, "/on.data", 1.0))
    return monitor


def test_what_waits_in_the_window_is_served_and_learned(tmp_path: Path) -> None:
    for store, said, kinds, count in (
        (MemoryStore(), ServiceNote("lidar", by="Ann"), ["failed", "replaced"], 1),
        (SqliteStore(tmp_path / "past.db"), ServiceNote("lidar", by="Ann", none=True), ["struck out"], 0),
    ):
        monitor = watched(range(100), Monitor(ROBOT))
        monitor.observe(Sample(START + 100 * SECOND, "/lidar.fault", 1.0))
        assert monitor.ledger.services == []
        (seen,) = rate_history(ROBOT, monitor.ledger, "R")
        assert (seen.failures, seen.exposure) == (1, 100 / 3600)
        with store:
            store.save(ROBOT.identity, monitor.ledger.to_json())
            note_in(store, ROBOT, said)
            monitor = watched(range(101, 400), Monitor(ROBOT, kept_ledger(ROBOT, store)))
        assert [one.kind for one in monitor.ledger.services] == kinds
        (seen,) = rate_history(ROBOT, monitor.ledger, "R")
        assert seen.failures == count
        assert round(seen.exposure * 3600, 6) == 399
