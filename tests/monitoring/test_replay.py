"""Recordings replayed: in any format, in pieces, killed on the way, and refused where they do not fit."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from mpmath import mp, mpf

import robophm
from robophm.core.errors import SourceError, StoreError
from robophm.core.signal import HOUR, SECOND
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitoring.recording_sessions import sessions_of
from robophm.monitoring.replay import replay
from robophm.stores.memory import MemoryStore
from robophm.transports.synthetic import SyntheticOta

from .designs import bound, exact, robot
from .killed import is_as_if_undisturbed, killed

OTA = Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml"
START = 1_700_000_040 * SECOND  # a whole minute


@pytest.fixture(scope="module")
def ota() -> Robot:
    return robophm.load(OTA)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Four minutes of the synthetic robot in the three formats, by suffix."""
    folder, drive = tmp_path_factory.mktemp("recorded"), SyntheticOta(seed=5, duration=240 * SECOND)
    return {suffix: drive.record(folder / f"drive{suffix}") for suffix in (".bag", ".db3", ".mcap")}


# One drive, many files.


def test_three_formats_are_one_drive(ota: Robot, recorded: dict[str, Path]) -> None:
    stores = {suffix: MemoryStore() for suffix in recorded}
    reports = [replay(ota, path, store=stores[suffix]).to_json() for suffix, path in recorded.items()]
    assert reports[0]["clocks"]["kilometres"] > 0
    assert reports[0] == reports[1] == reports[2]
    ledgers = [store.ledger(ota.name) for store in stores.values()]
    assert ledgers[0] == ledgers[1] == ledgers[2]
    assert ledgers[0]


def test_a_recording_is_counted_once_in_whatever_pieces(ota: Robot, recorded: dict[str, Path]) -> None:
    store = MemoryStore()
    first = replay(ota, recorded[".mcap"], store=store, period=20, report_every=60)
    kept, history = store.ledger(ota.name), list(store.history(ota.name).reports())
    start = SyntheticOta(duration=SECOND).times[0]
    assert [(one["time"] - start) / SECOND for one in history] == [20, 60, 120, 180]  # the first, and every minute
    again = replay(ota, recorded[".mcap"], store=store, period=20, report_every=60)
    assert (again.to_json(), store.ledger(ota.name), list(store.history(ota.name).reports())) == (
        first.to_json(),
        kept,
        history,
    )


@pytest.mark.full
def test_a_replay_killed_again_and_again_ends_as_one_that_was_not(
    ota: Robot, recorded: dict[str, Path], tmp_path: Path
) -> None:
    path = tmp_path / "killed.db"
    (drive,) = sessions_of(ota, recorded[".mcap"])
    progress = [store.progress(ota.name, drive.key)
                for store in killed(OTA, recorded[".mcap"], path, ticks=(20, 70), seed=4)]  # fmt: skip
    assert progress[-1].complete
    assert sum(one.position > 0 and not one.complete for one in progress) >= 2  # killed on the way
    is_as_if_undisturbed(OTA, recorded[".mcap"], path)


def test_a_store_of_a_part_that_may_have_another_name_is_refused(ota: Robot, recorded: dict[str, Path]) -> None:
    store = MemoryStore()
    replay(ota, recorded[".mcap"], store=store)
    other = parse(OTA.read_text(encoding="utf-8").replace("YSK-G", "YSK-H"))
    with pytest.raises(
        StoreError,
        match=r"'Computation/YSK-H' has no past, and 'Computation/YSK-G' has one, but is gone: whether",
    ):
        replay(other, recorded[".mcap"], store=store)


