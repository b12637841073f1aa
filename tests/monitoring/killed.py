"""A replay that is killed again and again, beside one that was not."""

from __future__ import annotations

import random
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import robophm
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.stores.sqlite import SqliteStore

REPLAY = """
import os, sys, time
import robophm, robophm.monitoring.replay, robophm.monitoring.block_monitor
from robophm.stores.sqlite import SqliteStore
robophm.monitoring.replay.SAVE_EVERY = 0.01
robophm.monitoring.block_monitor.ENOUGH = 500
def tick(monitor):
    time.sleep(0.002)
    os.write(1, b".")
robophm.replay(
    robophm.load(sys.argv[1]), sys.argv[2], store=SqliteStore(sys.argv[3]), period=1, report_every=2, on_tick=tick
)
"""
MOST_KILLS = 20


def killed(design: Path, recordings: Path, store: Path, *, ticks: tuple[int, int], seed: int) -> Iterator[SqliteStore]:
    """Yield the store whenever the replay into it was killed, after so many ticks, and when it came to its end."""
    chance, finished, kills = random.Random(seed), False, 0
    while not finished and kills < MOST_KILLS:
        command = [sys.executable, "-c", REPLAY, str(design), str(recordings), str(store)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as child:
            assert child.stdout
            child.stdout.read(chance.randint(*ticks))
            time.sleep(chance.uniform(0, 0.01))
            child.kill()
            finished = child.wait() == 0
        kills += 1
        with SqliteStore(store) as kept:
            yield kept


def is_as_if_undisturbed(design: Path, recordings: Path, store: Path) -> None:
    """Assert that a store holds what it would if the replay had never been killed, now and after one more."""
    robot, undisturbed = robophm.load(design), MemoryStore()
    expected = replay(robot, recordings, store=undisturbed, period=1, report_every=2)
    with SqliteStore(store) as kept:
        assert kept.ledger(robot.name) == undisturbed.ledger(robot.name)
        assert list(kept.history(robot.name).reports()) == list(undisturbed.history(robot.name).reports())
        found = replay(robot, recordings, store=kept, period=1, report_every=2)
        assert kept.ledger(robot.name) == undisturbed.ledger(robot.name)
    assert found.to_json() == expected.to_json()
