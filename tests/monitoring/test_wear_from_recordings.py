"""Wear read from recordings: readings as plain loops over the samples give them, on the part's own clock."""

import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.typesys import Stores, get_typestore

from robophm.core.errors import DataError, DesignError, SourceError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.monitoring.wear_from_recordings import holds_readings, wear_history, worn_modes
from robophm.transports.recordings.journal import Journal
from robophm.transports.recordings.recording import Recording

STORE = get_typestore(Stores.ROS2_HUMBLE)
START = 1_700_000_010 * SECOND  # a multiple of half a minute
HOUR = 3600
EVERY, STRETCHES = 30, 65  # s; of each of two drives, an hour apart

ROBOT = """
schema_version: 1
name: cart
usage: {operating: 0.5, kilometres: 2 km/h}
components:
  motor:
    rate: 20 FPMH
    wear: {topic: /current, field: data, every: 30 s, threshold: 8,
           load: {topic: /load, field: data, range: [2, 3], max_age: 2 s}}
  fan: {rate: 5 FPMH, wear: {topic: /vibration, field: data, reading: kurtosis, every: 30 s, threshold: 30}}
  gearbox: {rate: 5 FPMH, wear: {topic: /vibration, field: data, reading: rms, every: 30 s, threshold: 12}}
  bearing:
    rate: 9 FPMH
    wear: {topic: /bearing, field: temperature, unit: degC, every: 30 s, threshold: 60 K,
           ambient: {topic: /air, field: temperature, range: [-40, 60], max_age: 10 s}}
  computer: {rate: 2 FPMH}
"""


