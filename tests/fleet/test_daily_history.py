"""A fleet's days as Parquet: read back by pyarrow they are the store's own rows, to the bit, each once."""

from __future__ import annotations

import json

import numpy as np
import pytest
from tests.fleet.made_reports import BEGIN
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import RobophmError, StoreError
from robophm.core.single_writer import only_one
from robophm.fleet import daily_history, history_files
from robophm.fleet.daily_history import DAY, write_days
from robophm.fleet.history_files import OVER
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.questions import reports
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
dataset = pytest.importorskip("pyarrow.dataset", reason="pyarrow is not installed")

FIRST = BEGIN // DAY * DAY
ROBOTS = {"a": "courier", "b": "Röntgen 50 %/h", "c": None, "d": "x" * 300, "e": "courier"}
OF = {**ROBOTS, "d": None}
"""Designs as the files tell them: a name that is too long for a folder is not told."""


@pytest.fixture
def store(address):
    """Two epochs of each robot over three days, with values at the ends of single precision."""
    chance = np.random.default_rng(1)
    with FleetStore(address, make=True) as opened:
        for name, design in ROBOTS.items():
            opened.add_token(name)
            said = {"robot": design, "design_hash": "d1", "time": BEGIN}
            state = PresentState(1, "{}", said if design else None, ())
            for epoch in ("a" * 16, "b" * 16):
                told = []
                for seq in range(1, 40):
                    figures = chance.lognormal(0, 30, len(COLUMNS))
                    figures[chance.random(len(COLUMNS)) < 0.2] = np.nan
                    figures[:3] = -np.inf if seq == 5 else np.inf, 1e-46 * (seq % 2), -0.0
                    told.append(Report(seq, 2**63 - seq, seq % 3, tuple(map(float, figures))))
                opened.commit([Payload(name, epoch, BEGIN, 0, tuple(told), state)])
        changed(opened, f"received = {FIRST} + (seq / 14) * {DAY} + seq")
        yield opened


def changed(store, how, *values):
    """Change rows of reports behind the back of the store."""
    with store.writing() as engine:
        engine.ask(f"UPDATE report SET {how} RETURNING robot", values)


def of_store(store):
    """The rows as they are kept; behind the figures is their checksum."""
    rows = store.rows("SELECT name, epoch, seq, time, received, thinned, figures FROM report JOIN robot ON "
                      "robot.number = report.robot")  # fmt: skip
    return sorted((*row[:-1], row[-1][:-4]) for row in rows)


def of_files(folder):
    found = dataset.dataset(folder, partitioning="hive", exclude_invalid_files=True).to_table()
    figures = np.column_stack([found[name].to_numpy().astype("<f4") for name in COLUMNS])
    whole = [found["robot"].to_pylist(), *(found[name].cast("int64").to_pylist() for name in
                                           ("epoch", "seq", "time", "received", "thinned"))]  # fmt: skip
    rows = sorted((*row, figures[at].tobytes()) for at, row in enumerate(zip(*whole, strict=True)))
    return rows, {*zip(found["robot"].to_pylist(), found["design"].to_pylist(), strict=True)}, found


def test_what_is_read_back_are_the_rows_of_the_store_to_the_bit(store, tmp_path, monkeypatch):
    monkeypatch.setattr(daily_history, "AT_ONCE", 7)  # several reads, and below groups of rows
    monkeypatch.setattr(history_files, "AT_ONCE", 7)
    made = write_days(store, tmp_path / "days", FIRST + 3 * DAY + OVER)
    rows, designs, found = of_files(tmp_path / "days")
    assert rows == of_store(store)
    assert len(rows) == made.rows == 39 * 2 * len(ROBOTS)
    assert designs == {*OF.items()}
    assert found["hazard_rate.nominal"].null_count == 0  # infinite is a value
    assert found[COLUMNS[5]].null_count == sum(np.isnan(one.figures[5]) for one in reports(store)) > 0
    first = tmp_path / "days" / "day=2023-11-14" / "design=courier" / "reports.parquet"
    group = parquet.ParquetFile(first).metadata.row_group(0)
    assert {group.column(at).compression for at in range(group.num_columns)} == {"ZSTD"}
    assert all("BYTE_STREAM_SPLIT" in group.column(at).encodings for at in range(6, group.num_columns))
    files = [*(tmp_path / "days").rglob("*.parquet")]
    assert made.size == sum(one.stat().st_size for one in files)


def test_days_are_written_once_and_when_they_are_over(store, tmp_path):
    folder = tmp_path / "days"
    assert write_days(store, folder, FIRST + DAY + OVER - 1).days == ()
    assert write_days(store, folder, FIRST + DAY + OVER).days == ("2023-11-14",)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*.parquet")}
    assert write_days(store, folder, FIRST + 9 * DAY).days == ("2023-11-15", "2023-11-16")
    assert write_days(store, folder, FIRST + 9 * DAY).days == ()
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert of_files(folder)[0] == of_store(store)


def test_what_ends_half_way_is_gone_on_with(store, tmp_path):
    folder = tmp_path / "days"
    last = "WHERE robot = 5 AND epoch = 2 AND seq = 39"
    ((kept,),) = store.rows(f"SELECT figures FROM report {last}")
    changed(store, f"figures = ? {last}", b"x")
    with pytest.raises(StoreError, match="report 39 of epoch 2 of robot 5 is damaged"):
        write_days(store, folder, FIRST + 9 * DAY)
    assert [*folder.glob("day=*")] == []
    changed(store, f"figures = ? {last}", kept)
    with only_one(folder / ".lock"), pytest.raises(RobophmError, match="is being written by process"):
        write_days(store, folder, FIRST + 9 * DAY)
    write_days(store, folder, FIRST + 9 * DAY)
    assert of_files(folder)[0] == of_store(store)
    assert sorted(path.name for path in folder.iterdir()) == ["day=2023-11-14", "day=2023-11-15", "day=2023-11-16"]


def test_as_people_ask(store, address, tmp_path):
    words = ["fleet", "export", "--store", address, "--to", str(tmp_path / "days")]
    said = json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)
    assert (said["days"], said["rows"]) == (["2023-11-14", "2023-11-15", "2023-11-16"], len(of_store(store)))
    assert "no new day" in CliRunner().invoke(app, words).stdout
    assert "expected no --force" in str(CliRunner().invoke(app, [*words, "--force"]).exception)
