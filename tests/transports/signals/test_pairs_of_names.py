"""Values that a status or a joint names, by a pair: ``motor 3/temperature``, ``elbow/effort``; from real recordings."""

import json

import numpy as np
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, WantedSignal, bracketed, signal_name, split_signal
from robophm.design.file import load
from robophm.monitoring.replay import replay
from robophm.transports.recordings.recording import Recording

from .test_element_names import DYNAMIC, T0, two_ways

HOT = "/diagnostics.status[motor 3].values[temperature].value"


@pytest.mark.parametrize(
    ("topic", "field", "path"),
    [
        ("/diagnostics", "motor 3/temperature", "status[motor 3].values[temperature].value"),
        ("/diagnostics_agg", "/Arm/motor 3/temperature", "status[/Arm/motor 3].values[temperature].value"),
        ("/left/diagnostics", "a/7", "status[a].values['7'].value"),
        ("/diagnostics", "CPU [0]/Temp [°C]", "status['CPU [0]'].values['Temp [°C]'].value"),
        ("/dynamic_joint_states", "elbow/effort", "interface_values[elbow].values[effort]"),
        ("/diagnostics", "status[a/b].values[c/d].value", "status[a/b].values[c/d].value"),
    ],
)
def test_a_pair_of_names_is_a_path(topic, field, path):
    assert signal_name(topic, field) == f"{topic}.{path}"
    assert split_signal(f"{topic}.{field}") == (topic, path)


@pytest.mark.parametrize(("topic", "field"), [("/odom", "pose/x"), ("/diagnostics", "motor 3"), ("/diagnostics", "a/"),
                                              ("/diagnostics", "/b"), ("/diagnostics", "a/b\n")])  # fmt: skip
def test_elsewhere_a_pair_is_no_path(topic, field):
    with pytest.raises(SourceError, match="is not a field path"):
        signal_name(topic, field)


def test_names_are_quoted_where_they_would_be_read_otherwise():
    names = ["a b", "7", "x[1]", "it's [1]", ":rms"]
    assert [bracketed(name) for name in names] == ["a b", "'7'", "'x[1]'", '"it\'s [1]"', "':rms'"]


def store_of(ros):
    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    definition = DYNAMIC if ros == 2 else DYNAMIC.replace(
        "builtin_interfaces/Time stamp", "uint32 seq\ntime stamp"
    ).partition("=" * 80 + "\nMSG: builtin_interfaces")[0]  # fmt: skip
    store.register({key: value for key, value in get_types_from_msg(definition, "control_msgs/msg/DynamicJointState")
                    .items() if key.startswith("control_msgs")})  # fmt: skip
    return store


def written(path, ros, messages):
    """A recording by rosbags: .bag of ROS 1, else .db3 or .mcap of ROS 2."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2

    store, connections = store_of(ros), {}
    plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
    writer = Writer1(path) if ros == 1 else Writer2(path.with_suffix(""), version=9, storage_plugin=plugin)
    with writer:
        for topic, time, make in messages:
            message, type_ = make(store.types, ros, time)
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, type_, typestore=store)
            raw = store.serialize_ros1(message, type_) if ros == 1 else store.serialize_cdr(message, type_)
            writer.write(connections[topic], time, raw)
    return path if ros == 1 else path.with_suffix("")


def header(types, ros, time):
    at = types["builtin_interfaces/msg/Time"](time // SECOND, time % SECOND)
    return types["std_msgs/msg/Header"](**({"seq": 0} if ros == 1 else {}), stamp=at, frame_id="")


def status(name, values):
    def make(types, ros, time):
        pairs = [types["diagnostic_msgs/msg/KeyValue"](key=key, value=value) for key, value in values.items()]
        one = types["diagnostic_msgs/msg/DiagnosticStatus"](
            level=0, name=name, message="", hardware_id="", values=pairs
        )
        array = types["diagnostic_msgs/msg/DiagnosticArray"]
        return array(header(types, ros, time), [one]), "diagnostic_msgs/msg/DiagnosticArray"

    return make


def states(names, efforts):
    def make(types, ros, time):
        value = types["control_msgs/msg/InterfaceValue"]
        inside = [value(interface_names=["position", "effort"], values=np.array([0.1, one])) for one in efforts]
        state = types["control_msgs/msg/DynamicJointState"]
        return state(header(types, ros, time), list(names), inside), "control_msgs/msg/DynamicJointState"

    return make


def drive():
    """Ten minutes: three nodes that tell of themselves on one topic, and joints in two orders."""
    for i in range(300):
        at = T0 + 2 * i * SECOND
        said = "warming up" if i < 5 else f"{70.0}"
        yield "/diagnostics", at, status("motor 3", {"temperature": said, "state": "ok"})
        yield "/diagnostics", at + 1, status("battery", {"charge": "0.5"})
        if i > 10:
            yield "/diagnostics", at + 2, status("arm: elbow [left]", {"winding [°C]": "41"})
        names, efforts = (("elbow", "wrist"), (30.0, 2.0))
        if i % 2:
            names, efforts = names[::-1], efforts[::-1]
        yield "/dynamic_joint_states", at + 3, states(names, efforts)


URDF = """<robot name="a"><link name="b"/><link name="c"/><joint name="elbow" type="revolute">
<parent link="b"/><child link="c"/><limit effort="60" velocity="1" lower="0" upper="1"/></joint></robot>"""
DESIGN = """schema_version: 1
name: Arm
components:
  motor 3:
    rate: 1e-5 /h
    acceleration: {model: q10, q: 2, reference_temperature: 40 degC}
    signals: {temperature: {topic: /diagnostics, field: motor 3/temperature, unit: degC, range: [-40, 150]}}
  elbow gear:
    rate: 1e-5 /h
    acceleration: {model: cubic_load}
    signals: {load: {topic: /dynamic_joint_states, field: elbow/effort, unit: N*m, rated: 15, range: [-100, 100]}}