def test_a_clock_that_came_to_be_measured_starts_then(ota: Robot, recorded: dict[str, Path]) -> None:
    """The parts are the same, so that their past goes on; the robot's own clocks are kept by their names."""
    text = OTA.read_text(encoding="utf-8")
    before = parse(text[: text.index("clocks:")] + text[text.index("thresholds:") :])
    store, whole = MemoryStore(), replay(ota, recorded[".mcap"]).clocks
    replay(before, recorded[".mcap"], store=store)
    after = replay(ota, recorded[".bag"], store=store).clocks  # the same drive: late, but for the open window
    assert after["operating"] == pytest.approx(whole["operating"], rel=1e-3)
    assert 0 < after["kilometres"] < whole["kilometres"]


# Recordings that nobody here made.


def raw(path: Path, topic: str) -> list[tuple[int, Any]]:
    """Receipt times and messages, straight from rosbags."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.ROS1_NOETIC)) as reader:
        chosen = [connection for connection in reader.connections if connection.topic == topic]
        return [(at, reader.deserialize(data, c.msgtype)) for c, at, data in reader.messages(connections=chosen)]


def test_turtle_drove_so_many_metres(shared: Path) -> None:
    pose = {"kilometres": {"topic": "/turtle1/pose", "position": ["x", "y"]}}
    report = replay(robot(clocks=pose), shared / "recordings" / "turtlesim.bag")
    assert round(1000 * report.clocks["kilometres"], 4) == 28.3520
    assert round(3600 * report.clocks["calendar"], 3) == 21.489
    poses = raw(shared / "recordings" / "turtlesim.bag", "/turtle1/pose")
    way = sum(mp.hypot(mpf(b.x) - mpf(a.x), mpf(b.y) - mpf(a.y)) for (_, a), (_, b) in pairwise(poses))
    assert report.clocks["kilometres"] == exact(way / 1000)


def test_temperature_as_it_was_received(shared: Path) -> None:
    """All header stamps are zero, so that the receipt times count."""
    path = shared / "recordings" / "temperature.bag"
    messages = raw(path, "/my_temperature")
    assert {message.header.stamp.sec for _, message in messages} == {0}
    store = MemoryStore()
    replay(robot(**bound("/my_temperature", "temperature")), path, store=store)
    report = replay(robot(**bound("/my_temperature", "temperature")), path)
    H = sum(
        mpf("0.01") * mpf(2) ** ((mpf(float(message.temperature)) - 25) / 10) * (until - at) / HOUR
        for (at, message), (until, _) in pairwise(messages)
    )
    assert report.system.sensor_based.unreliability == exact(-mp.expm1(-H))
    assert report.clocks["operating"] == exact(Fraction(messages[-1][0] - messages[0][0], HOUR))
    assert f"receipt time used for /my_temperature ({len(messages)} times)" in report.notes


def test_what_a_recording_lacks(recorded: dict[str, Path]) -> None:
    missing = robot(**bound("/ota/motility/temperature", "temperature"))
    with pytest.raises(SourceError, match=r"no topic '/ota/motility/temperature'.*/ota/mobility/temperature"):
        replay(missing, recorded[".mcap"])
    with pytest.raises(SourceError, match="none of the design's topics"):
        replay(missing, recorded[".mcap"], skip_missing=True)
    with pytest.raises(SourceError, match=r"no number 'temprature'.*temperature"):
        replay(robot(**bound("/ota/mobility/temperature", "temprature")), recorded[".mcap"])
    with pytest.raises(SourceError, match="voltage is in 'V'; the design expects 'degC'"):
        replay(robot(**bound("/ota/battery", "voltage")), recorded[".mcap"])


def test_one_missing_signal_stays_silent_if_that_is_wanted(recorded: dict[str, Path]) -> None:
    clock = {"kilometres": {"topic": "/ota/odom", "position": ["pose.pose.position.x", "pose.pose.position.y"]}}
    design = robot(**bound("/nowhere", "temperature"), clocks=clock)
    report = replay(design, recorded[".mcap"], skip_missing=True)
    assert report.system.flags == ("stale /nowhere.temperature",)
    assert report.system.sensor_based.reliability == report.system.nominal.reliability < 1


def test_a_recording_older_than_the_ledger_is_refused(ota: Robot) -> None:
    """Tuesday, then Monday: nothing of Monday could count, and nothing is marked as counted."""
    monday, tuesday = (
        SyntheticOta(start=START + day * 24 * HOUR, duration=600 * SECOND, working_hours=(0, 24)) for day in (0, 1)
    )
    store = MemoryStore()
    replay(ota, tuesday, store=store)
    before = store.ledger(ota.name)
    with pytest.raises(SourceError, match="would not count; expected recordings in the order of their time"):
        replay(ota, monday, store=store)
    assert store.ledger(ota.name) == before


# Many recordings.


def hours(count: int, folder: Path, suffix: str = ".mcap") -> list[Path]:
    """So many drives of 20 minutes, an hour apart."""
    return [
        SyntheticOta(
            seed=3 + i, start=START + i * HOUR, duration=1200 * SECOND, working_hours=(0, 24)
        ).record(folder / f"{'zyxwv'[i]}{suffix}")
        for i in range(count)
    ]  # fmt: skip


def test_a_folder_is_gone_through_in_order_of_time(ota: Robot, tmp_path: Path) -> None:
    """File by file, as one after the other by hand, and as all of them as one drive."""
    bags = tmp_path / "bags"
    bags.mkdir()
    paths = hours(3, bags)
    apart, together, whole = MemoryStore(), MemoryStore(), MemoryStore()
    for path in paths:
        last = replay(ota, path, store=apart)
    assert replay(ota, bags, store=together) == last
    with robophm.open_source(*paths) as source:
        assert replay(ota, source, store=whole).to_json() == last.to_json()
    assert together.ledger(ota.name) == apart.ledger(ota.name) == whole.ledger(ota.name)
    assert last.clocks["calendar"] == pytest.approx(2 + 1199 / 3600, rel=1e-6)


def test_a_recording_that_is_new_in_the_folder_is_counted_alone(ota: Robot, tmp_path: Path) -> None:
    bags = tmp_path / "bags"
    bags.mkdir()
    paths = hours(3, tmp_path)
    kept, fresh = MemoryStore(), MemoryStore()
    for path in paths:
        path.rename(bags / path.name)
        replay(ota, bags, store=kept)
    replay(ota, bags, store=fresh)
    assert kept.ledger(ota.name) == fresh.ledger(ota.name)


def test_recordings_that_overlap_are_one_drive(ota: Robot, tmp_path: Path) -> None:
    from rosbags.rosbag1 import Reader, Writer

    whole = hours(1, tmp_path, ".bag")[0]
    parts = tmp_path / "parts"
    parts.mkdir()
    with Reader(whole) as reader, Writer(parts / "odom.bag") as odom, Writer(parts / "rest.bag") as rest:
        known = {}
        for connection, at, data in reader.messages():
            writer = odom if connection.topic == "/ota/odom" else rest
            if connection.id not in known:
                known[connection.id] = writer.add_connection(
                    connection.topic, connection.msgtype, msgdef=connection.msgdef.data, md5sum=connection.digest
                )
            writer.write(known[connection.id], at, data)
    assert len(sessions_of(ota, parts)) == 1
    assert replay(ota, parts).to_json() == replay(ota, whole).to_json()


def test_a_signal_must_be_in_one_of_them(ota: Robot, recorded: dict[str, Path], tmp_path: Path) -> None:
    """One drive without an odometer is no mistake, all of them are."""
    other = tmp_path / "other.csv"
    other.write_text("time,/ota/power/temperature.temperature\n1600000000,24\n1600000010,24\n")
    drives = sessions_of(ota, [recorded[".mcap"], other])
    assert [len(drive.signals) for drive in drives] == [1, len(ota.signals)]
    with pytest.raises(SourceError, match="the recording has no topic '/ota/"):
        sessions_of(ota, [other])
