"""Elements of arrays by their names: the same by the step, by the column and live, whoever publishes in which order."""

import json
import math
import random
from collections import Counter

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import SourceError
from robophm.core.signal import REORDERED, SECOND, Sample, Step, named, signal_name, split_signal, steps_of
from robophm.design.file import parse
from robophm.monitoring.replay import replay
from robophm.transports.live.decoding import LARGE, TopicDecoder
from robophm.transports.live.receiving import Receiver
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.columns.topic_columns import by_signal
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.incidents import Incidents
from robophm.transports.signals.message_type import field_getter, message_type, serialized

T0 = 1_700_000_000 * SECOND
ARM = ("pan", "lift", "elbow")
GRIPPER = ("finger",)
TRUTH = {"pan": 1.0, "lift": 20.0, "elbow": 300.0, "finger": 0.5}
JOINTS, DIAGNOSTICS, TRANSFORMS = (
    "sensor_msgs/msg/JointState",
    "diagnostic_msgs/msg/DiagnosticArray",
    "tf2_msgs/msg/TFMessage",
)


def header(types, time, frame=""):
    return types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](time // SECOND, time % SECOND), frame)


def joints(time, names, efforts=None):
    said = [TRUTH[name] for name in names] if efforts is None else efforts

    def make(types):
        empty = np.empty(0)
        return types[JOINTS](header(types, time), list(names), empty, empty, np.array(said))

    return ("/joint_states", JOINTS, time, make)


def diagnostics(time, values):
    def make(types):
        pairs = [types["diagnostic_msgs/msg/KeyValue"](key=key, value=value) for key, value in values]
        status = types["diagnostic_msgs/msg/DiagnosticStatus"](
            level=0, name="arm: motor 1", message="", hardware_id="", values=pairs
        )
        return types[DIAGNOSTICS](header(types, time), [status])

    return ("/diagnostics", DIAGNOSTICS, time, make)


def transforms(time, frames):
    def make(types):
        some = [
            types["geometry_msgs/msg/TransformStamped"](
                header(types, time, "base"),
                frame,
                types["geometry_msgs/msg/Transform"](
                    types["geometry_msgs/msg/Vector3"](x, 0.0, 0.0),
                    types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
                ),
            )
            for frame, x in frames
        ]
        return types[TRANSFORMS](some)

    return ("/tf", TRANSFORMS, time, make)


def two_ways(path, signals):
    """What a recording gives by the step and by the column, with their notes: they are the same."""
    with Recording(path) as recording:
        stepwise = list(recording.samples(signals))
        notes = Counter(recording.notes)
    columns = read_columns(path, signals)
    found = {signal: [] for signal in signals}
    for block in columns:
        for signal, heard in by_signal(block).items():
            found[signal] += zip(heard.times.tolist(), heard.values.tolist(), strict=True)
    each = {signal: [(time, value) for time, name, value in stepwise if name == signal] for signal in signals}
    assert {k: [(t, repr(v)) for t, v in one] for k, one in each.items()} == {
        k: [(t, repr(v)) for t, v in one] for k, one in found.items()
    }
    by_column = Counter({what: n for what, n in columns.notes.items() if not what.endswith("message by message")})
    assert by_column == notes
    return {signal: [value for _, value in one] for signal, one in each.items()}, notes


def test_field_paths():
    assert steps_of("a.values[CPU Temp. 0].b[2].c['7']") == [
        Step("a", None),
        Step("values", "CPU Temp. 0"),
        Step("b", 2),
        Step("c", "7"),
    ]
    name = signal_name("/joint_states", "effort[shoulder_lift]")
    assert split_signal(name) == ("/joint_states", "effort[shoulder_lift]")
    assert [named(field) for field in ("effort[a]", "effort[1]", "effort")] == [True, False, False]
    for wrong in ("effort[]", "effort[a", "effort[a]]", "effort[a[b]]", "effort.[a]", "effort[a]b"):
        with pytest.raises(SourceError, match="not a field path"):
            signal_name("/t", wrong)


def test_a_joint_keeps_its_effort_when_the_order_changes(tmp_path, write_messages):
    orders = [ARM] * 5 + [ARM[::-1]] * 3 + [("lift", "pan", "elbow")] * 2
    path = write_messages(tmp_path / "drive.mcap", [joints(T0 + i * SECOND, order) for i, order in enumerate(orders)])
    values, notes = two_ways(path, [f"/joint_states.effort[{joint}]" for joint in ARM])
    for joint in ARM:
        assert values[f"/joint_states.effort[{joint}]"] == [TRUTH[joint]] * 10
    assert not notes
    values, notes = two_ways(path, ["/joint_states.effort[0]", "/joint_states.effort[1]"])
    assert values["/joint_states.effort[0]"] == [TRUTH[order[0]] for order in orders]
    assert notes == {f"{REORDERED}/joint_states.effort[0]": 5, f"{REORDERED}/joint_states.effort[1]": 2}


def test_two_publishers_on_one_topic(tmp_path, write_messages):
    orders = [ARM if i % 2 else GRIPPER for i in range(20)]
    path = write_messages(tmp_path / "drive.mcap", [joints(T0 + i * SECOND, order) for i, order in enumerate(orders)])
    values, notes = two_ways(path, ["/joint_states.effort[finger]", "/joint_states.effort[lift]"])
    assert values == {"/joint_states.effort[finger]": [0.5] * 10, "/joint_states.effort[lift]": [20.0] * 10}
    assert not notes
    _, notes = two_ways(path, ["/joint_states.effort[0]", "/joint_states.effort[1]"])
    assert notes[f"{REORDERED}/joint_states.effort[0]"] == 10
    assert notes["no element for /joint_states.effort[1]"] == 10


def test_a_name_that_is_never_heard_is_said_with_the_nearest(tmp_path, write_messages):
    path = write_messages(tmp_path / "drive.mcap", [joints(T0 + i * SECOND, ARM) for i in range(4)])
    values, notes = two_ways(path, ["/joint_states.effort[elbw]", "/joint_states.effort[pan]"])
    assert values == {"/joint_states.effort[elbw]": [], "/joint_states.effort[pan]": [1.0] * 4}
    assert len(notes) == 1
    ((said, count),) = notes.items()
    assert said.startswith("never named: /joint_states.effort[elbw]")
    assert (count, "elbow" in said) == (4, True)


def test_as_many_names_as_values_or_none(tmp_path, write_messages):
    """A message that names seven joints and has three efforts does not say whose they are."""
    said = [
        joints(T0, ARM),
        joints(T0 + SECOND, ARM, [1.0, 2.0]),
        joints(T0 + 2 * SECOND, ARM, []),
        joints(T0 + 3 * SECOND, (), [7.0]),
    ]
    path = write_messages(tmp_path / "drive.mcap", said)
    values, notes = two_ways(path, ["/joint_states.effort[pan]", "/joint_states.effort[0]"])
    assert values == {"/joint_states.effort[pan]": [1.0], "/joint_states.effort[0]": [1.0, 1.0, 7.0]}
    assert notes == {"no element for /joint_states.effort[0]": 1}


def test_diagnostics_by_key(tmp_path, write_messages):
    """Values of diagnostics are texts; one that is no number is none."""
    said = [
        diagnostics(T0 + i * SECOND, pairs)
        for i, pairs in enumerate([
            [("Temp (C)", "41.5"), ("State", "ok")], [("State", "ok"), ("Temp (C)", " 4.2e1 ")], [("Temp (C)", "hot")],
            [("State", "")], [("Temp (C)", "1_0")], [("Temp (C)", "nan")],
        ])
    ]  # fmt: skip
    path = write_messages(tmp_path / "drive.mcap", said)
    signal = "/diagnostics.status[arm: motor 1].values[Temp (C)].value"
    values, notes = two_ways(path, [signal])
    assert values[signal][:2] == [41.5, 42.0]
    assert [math.isnan(one) for one in values[signal][2:]] == [True] * 3
    assert not notes


def test_transforms_by_their_child_frame(tmp_path, write_messages):
    said = [
        transforms(T0 + i * SECOND, [("wheel", 1.0), ("arm", 2.0)] if i % 2 else [("arm", 2.0), ("hand", 3.0)])
        for i in range(6)
    ]
    path = write_messages(tmp_path / "drive.mcap", said)
    names = [f"/tf.transforms[{frame}].transform.translation.x" for frame in ("arm", "wheel")]
    values, notes = two_ways(path, names)
    assert values == {names[0]: [2.0] * 6, names[1]: [1.0] * 3}
    unstamped = {"receipt time used for /tf": 6}  # the header is in the transforms
    assert notes == unstamped
    _, notes = two_ways(path, ["/tf.transforms[0].transform.translation.x"])
    assert notes == unstamped | {f"{REORDERED}/tf.transforms[0].transform.translation.x": 3}


DYNAMIC = """std_msgs/Header header
string[] joint_names
control_msgs/InterfaceValue[] interface_values
================================================================================
MSG: control_msgs/InterfaceValue
string[] interface_names
float64[] values
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""


def type_of(name, definition, encoding="cdr"):
    from rosbags.interfaces import (
        Connection,
        ConnectionExtRosbag1,
        ConnectionExtRosbag2,
        MessageDefinition,
        MessageDefinitionFormat,
    )

    ext = ConnectionExtRosbag2(encoding, []) if encoding == "cdr" else ConnectionExtRosbag1(None, None)
    return message_type(
        Connection(1, "/t", name, MessageDefinition(MessageDefinitionFormat.MSG, definition), "", 0, ext, None)
    )


def test_names_in_a_message_around_the_array_and_in_its_elements():
    type_ = type_of("control_msgs/msg/DynamicJointState", DYNAMIC)
    types = type_.types
    value = types["control_msgs/msg/InterfaceValue"]
    message = types[type_.name](
        header(types, T0), ["pan", "lift"],
        [value(["position", "effort"], np.array([0.1, 5.0])), value(["effort", "position"], np.array([7.0, 0.3]))],
    )  # fmt: skip
    back = type_.decode(serialized(type_, message))
    for joint, interface, expected in (("pan", "effort", 5.0), ("lift", "effort", 7.0), ("lift", "position", 0.3)):
        assert (
            field_getter(type_.definitions, type_.name, f"interface_values[{joint}].values[{interface}]")(back)
            == expected
        )
        assert field_getter(type_.definitions, type_.name, f"interface_values[1].values[{interface}]")(back) in (
            7.0,
            0.3,
        )


def test_what_nothing_names_is_refused_with_what_there_is():
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    with pytest.raises(SourceError, match=r"names no element of 'ranges'; expected an index, e\.g\. 'ranges\[0\]'"):
        field_getter(store.fielddefs, "sensor_msgs/msg/LaserScan", "ranges[front]")
    with pytest.raises(SourceError, match=r"expected e\.g\. 'effort\[0\]', or by a name of 'name'"):
        field_getter(store.fielddefs, JOINTS, "effort")
    with pytest.raises(SourceError, match="has no number in 'status"):
        field_getter(store.fielddefs, DIAGNOSTICS, "status[0].values[0].value")


@pytest.mark.parametrize("ordered", [True, False])
def test_many_messages_in_any_order(tmp_path, write_messages, ordered):
    """The columns find the same labels at once; every other order, damage too, ends as the decoder has it."""
    chance = random.Random(5)
    names = [f"joint_{i}" * (1 + i % 3) for i in range(7)]
    messages = []
    for i in range(400):
        if not ordered or chance.random() < 0.02:
            chance.shuffle(names)
        some = names[: chance.choice((7, 7, 7, 5))]
        messages.append(
            joints(T0 + i * 10_000_000, list(some), [float(len(name)) + names.index(name) for name in some])
        )
    path = write_messages(tmp_path / "drive.mcap", messages)
    two_ways(
        path, [f"/joint_states.effort[joint_{i}]" for i in (0, 3)] + [f"/joint_states.effort[{i}]" for i in (0, 6)]
    )


def live(reading, raws):
    """What a live source would give for these messages, and its notes."""
    notes, heard = Incidents(), []
    hearing = Receiver(notes, heard.extend, (), simulated=False)
    hearing.messages(reading, raws, None)
    return [(one.signal, one.value) for one in heard if isinstance(one, Sample)], notes.copy()


@pytest.mark.parametrize("padding", [0, LARGE])
def test_live(padding):
    """As in a recording; a message too large to be decoded is walked."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    type_ = type_of(JOINTS, store.generate_msgdef(JOINTS, 2)[0])
    raws = []
    for order in (ARM, ARM[::-1], GRIPPER, ARM):
        *_, make = joints(T0, order)
        message = make(type_.types)
        message.header.frame_id = "x" * padding
        raws.append(serialized(type_, message))
    signals = ["/joint_states.effort[lift]", "/joint_states.effort[nobody]", "/joint_states.effort[0]"]
    heard, notes = live(TopicDecoder("/joint_states", type_, signals, ""), raws)
    assert [value for signal, value in heard if signal == signals[0]] == [20.0] * 3
    assert [value for signal, value in heard if signal == signals[2]] == [1.0, 300.0, 0.5, 1.0]
    assert notes[f"{REORDERED}{signals[2]}"] == 2
    assert [count for what, count in notes.items() if what.startswith(f"never named: {signals[1]}")] == [4]
    assert not any(signals[0] in what for what in notes)


def test_a_table_by_names(tmp_path):
    path = tmp_path / "drive.csv"
    path.write_text('time,/joint_states.effort[lift],"/d.values[Temp, hot].value"\n1,2,3\n2,4,5\n')
    signals = ["/joint_states.effort[lift]", "/d.values[Temp, hot].value"]
    with CsvRecording(path) as recording:
        assert [(one.signal, one.value) for one in recording.samples(signals)][:2] == [
            (signals[1], 3.0),
            (signals[0], 2.0),
        ]


def test_a_report_says_that_an_index_meant_several_joints(tmp_path, write_messages):
    design = """schema_version: 1
name: Arm
components:
  Lift: {rate: 100 FIT, acceleration: {model: cubic_load}, signals: {load: {topic: /joint_states, field: "effort[%s]",
    unit: N*m, rated: 10, range: [-500, 500]}}}
  Box: {rate: 100 FIT}
"""
    orders = [ARM if i % 4 else ARM[::-1] for i in range(1, 41)]
    path = write_messages(tmp_path / "drive.mcap", [joints(T0 + i * SECOND, order) for i, order in enumerate(orders)])
    by_name = replay(parse(design % "lift"), path)
    assert by_name.components[0].sensor_based_hazard_rate == pytest.approx(8 * 100e-9)  # 20 N·m of 10: cubed
    assert not any(REORDERED in flag for one in by_name.components for flag in one.flags)
    by_index = replay(parse(design % "0"), path)
    lift, box = by_index.components
    assert lift.flags == (f"{REORDERED}/joint_states.effort[0]",)
    assert box.flags == ()
    assert lift.flags[0] in by_index.subjects[0].flags
    assert (
        f"{REORDERED}/joint_states.effort[0] in 10 messages; expected it bound by the element's name" in by_index.notes
    )


def test_data_lists_the_names(tmp_path, write_messages):
    said = [joints(T0, ARM), diagnostics(T0 + 1, [("Temp (C)", "41.5")]), transforms(T0 + 2, [("arm", 2.0)])]
    path = write_messages(tmp_path / "drive.mcap", said)
    with Recording(path) as recording:
        assert recording.names() == {
            "/joint_states": {"effort[]": [*ARM]},  # its positions are none
            "/diagnostics": {"status[]": ["arm: motor 1"], "status[arm: motor 1].values[]": ["Temp (C)"]},
            "/tf": {"transforms[]": ["arm"]},
        }
    shown = CliRunner().invoke(app, ["data", "list", str(path), "--json"])
    topics = {one["name"]: one["names"] for one in json.loads(shown.stdout)["recordings"][0]["topics"]}
    assert topics["/joint_states"] == {"effort[]": [*ARM]}
    words = " ".join(CliRunner().invoke(app, ["data", "list", str(path)]).stdout.split())
    assert "pan" in words
    found = CliRunner().invoke(
        app, ["data", "find", str(path), "--signal", "/joint_states.effort[elbow]", "--above", "200", "--json"]
    )
    assert found.exit_code == 0, found.output


def test_a_text_with_a_unit_of_something_else_is_refused_in_words(tmp_path, write_messages):
    """8.0 V is finite, and no torque; 8.0 N m is the rated load of 10 at 0.8, by its cube 0.512 of 100 FIT."""
    signal = "/diagnostics.status[arm: motor 1].values[Effort].value"
    design = f"""schema_version: 1
name: Arm
components:
  Lift: {{rate: 100 FIT, acceleration: {{model: cubic_load}}, signals: {{load: {{topic: /diagnostics,
    field: "{signal.partition(".")[2]}", unit: N*m, rated: 10, range: [-500, 500]}}}}}}
"""
    said = [diagnostics(T0 + i * SECOND, [("Effort", "8.0 V" if i < 3 else "8.0 N m")]) for i in range(5)]
    path = write_messages(tmp_path / "drive.mcap", said)
    words = f"no finite number: {signal}; expected a number, alone or with a unit that fits"
    health = replay(parse(design), path)
    assert f"3 samples not taken: {words}" in health.notes
    assert health.system.sensor_based.hazard_rate == pytest.approx(51.2e-9)


def test_names_are_looked_for_at_several_places_and_more_may_be(tmp_path, write_messages):
    """A node that speaks from three quarters on is listed, and that others may be missing is said where they may."""
    said = [diagnostics(T0 + step * SECOND, [("late" if step >= 150 else "early", "1.5")]) for step in range(200)]
    path = write_messages(tmp_path / "drive.mcap", said)
    with Recording(path) as recording:
        names = recording.names()["/diagnostics"]["status[arm: motor 1].values[]"]
    assert names == ["early", "late"]
    words = " ".join(CliRunner().invoke(app, ["data", "list", str(path)]).stdout.split())
    assert "maybe others too" in words
    few = write_messages(tmp_path / "few.mcap", said[:70])
    assert "maybe others too" not in " ".join(CliRunner().invoke(app, ["data", "list", str(few)]).stdout.split())


def test_of_a_message_the_field_that_is_meant_is_told(tmp_path, write_messages):
    path = write_messages(tmp_path / "drive.mcap", [diagnostics(T0, [("Effort", "8.0")])])
    signal = "/diagnostics.status[arm: motor 1].values[Effort]"
    with Recording(path) as recording:
        with pytest.raises(SourceError, match=r"it is a message: expected e\.g\. .*values\[Effort\]\.value'$"):
            list(recording.samples([signal]))
        assert [one.value for one in recording.samples([f"{signal}.value"])] == [8.0]


def test_arrays_are_listed_with_their_length_at_first(tmp_path):
    """Of a scan, and of no image, whose bytes are not read for it."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](T0 // SECOND, 0), "base")
    with Writer(tmp_path / "drive", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, type_, parts in (
            (
                "/scan",
                "LaserScan",
                [(0.0,) * 7 + (np.zeros(360 + k, np.float32), np.zeros(0, np.float32)) for k in (0, 1)],
            ),
            ("/image", "Image", [(1, 1, "rgb8", 0, 3, np.zeros(3, np.uint8))]),
        ):
            name = f"sensor_msgs/msg/{type_}"
            connection = writer.add_connection(topic, name, typestore=store)
            for step, part in enumerate(parts):
                writer.write(connection, T0 + step, store.serialize_cdr(types[name](header, *part), name))
    with Recording(tmp_path / "drive") as recording:
        assert recording.lengths() == {"/scan": {"ranges[]": 360, "intensities[]": 0}}
    words = " ".join(CliRunner().invoke(app, ["data", "list", str(tmp_path / "drive")]).stdout.split())
    assert "ranges[] (360) [m], intensities[] (0)" in words
    assert "data[]" in words
    assert "data[] (" not in words
    assert "(…): elements in the first message" in words