"""


@pytest.mark.parametrize(("name", "ros"), [("drive.bag", 1), ("drive.db3", 2), ("drive.mcap", 2)])
def test_recordings_are_read_listed_and_counted(tmp_path, name, ros):
    path = written(tmp_path / name, ros, drive())
    signals = [HOT, "/dynamic_joint_states.interface_values[elbow].values[effort]",
               "/diagnostics.status['arm: elbow [left]'].values['winding [°C]'].value"]  # fmt: skip
    values, _ = two_ways(path, signals)
    assert values[HOT][5:] == [70.0] * 295
    assert np.isnan(values[HOT][:5]).all()
    assert values[signals[1]] == [30.0] * 300
    assert values[signals[2]] == [41.0] * 289
    with Recording(path) as recording:
        assert recording.names() == {
            "/diagnostics": {
                "status[]": ["motor 3", "battery", "arm: elbow [left]"],
                "status[motor 3].values[]": ["temperature", "state"], "status[battery].values[]": ["charge"],
                "status['arm: elbow [left]'].values[]": ["winding [°C]"],
            },
            "/dynamic_joint_states": {
                "interface_values[]": ["elbow", "wrist"], "interface_values[elbow].values[]": ["position", "effort"],
                "interface_values[wrist].values[]": ["position", "effort"],
            },
        }  # fmt: skip
    (tmp_path / "robot.yaml").write_text(DESIGN)
    health = replay(load(tmp_path / "robot.yaml"), path)
    rates = {one.path: one.sensor_based_hazard_rate for one in health.components}
    assert rates == {"motor 3": pytest.approx(1e-5 * 2**3), "elbow gear": pytest.approx(1e-5 * 2**3)}
    assert (
        f"5 samples not taken: no finite number: {HOT}; expected a number, alone or with a unit that fits"
        in health.notes
    )


@pytest.mark.parametrize(("name", "ros"), [("drive.bag", 1), ("drive.db3", 2), ("drive.mcap", 2)])
def test_texts_with_a_unit_are_in_the_unit_that_is_wanted(tmp_path, name, ros):
    """As the columns and message by message have them: 296.65 K are 23.5 °C."""
    said = ["23.5 C", "296.65 K", "23.5", "48 V"]
    path = written(
        tmp_path / name,
        ros,
        [("/diagnostics", T0 + i * SECOND, status("motor 3", {"temperature": one})) for i, one in enumerate(said)],
    )
    for unit, expected in (("degC", [23.5, 23.5, 23.5]), ("K", [296.65, 296.65, 23.5])):
        values = two_ways(path, [WantedSignal(HOT, unit)])[0][HOT]
        assert values[:3] == pytest.approx(expected, rel=1e-12)
        assert np.isnan(values[3])


def test_commands_take_a_pair_and_bind_proposes_what_is_named(tmp_path):
    path = written(tmp_path / "drive.mcap", 2, drive())
    said = CliRunner().invoke(
        app, ["data", "statistics", str(path), "--signal", "/diagnostics.motor 3/temperature", "--json"]
    )
    assert said.exit_code == 0, said.output
    assert '"highest": 70.0' in said.stdout
    design = tmp_path / "robot.yaml"
    design.write_text("schema_version: 1\nname: Arm\nusage: {cycles: 5 cycle/h}\ncomponents:\n"
                      "  motor 3: {part: servo_motor}\n  elbow gear: {part: strain_wave_gear}\n"
                      "  elbow cable: {part: torsion_cable}\n")  # fmt: skip
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(URDF)
    found = CliRunner().invoke(app, ["bind", str(design), str(path), "--urdf", str(urdf), "--yes", "--json"])
    bound = {(one["part"], one["input"]): one["binding"] for one in json.loads(found.stdout)["proposals"]}
    assert bound["motor 3", "temperature"]["field"] == "status[motor 3].values[temperature].value"
    assert bound["elbow gear", "load"]["field"] == "interface_values[elbow].values[effort]"
    assert bound["elbow gear", "load"]["rated"] == 30
    assert load(design).signals.keys() == {HOT, "/dynamic_joint_states.interface_values[elbow].values[effort]"}
