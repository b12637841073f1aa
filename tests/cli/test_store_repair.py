"""A store that a clock in 2038 had ended before jumps were set aside: brought back to before it, a copy kept."""

from __future__ import annotations

import json

import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore

from ..monitoring.designs import IN_2038, MEASURED, MOTOR, WARM, written
from ..monitoring.designs import MEASURED_AS as T

START = 1_795_000_020 * SECOND
COMPONENTS = {
    **MOTOR,
    "seal": {"life": {"distribution": "weibull", "scale": "40 h", "shape": 2.5}, "scaling": "hazard", **WARM},
    "shelf": {"life": {"distribution": "weibull", "scale": "200000 h", "shape": 2}, "clock": "calendar"},
}


@pytest.fixture
def poisoned(tmp_path):
    """Ten hours in whole periods of a minute, then 20 s in 2038, each sample taken as it came, as it once was."""
    (tmp_path / "robot.yaml").write_text(written(**MEASURED, components=COMPONENTS))
    robot = load(tmp_path / "robot.yaml")
    monitor = Monitor(robot)
    for second in range(0, 36_000, 2):
        monitor.observe(Sample(START + second * SECOND, T, 35.0 + second // 9000))
    monitor.observe(Sample(START + 36_001 * SECOND, T, 40.0))
    good = monitor.ledger.copy()
    for second in range(0, 70, 2):
        monitor._take(Sample(IN_2038 + second * SECOND, T, 60.0))
    with SqliteStore(tmp_path / "past.db") as store:
        reports = [{"time": START + 60 * SECOND}, {"time": IN_2038}]
        store.save("R", monitor.ledger.to_json(), (), reports)
    return robot, good


def test_the_ledger_is_that_of_before_the_jump(inside, tmp_path, poisoned):
    robot, good = poisoned
    before = (tmp_path / "past.db").read_bytes()
    done = inside("store", "repair", "robot.yaml", "--store", "past.db")
    assert (done.returncode, done.stderr) == (0, "")
    assert "the clock had jumped from 2026-" in done.stdout
    assert "As it was: past.db.before-repair" in done.stdout
    with SqliteStore(tmp_path / "past.db") as store:
        ledger = store.ledger("R")
        assert [report["time"] for report in store.history("R").reports()] == [START + 60 * SECOND]
    assert ledger["integrated_to"] == good.integrated_to
    now = type(good).of(robot, ledger)
    for name in ("age", "effective", "hazard", "clocks"):
        assert getattr(now, name).value == pytest.approx(
            getattr(good, name).value, rel=1e-7
        )  # stress that scales hazard: at its mean
    with SqliteStore(tmp_path / "past.db.before-repair") as store:
        assert store.ledger("R")["integrated_to"] > IN_2038
    assert before != (tmp_path / "past.db").read_bytes()
    (tmp_path / "next.csv").write_text(
        f"time,{T}\n" + "".join(f"{START // SECOND + 40_000 + i},35\n" for i in range(100))
    )
    again = inside("replay", "robot.yaml", "next.csv", "--store", "past.db", "--json")
    assert again.returncode == 0
    assert json.loads(again.stdout)["clocks"]["calendar"] == pytest.approx(40_099 / 3600, rel=1e-6)


def test_a_store_without_a_jump_is_left_alone(inside, tmp_path, poisoned):
    inside("store", "repair", "robot.yaml", "--store", "past.db")
    with SqliteStore(tmp_path / "past.db") as store:
        before = store.ledger("R")
    done = inside("store", "repair", "robot.yaml", "--store", "past.db", "--json")
    assert json.loads(done.stdout) == {"schema_version": 1, "robot": "R", "repaired": None, "copy": None}
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R") == before


def test_a_copy_that_is_there_is_never_written_over(inside, tmp_path, poisoned):
    (tmp_path / "past.db.before-repair").write_text("mine")
    done = inside("store", "repair", "robot.yaml", "--store", "past.db")
    assert done.returncode == 3
    assert done.stderr.startswith("error: past.db.before-repair: exists; expected no such file")
    assert (tmp_path / "past.db.before-repair").read_text() == "mine"
    with SqliteStore(tmp_path / "past.db") as store:
        assert store.ledger("R")["integrated_to"] > IN_2038


@pytest.fixture
def lags(tmp_path):
    """A past whose robot came back after 800 days: its time goes on without the clock."""
    (tmp_path / "robot.yaml").write_text(written(**MEASURED, components=COMPONENTS))
    monitor = Monitor(load(tmp_path / "robot.yaml"))
    for second in range(200):
        monitor.observe(Sample(START + second * SECOND, T, 35.0))
        monitor.observe(Sample(START + second * SECOND, "clock", 800 * 86_400.0 if second > 99 else float("nan")))
    with SqliteStore(tmp_path / "past.db") as store:
        store.save("R", monitor.ledger.to_json())


def test_what_the_clock_is_ahead_by_is_taken_in_or_struck_out(inside, tmp_path, lags):
    asked = inside("store", "repair", "robot.yaml", "--store", "past.db")
    assert asked.returncode == 0
    assert "the clock was 19,200.00 h ahead" in asked.stdout
    assert "expected --take-in or --strike-out" in asked.stdout
    both = inside("store", "repair", "robot.yaml", "--store", "past.db", "--take-in", "--strike-out")
    assert (both.returncode, both.stderr) == (3, "error: --take-in or --strike-out? expected one of them\n")
    done = inside("store", "repair", "robot.yaml", "--store", "past.db", "--take-in", "--json")
    told = json.loads(done.stdout)
    assert (told["repaired"]["outcome"], told["repaired"]["ahead"]) == ("taken in", 800 * 86_400.0)
    with SqliteStore(tmp_path / "past.db") as store:
        high, low = store.ledger("R")["totals"]["clocks"]
    assert high[1] + low[1] == pytest.approx((199 + 800 * 86_400) / 3600, rel=1e-12)
    assert high[0] + low[0] == pytest.approx(199 / 3600, rel=1e-9)
    again = inside("store", "repair", "robot.yaml", "--store", "past.db", "--strike-out")
    assert again.returncode == 3
    assert again.stderr.startswith("error: the clock was plausible when it was last heard")


def test_a_damaged_store_is_made_anew(inside, tmp_path, lags):
    path = tmp_path / "past.db"
    raw = bytearray(path.read_bytes())
    raw[raw.index(b'"totals"') + 3] ^= 1
    path.write_bytes(raw)
    refused = inside("report", "robot.yaml", "--store", "past.db")
    assert refused.returncode == 3
    assert refused.stderr == (
        "error: past.db: the ledger of R is damaged: its checksum is another; "
        "robophm store repair goes back to the last good state\n"
    )
    done = inside("store", "repair", "robot.yaml", "--store", "past.db")
    assert (done.returncode, done.stderr) == (0, "")
    assert "the past of R is that of the last good state. As it was: past.db.damaged" in " ".join(done.stdout.split())
    assert inside("report", "robot.yaml", "--store", "past.db").returncode == 0
