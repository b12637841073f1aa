"""One number made of an array of raw samples: formulas of others, and every kind of recording."""

from pathlib import Path

import numpy as np
import pytest
import scipy.signal
import scipy.stats
from rosbags.rosbag1 import Writer as Bag
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Bag2
from rosbags.typesys import Stores, get_typestore

from robophm.core.errors import DesignError, SourceError
from robophm.core.signal import SECOND, Reduction, reduction_of, signal_name, steps_of
from robophm.design.file import parse
from robophm.monitoring.wear_from_recordings import wear_history, worn_modes
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.opening import open_source
from robophm.transports.signals.array_reduction import reduced

RNG = np.random.default_rng(6)
START = 1_700_000_000
RATE = 1000.0
SIGNALS = ("/raw.data[:rms]", "/raw.data[:kurtosis]", "/raw.data[:peak]", "/raw.data[:band 90-210 of 1000]")


def arrays(count: int) -> list[np.ndarray]:
    t = np.arange(512) / RATE
    return [
        (1 + np.sin(2 * np.pi * 125 * t) * (1 + k / count) + 0.3 * RNG.standard_t(4, 512)).astype(np.float32)
        for k in range(count)
    ]


def expected(x: np.ndarray) -> list[float]:
    x = x.astype(float)
    frequencies, power = scipy.signal.periodogram(x, RATE, detrend=False, scaling="spectrum")
    band = (frequencies >= 90) & (frequencies <= 210)
    return [
        float(np.std(x)), float(scipy.stats.kurtosis(x, fisher=False)), float(np.max(np.abs(x - x.mean()))),
        float(np.sqrt(power[band].sum())),
    ]  # fmt: skip


def test_formulas_of_others():
    for x in arrays(5):
        found = [reduced(reduction_of(signal.partition(".")[2])[1], x) for signal in SIGNALS]
        assert found == pytest.approx(expected(x), rel=1e-9)
    whole = Reduction("band", 0.1, 500.0, 1000.0)
    x = RNG.standard_normal(256)
    assert reduced(whole, x) == pytest.approx(x.std(), rel=1e-12)  # Parseval
    assert np.isnan(reduced(Reduction("band", 100.1, 100.2, 1000.0), x))
    assert np.isnan(reduced(Reduction("kurtosis"), np.ones(5)))
    assert np.isnan(reduced(Reduction("rms"), [1.0, np.inf]))
    with pytest.raises(IndexError):
        reduced(Reduction("rms"), [])


def test_what_a_field_path_says():
    assert steps_of("a.data[:band 1.5-20 of 100]")[-1].element == Reduction("band", 1.5, 20.0, 100.0)
    assert steps_of("names[elbow]")[0].element == "elbow"
    for field, said in (
        ("data[:mean]", r"expected \[:rms\], \[:kurtosis\]"),
        ("data[:band 20-10 of 100]", "a band that ascends"),
        ("data[:band 20-60 of 100]", "at most half of the rate, 50 Hz"),
    ):
        with pytest.raises(SourceError, match=said):
            signal_name("/raw", field)
    with pytest.raises(DesignError, match="nothing that is made of an array"):
        parse("{schema_version: 1, name: x, components: {m: {rate: 1 FPMH,"
              " wear: {topic: /a, field: 'd[:x]', threshold: 3}}}}")  # fmt: skip


PLUGINS = {".mcap": StoragePlugin.MCAP, ".db3": StoragePlugin.SQLITE3, ".bag": None}


def recording(path: Path, sent: list[np.ndarray]) -> Path:
    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    kind, types = "std_msgs/msg/Float32MultiArray", store.types
    layout = types["std_msgs/msg/MultiArrayLayout"]([], 0)
    writer = Bag(path) if ros1 else Bag2(path, version=9, storage_plugin=PLUGINS[path.suffix])
    with writer:
        to = writer.add_connection("/raw", kind, typestore=store)
        other = writer.add_connection("/t", "std_msgs/msg/Float64", typestore=store)
        for k, x in enumerate(sent):
            at, message = (START + k) * SECOND, types[kind](layout, x)
            raw = store.serialize_ros1(message, kind) if ros1 else store.serialize_cdr(message, kind)
            writer.write(to, at, bytes(raw))
            value, name = types["std_msgs/msg/Float64"](float(k)), "std_msgs/msg/Float64"
            writer.write(
                other, at, bytes(store.serialize_ros1(value, name) if ros1 else store.serialize_cdr(value, name))
            )
    return path


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_recordings_sample_by_sample_and_by_the_column(tmp_path, suffix):
    sent = arrays(20)
    with open_source(recording(tmp_path / f"raw{suffix}", sent)) as source:
        heard = [(sample.signal, sample.value) for sample in source.samples([*SIGNALS, "/t.data"])]
        (blocks,) = [source.columns([*SIGNALS, "/t.data"], 0)]
        columns = {signal: [] for signal in (*SIGNALS, "/t.data")}
        for block in blocks:
            for signal, some in block.items():
                columns[signal] += some.values.tolist()
    for place, signal in enumerate(SIGNALS):
        wanted = [expected(x)[place] for x in sent]
        assert [value for name, value in heard if name == signal] == pytest.approx(wanted, rel=1e-6)
        assert columns[signal] == pytest.approx(wanted, rel=1e-6)
    assert columns["/t.data"] == [float(k) for k in range(20)]


def test_a_table_whose_columns_are_elements(tmp_path):
    sent = arrays(3)
    head = ",".join(f"/raw.data[{i}]" for i in range(512))
    rows = [f"{START + k},{k},{','.join(repr(float(v)) for v in x)}" for k, x in enumerate(sent)]
    (tmp_path / "raw.csv").write_text("\n".join([f"time,/t.data,{head}", *rows]) + "\n")
    source = CsvRecording(tmp_path / "raw.csv")
    assert "data[]" in next(info for info in source.topics() if info.topic == "/raw").fields
    heard = list(source.samples([*SIGNALS, "/t.data"]))
    for place, signal in enumerate(SIGNALS):
        found = [one.value for one in heard if one.signal == signal]
        assert found == pytest.approx([expected(x)[place] for x in sent], rel=1e-9)
    assert [one.value for one in heard if one.signal == "/t.data"] == [0.0, 1.0, 2.0]


def test_wear_of_raw_vibration(tmp_path):
    """The rms of each message, and of each stretch of ten the mean, as plain loops give it."""
    sent = arrays(120)
    robot = parse("{schema_version: 1, name: x, components: {fan: {rate: 1 FPMH,"
                  " wear: {topic: /raw, field: 'data[:rms]', every: 10 s, threshold: 3}}}}")  # fmt: skip
    history = wear_history(robot, recording(tmp_path / "raw.mcap", sent), worn_modes(robot))
    by_stretch = {}
    for k, x in enumerate(sent):
        by_stretch.setdefault((START + k) // 10, []).append(float(np.std(x.astype(float))))
    wanted = [np.mean(some) for some in by_stretch.values()]
    assert history.readings["fan"].values == pytest.approx(wanted, rel=1e-6)


def test_what_is_no_array_is_refused(tmp_path):
    robot = parse("{schema_version: 1, name: x, components: {fan: {rate: 1 FPMH,"
                  " wear: {topic: /t, field: 'data[:rms]', threshold: 3}}}}")  # fmt: skip
    with pytest.raises(SourceError, match="no number 'data\\[:rms\\]'"):
        wear_history(robot, recording(tmp_path / "raw.mcap", arrays(2)), worn_modes(robot))