class Drives:
    """What was sampled, as arrays; and the two files that hold it, receipt a little after the stamps and mixed up."""

    def __init__(self, folder: Path) -> None:
        rng = np.random.default_rng(5)
        n = EVERY * STRETCHES
        second = np.concatenate((np.arange(n), np.arange(n) + n + HOUR))
        worn = np.arange(2 * n) / (2 * n)  # 0 … 1 over the time that it worked
        self.time = START + second * SECOND
        self.load = np.where(rng.random(2 * n) < 0.4, rng.uniform(2, 3, 2 * n), rng.uniform(0, 6, 2 * n))
        self.current = 2 * self.load + 1 + 0.5 * worn + 0.1 * rng.standard_normal(2 * n)
        knocks = np.where(rng.random(2 * n) < 0.05, 1 + 4 * worn, 1.0)
        self.vibration = 3 + (1 + worn) * knocks * rng.standard_normal(2 * n)
        self.air = 20 + 5 * np.sin(second / 500)
        self.bearing = self.air + 30 + 3 * worn + 0.3 * rng.standard_normal(2 * n)
        self.air[100] = 900.0  # a broken reading
        self.current[17] = math.nan
        self.paths = [folder / "one.mcap", folder / "two.mcap"]
        for path, rows in zip(self.paths, (slice(0, n), slice(n, None)), strict=True):
            self._write(path, rows, rng)

    def _write(self, path, rows, rng):
        types = STORE.types
        plain = {"/load": self.load, "/current": self.current, "/vibration": self.vibration}
        stamped = {"/air": self.air, "/bearing": self.bearing}
        messages = []
        for topic, values in (plain | stamped).items():
            for time, value in zip(self.time[rows].tolist(), values[rows].tolist(), strict=True):
                if topic in plain:
                    messages.append((time, topic, types["std_msgs/msg/Float64"](value)))
                elif topic == "/bearing" or time // SECOND % 5 == 0:
                    header = types["std_msgs/msg/Header"](
                        types["builtin_interfaces/msg/Time"](*divmod(time, SECOND)), ""
                    )
                    late = int(rng.integers(0, SECOND))  # received up to a second later
                    messages.append((time + late, topic, types["sensor_msgs/msg/Temperature"](header, value, 0.0)))
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start(profile="ros2")
            channels = {}
            for topic in (*plain, *stamped):
                kind = "std_msgs/msg/Float64" if topic in plain else "sensor_msgs/msg/Temperature"
                definition = STORE.generate_msgdef(kind, ros_version=2)[0].encode()
                channels[topic] = writer.register_channel(
                    topic, "cdr", writer.register_schema(kind, "ros2msg", definition)
                )
            for received, topic, message in sorted(messages, key=lambda one: one[0]):
                raw = bytes(STORE.serialize_cdr(message, message.__msgtype__))
                writer.add_message(channels[topic], received, raw, received)
            writer.finish()

    def operating(self, time):
        """Hours that the robot had been on by then: off from a minute after the first drive's last sample."""
        first_end = self.time[EVERY * STRETCHES - 1] + 60 * SECOND
        begun = self.time[EVERY * STRETCHES]
        on = time - START if time < begun else first_end - START + time - begun
        return on / (HOUR * SECOND)

    def by_stretch(self, values, counts):
        """Plain loops: by stretch, the values that count."""
        found: dict[int, list[float]] = {}
        for time, value, use in zip(self.time.tolist(), values.tolist(), counts, strict=True):
            if use:
                found.setdefault(time // (EVERY * SECOND), []).append(value)
        return found


@pytest.fixture(scope="module")
def drives(tmp_path_factory):
    return Drives(tmp_path_factory.mktemp("drives"))


@pytest.fixture(scope="module")
def history(drives):
    robot = parse(ROBOT, "robot.yaml")
    return wear_history(robot, [drives.paths[0].parent], worn_modes(robot))


def test_readings_are_those_of_plain_loops(drives, history):
    at_load = (drives.load >= 2) & (drives.load <= 3) & ~np.isnan(drives.current)
    expected = {
        "motor": [np.mean(some) for some in drives.by_stretch(drives.current, at_load).values() if len(some) >= 3],
        "gearbox": [
            math.sqrt(np.mean((np.array(some) - np.mean(some)) ** 2))
            for some in drives.by_stretch(drives.vibration, np.ones(len(drives.time), bool)).values()
        ],
        "fan": [
            np.mean((np.array(some) - np.mean(some)) ** 4) / np.mean((np.array(some) - np.mean(some)) ** 2) ** 2
            for some in drives.by_stretch(drives.vibration, np.ones(len(drives.time), bool)).values()
        ],
    }
    for name, values in expected.items():
        assert history.readings[name].values == pytest.approx(values, rel=1e-9), name
        assert len(history.readings[name].ages) == len(values)


def test_an_ambient_is_taken_off_as_it_was_last_heard(drives, history):
    last, above, known = None, [], []
    for time, air, bearing in zip(drives.time.tolist(), drives.air.tolist(), drives.bearing.tolist(), strict=True):
        if time // SECOND % 5 == 0 and -40 <= air <= 60:
            last = time, air
        is_known = last is not None and time - last[0] < 10 * SECOND
        known.append(is_known)
        above.append(bearing - last[1] if is_known else math.nan)
    found = drives.by_stretch(np.array(above), known)
    assert history.readings["bearing"].values == pytest.approx([np.mean(some) for some in found.values()], rel=1e-9)


def test_they_stand_on_the_parts_own_clock(drives, history):
    """Off for an hour between the drives, in which nothing wears; within a minute the clock is taken to go evenly."""
    readings = history.readings["gearbox"]
    expected = [drives.operating(int(time)) for time in readings.when]
    assert readings.ages == pytest.approx(expected, abs=61 / HOUR)  # a minute when a drive begins
    assert readings.ages[-1] - readings.ages[0] == pytest.approx(expected[-1] - expected[0], abs=61 / HOUR)
    assert readings.effective == pytest.approx(readings.ages, rel=1e-12)  # no stress changes it
    assert history.monitor.ledger.clocks.value[0] > 1


def test_what_does_not_count_is_said(history):
    said = " ".join(history.notes)
    assert history.notes["not finite: /current.data"] == 1
    assert "bearing: samples without a known ambient" not in said  # the broken one is bridged by the one before


def test_a_journal_of_the_run_says_the_same(drives, history, tmp_path):
    robot = parse(ROBOT, "robot.yaml")
    with Journal(tmp_path / "run.journal", robot.signals) as journal:
        for path in drives.paths:
            with Recording(path) as recording:
                for sample in recording.samples(list(robot.signals)):
                    journal.write(sample)
            journal.write(Sample(sample.time, "clock", math.nan))
    again = wear_history(robot, tmp_path / "run.journal", worn_modes(robot))
    for name, readings in history.readings.items():
        assert again.readings[name].values == pytest.approx(readings.values, rel=1e-9)
        assert again.readings[name].ages == pytest.approx(readings.ages, abs=61 / HOUR)


@pytest.mark.parametrize(
    ("wear", "said"),
    [
        ("{topic: /a, field: b}", "threshold"),
        ("{topic: /a, field: b, threshold: 3 A}", "does not measure"),
        ("{topic: /a, field: b, unit: A, threshold: 3}", "no unit"),
        ("{topic: /a, field: b, threshold: 3, reading: peak}", "'mean', 'rms', 'kurtosis', 'highest' or 'lowest'"),
        ("{topic: /a, field: b, threshold: 3, load: {topic: /l, field: x}}", "load has no range"),
        ("{topic: /a, field: b, threshold: 3, range: [2, 1]}", "does not ascend"),
        ("{topic: /a, field: b, threshold: 3, every: 0 s}", "too small"),
        ("{topic: /a, field: b, threshold: 3, evry: 1 h}", "did you mean 'every'"),
        ("{topic: a b, field: b, threshold: 3}", "is not a topic"),
        ("{topic: /a, field: b, threshold: 3, threshold_deviation: -1}", "-1 is negative; expected at least 0"),
        ("{topic: /a, field: b, unit: A, threshold: 3 A, threshold_deviation: 1 V}", "does not measure"),
    ],
)
def test_what_a_design_cannot_say(wear, said):
    with pytest.raises(DesignError, match=r"robot\.yaml:4") as error:
        parse(f"schema_version: 1\nname: x\ncomponents:\n  m: {{rate: 1 FPMH, wear: {wear}}}\n", "robot.yaml")
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("wear", "deviation"),
    [
        ("unit: degC, threshold: 60 degC, threshold_deviation: 3 K", 3.0),
        ("unit: degF, threshold: 60 degF, threshold_deviation: 5 K", 9.0),
        ("unit: A, threshold: 6 A, threshold_deviation: 200 mA", 0.2),
        ("reading: kurtosis, unit: A, threshold: 6, threshold_deviation: 2", 2.0),
        ("threshold: 6", 0.0),
    ],
)
def test_how_well_a_threshold_is_known_is_a_difference(wear, deviation):
    said = f"wear: {{topic: /a, field: b, {wear}}}"
    robot = parse(f"schema_version: 1\nname: x\ncomponents:\n  m: {{rate: 1 FPMH, {said}}}\n")
    assert robot.modes[0].wear.threshold_deviation == pytest.approx(deviation)


def test_one_signal_is_of_one_part():
    part = "{rate: 1 FPMH, quantity: 2, wear: {topic: /a, field: b, threshold: 3}}"
    text = f"schema_version: 1\nname: x\ncomponents:\n  m: {part}\n"
    with pytest.raises(DesignError, match="of one part, not of 2"):
        parse(text, "robot.yaml")


def test_signals_of_wear_are_listened_to_and_missed():
    robot = parse(ROBOT, "robot.yaml")
    assert dict(robot.signals) == {
        "/current.data": None, "/load.data": None, "/vibration.data": None,
        "/bearing.temperature": "degC", "/air.temperature": "degC",
    }  # fmt: skip
    with pytest.raises((SourceError, DataError)):
        wear_history(robot, Path("nowhere.mcap"), worn_modes(robot))


def test_of_a_line_without_end_only_the_begin_is_looked_at(tmp_path):
    table = tmp_path / "commas.csv"
    table.write_bytes(b"," * 20_000_000)
    tracemalloc.start()
    try:
        holds_readings(table)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 30_000_000  # twenty million cells would take eight times as much
