"""Days of a fleet's history become months: every report is there once, to the bit, wherever that is ended."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.cases import some
from tests.fleet.made_reports import BEGIN, MINUTE
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import RobophmError
from robophm.core.signal import DAY
from robophm.fleet import compaction, kept_days
from robophm.fleet.compaction import join_months
from robophm.fleet.daily_history import write_days
from robophm.fleet.history_files import OVER, counting, files_in
from robophm.fleet.kept_days import kept_reports, move_out
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.robot_history import history
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
dataset = pytest.importorskip("pyarrow.dataset", reason="pyarrow is not installed")

FIRST = BEGIN // DAY * DAY + 15 * DAY  # the 29th of November 2023
DECEMBER = FIRST + 2 * DAY
DAYS = 4
NAMES = ("a", "b", "Röntgen 50 %", "e")
EPOCHS = ("a" * 16, "b" * 16)
ALL = dict.fromkeys((1, 2), 10**6)
"""Numbers up to which the reports of each epoch are asked of the files."""


@pytest.fixture(scope="module")
def template(tmp_path_factory):
    """A store, and the folder of its five days: two epochs of each robot, of two designs, of which one is not told."""
    place, chance = tmp_path_factory.mktemp("fleet"), np.random.default_rng(1)
    with FleetStore(place / "fleet.db", make=True) as store:
        for name in NAMES:
            store.add_token(name)
            said = {"robot": "courier", "design_hash": "d1", "time": BEGIN} if name < "d" else None
            for epoch in EPOCHS:
                told = []
                for seq in range(1, 60):
                    figures = chance.lognormal(0, 30, len(COLUMNS))
                    figures[chance.random(len(COLUMNS)) < 0.2] = np.nan
                    figures[:3] = -np.inf if seq == 5 else np.inf, 1e-46 * (seq % 2), -0.0
                    figures[[COLUMNS.index("state"), COLUMNS.index("bound")]] = 0
                    told.append(Report(seq, FIRST + seq * MINUTE, seq % 3, tuple(map(float, figures))))
                store.commit([Payload(name, epoch, BEGIN, 0, tuple(told), PresentState(1, "{}", said, ()))])
        with store.writing() as engine:
            engine.ask(f"UPDATE report SET received = {FIRST} + (seq % {DAYS}) * {DAY} + seq * {MINUTE} "
                       "RETURNING robot", ())  # fmt: skip
        write_days(store, place / "days", FIRST + DAYS * DAY + OVER)
    return place


@pytest.fixture
def days(template, tmp_path):
    return Path(shutil.copytree(template / "days", tmp_path / "days"))


def rows_of(files):
    """All rows of files as bytes, each with the design that its folder tells."""
    found = []
    for path in files:
        table = parquet.read_table(path, partitioning=None)
        columns = [table[name].to_numpy().tolist() if name == "robot" else
                   [one.tobytes() for one in table[name].to_numpy()] for name in table.column_names]  # fmt: skip
        found += [(path.parent.name, *row) for row in zip(*columns, strict=True)]
    return sorted(found)


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def asked(folder, names=NAMES):
    """What readers find, robot by robot."""
    found = []
    for name in names:
        some = kept_reports(folder, name, ALL, ())
        keys = np.concatenate([np.stack(one[:5], axis=1) for one in some])
        order = np.lexsort(keys[:, 1::-1].T)
        found.append((keys[order].tobytes(), np.concatenate([one.figures for one in some])[order].tobytes()))
    return found


def test_a_month_that_is_over_has_the_rows_of_its_days_to_the_bit(days, monkeypatch):
    before, told = rows_of(days.rglob("*.parquet")), asked(days)
    size = sum(path.stat().st_size for path in days.glob("day=2023-11-*/*/*"))
    assert len(before) == 59 * len(EPOCHS) * len(NAMES)
    assert join_months(days, DECEMBER + OVER - 1).months == ()
    monkeypatch.setattr(compaction, "IN_A_FILE", 60)
    made = join_months(days, DECEMBER + OVER)
    assert (made.months, made.before) == (("2023-11",), size)
    assert names_in(days) == ["day=2023-11", "day=2023-12-01", "day=2023-12-02"]
    assert rows_of(days.rglob("*.parquet")) == before
    assert asked(days) == told
    files = files_in(days / "day=2023-11")
    assert made.after == sum(path.stat().st_size for path in files)
    assert len(files) > 3, "a design of many reports has several files"
    for path in files:
        table = parquet.read_table(path, partitioning=None)
        keys = [*zip(*(table[name].to_pylist() for name in ("robot", "epoch", "seq")), strict=True)]
        assert keys == sorted(keys)
        if "courier" in str(path):
            for name in set(table["robot"].to_pylist()):
                assert files_in(days / "day=2023-11", name).count(path) == 1
    found = dataset.dataset(days, partitioning="hive").to_table()
    assert (found.num_rows, {*found["day"].to_pylist()}) == (len(before), {"2023-11", "2023-12-01", "2023-12-02"})
    assert join_months(days, DECEMBER + OVER) == ((), 0, 0)


def test_a_robot_with_many_reports_is_alone_in_its_group_of_rows(days, monkeypatch):
    from robophm.fleet import history_files

    monkeypatch.setattr(history_files, "AT_ONCE", 50)
    join_months(days, DECEMBER + OVER)
    (path,) = (days / "day=2023-11" / "design=courier").iterdir()
    meta = parquet.ParquetFile(path).metadata
    groups = [meta.row_group(at).column(0).statistics for at in range(meta.num_row_groups)]
    assert [(one.min, one.max) for one in groups] == [(name, name) for name in sorted(NAMES) if name < "d"]


KILLED = multiprocessing.get_context("forkserver")
KILLED.set_forkserver_preload(["tests.fleet.test_compaction"])
CHANGES = ("os.rename", "os.remove", "os.rmdir", "os.mkdir")


def end_everywhere(days: Path, place: Path) -> None:
    """Join months of copies of a folder, killed before the first change, before the second, until one is not."""
    compaction.IN_A_FILE, compaction.LEVEL = 150, 1
    status, change = 1, 0
    while status:
        change += 1
        folder = Path(shutil.copytree(days, place / f"{change:03}"))
        if not (child := os.fork()):
            sys.addaudithook(killer(change, folder))
            join_months(folder, DECEMBER + OVER)
            os._exit(0)
        status = os.waitpid(child, 0)[1]
        if status not in (0, signal.SIGKILL):
            raise RuntimeError(f"change {change}: {status}")


def killer(change: int, folder: Path) -> Callable[[str, tuple[object, ...]], None]:
    left = change

    def hook(event: str, values: tuple[object, ...]) -> None:
        nonlocal left
        if event in CHANGES or (event == "open" and str(folder) in str(values[0]) and values[1] == "wb"):
            left -= 1
            if left == 0:
                os.kill(os.getpid(), signal.SIGKILL)

    return hook


def test_wherever_it_is_killed_each_report_is_found_once_and_the_next_run_ends_it(days, tmp_path, monkeypatch):
    monkeypatch.setattr(compaction, "LEVEL", 1)
    before, told = rows_of(days.rglob("*.parquet")), asked(days, ("a",))
    place = tmp_path / "killed"
    place.mkdir()
    process = KILLED.Process(target=end_everywhere, args=(days, place))
    process.start()
    process.join(60)
    assert process.exitcode == 0
    states = set()
    folders = sorted(place.iterdir())
    for folder in folders:
        assert rows_of(path for name in counting(folder) for path in files_in(folder / name)) == before
        states.add(tuple(names_in(folder)))
    for folder in some(folders):
        assert asked(folder, ("a",)) == told
        join_months(folder, DECEMBER + OVER)
        assert rows_of(folder.rglob("*.parquet")) == before
        assert names_in(folder) == ["day=2023-11", "day=2023-12-01", "day=2023-12-02"]
    assert len(folders) > 20
    assert len(states) >= 6, "before, while and after it is made, while and after its days are taken away"


def test_who_has_looked_where_the_files_are_reads_them_all_the_same(days, monkeypatch):
    told, first, read = asked(days), [True], kept_days.of_robot

    def later(path, robot):
        if first.pop() if first else False:
            join_months(days, DECEMBER + OVER)
        return read(path, robot)

    monkeypatch.setattr(kept_days, "of_robot", later)
    assert asked(days) == told
    assert not first


def test_what_was_moved_from_months_is_answered_as_before(template, days, tmp_path, monkeypatch):
    monkeypatch.setattr(kept_days, "LEAST_KEPT", -100)
    shutil.copy(template / "fleet.db", tmp_path / "fleet.db")

    def answers(folder):
        found = [history(store, name, None, None, points, folder) for name in NAMES for points in (10_000, 20, 7)]
        return [(*(each.tobytes() for each in one.series[1:]), one.series.width, one[1:]) for one in found]

    with FleetStore(tmp_path / "fleet.db") as store:
        told = answers(None)
        join_months(days, DECEMBER + OVER)
        assert write_days(store, days, FIRST + 9 * DAY).days == (), "days of a month are not written again"
        assert answers(days) == told
        half = sum(seq % DAYS < 2 for seq in range(1, 60)) * len(EPOCHS) * len(NAMES)
        assert move_out(store, days, FIRST + 2 * DAY) == (half, 0)
        assert answers(days) == told
        join_months(days, DECEMBER + 40 * DAY)
        assert names_in(days) == ["day=2023-11", "day=2023-12"]
        assert move_out(store, days, FIRST + 9 * DAY) == (59 * len(EPOCHS) * len(NAMES) - half, 0)
        assert answers(days) == told


def test_a_damaged_day_stays_as_it_is(days):
    (path,) = days.glob("day=2023-11-30/design=courier/*")
    content = bytearray(path.read_bytes())
    content[len(content) // 3] ^= 4
    path.write_bytes(content)
    before = names_in(days)
    with pytest.raises(RobophmError, match=f"{path}: .*expected a day as robophm fleet export wrote it"):
        join_months(days, DECEMBER + OVER)
    assert [name for name in names_in(days) if name.startswith("day=")] == before


def test_as_people_ask(template, tmp_path):
    words = ["fleet", "export", "--store", str(template / "fleet.db"), "--to", str(tmp_path / "days")]
    said = json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)
    assert (len(said["days"]), said["joined"]["months"]) == (DAYS, ["2023-11", "2023-12"])
    shutil.rmtree(tmp_path / "days" / "day=2023-12")
    text = CliRunner().invoke(app, words).stdout
    assert "2 days" in text
    assert "Joined: the days of 2023-12, " in text
