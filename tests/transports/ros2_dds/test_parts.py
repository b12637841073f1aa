"""Settings, names and types, without anybody on the other side."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from robophm.core.errors import SourceError
from robophm.transports.live.enforced_security import refuse_enforced_security
from robophm.transports.ros2_dds import Ros2Dds
from robophm.transports.ros2_dds.cyclone import Offer
from robophm.transports.ros2_dds.definition import dds_name, defined, known, name_of_dds, ros2_name
from robophm.transports.ros2_dds.environment import Place, hidden_by, place, place_in_words
from robophm.transports.ros2_dds.subscription import told_hash

HASHES = {
    # as rosidl of Jazzy writes them into share/*/msg/*.json
    "builtin_interfaces/msg/Time": "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
    "rcl_interfaces/msg/ParameterValue": "RIHS01_115fc089a387e23c7ecd3525c9189c379109119d6ab82e8dfbde0fdf6a7f9b68",
    "rmw_dds_common/msg/ParticipantEntitiesInfo": (
        "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"
    ),
}


@pytest.fixture(autouse=True)
def _plain(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY",
                 "CYCLONEDDS_URI", "AMENT_PREFIX_PATH"):  # fmt: skip
        monkeypatch.delenv(name, raising=False)


def told(where: Place) -> dict[str, str | None]:
    """What Cyclone is told, by the name of the element, or its address."""
    root = ElementTree.fromstring(f"<all>{where.config.replace('>,<', '><')}</all>")
    return {each.tag: each.text or ",".join(peer.get("address", "") for peer in each) for each in root.iter()}


def test_without_settings_it_is_domain_0_as_far_as_the_network_goes() -> None:
    settings = told(place())
    assert place().domain == 0
    assert settings["ParticipantIndex"] == "auto"
    assert not {"AllowMulticast", "Interfaces", "Peers", "Tag"} & settings.keys()


def test_localhost_asks_this_machine_and_static_peers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost")
    settings = told(place(7))
    assert (settings["AllowMulticast"], settings["Peers"]) == ("false", "localhost")
    monkeypatch.setenv("ROS_STATIC_PEERS", "192.0.2.7; robot&arm.local;")
    assert told(place(7))["Peers"] == "localhost,192.0.2.7,robot&arm.local"
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    assert told(place(7))["Peers"] == "192.0.2.7,robot&arm.local"
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "1")
    assert told(place(7))["Peers"] == "localhost"


def test_off_and_ones_own_configuration(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    settings = told(place())
    assert (settings["AllowMulticast"], settings["ParticipantIndex"]) == ("false", "none")
    assert (settings["Tag"] or "").startswith("ros_discovery_off_")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT")
    monkeypatch.setenv("CYCLONEDDS_URI", "file:///etc/cyclone.xml")
    assert place().config.endswith(",file:///etc/cyclone.xml")
    assert "ParticipantIndex" not in place().config


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("ROS_DOMAIN_ID", "zero", "ROS_DOMAIN_ID is 'zero'; expected a number from 0 to 232"),
        ("ROS_DOMAIN_ID", "233", "233 is not a ROS domain; expected 0 to 232"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOTS", "did you mean 'LOCALHOST'"),
    ],
)
def test_settings_that_are_none(monkeypatch: pytest.MonkeyPatch, name: str, value: str, why: str) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(SourceError, match=why):
        place()


@pytest.mark.parametrize(
    ("machine", "remedy"),
    [
        ("x86_64", r"pip install robophm\[ros2\]"),
        ("aarch64", "there is none for Python 3.* on aarch64; with .* its own rclpy serves; or robophm.zenoh."),
    ],
)
def test_without_the_wheel_it_is_said_what_serves(monkeypatch: pytest.MonkeyPatch, machine: str, remedy: str) -> None:
    monkeypatch.setitem(sys.modules, "cyclonedds.builtin", None)
    monkeypatch.setattr("platform.machine", lambda: machine)
    with pytest.raises(SourceError, match=rf"ROS 2 over DDS needs the package cyclonedds \(.*\): {remedy}\Z"):
        Ros2Dds()


def test_names() -> None:
    assert ros2_name("std_msgs/Float64") == ros2_name("std_msgs/msg/Float64") == "std_msgs/msg/Float64"
    assert dds_name("nav2_msgs/action/Go_FeedbackMessage") == "nav2_msgs::action::dds_::Go_FeedbackMessage_"
    assert name_of_dds("std_msgs::msg::dds_::Float64_") == "std_msgs/msg/Float64"
    assert name_of_dds("Float64") is None
    for wrong in ("Float64", "a/b/c", "a/msg/B C", "/msg/B", "a/msg/B\n"):
        with pytest.raises(SourceError, match="is not a type"):
            ros2_name(wrong)


@pytest.mark.parametrize("name", HASHES)
def test_hashes_are_those_of_rosidl(name: str) -> None:
    assert known("/x", name, newest=True).hash == HASHES[name]
    assert known("/x", name, HASHES[name]).type.name == name


def test_the_definition_that_has_the_hash_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Range has a field more since Jazzy; an installation's own goes before, where it is the publisher's."""
    name = "sensor_msgs/msg/Range"
    humble, newest = known("/x", name), known("/x", name, newest=True)
    assert [field for field, _ in newest.type.definitions[name][1]][-1] == "variance"
    assert [field for field, _ in humble.type.definitions[name][1]][-1] == "range"
    assert known("/x", name, humble.hash).hash == humble.hash != newest.hash == known("/x", name, newest.hash).hash
    folder = tmp_path / "share" / "sensor_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Range.msg").write_text("std_msgs/Header header\nfloat64 own\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert known("/x", name).origin == str(tmp_path)
    assert known("/x", name, newest.hash).hash == newest.hash
    (folder / "Range.msg").write_text("this is = no definition]\n")
    assert known("/x", name).hash == humble.hash
    with pytest.raises(SourceError, match=rf"of hash RIHS01_x is known; .*another hash; {tmp_path}: a damaged"):
        known("/x", name, "RIHS01_x")


@pytest.mark.parametrize("text", ["float64 x\nOther y\n", "x" * 100, "float64[999999] x\nOwn[9] y\n"])
def test_a_definition_that_is_none(text: str) -> None:
    with pytest.raises(SourceError, match="'/x': the definition of its type 'p/msg/Own' is missing or damaged"):
        defined("/x", "p/Own", text)


@pytest.mark.parametrize(
    ("user_data", "hash_"),
    [
        (b"typehash=RIHS01_ab;", "RIHS01_ab"),
        (b"enclave=/;typehash=RIHS01_ab;other=1", "RIHS01_ab"),
        (b"typehash=INVALID;", ""),
        (b"", ""),
        (b"\xff\xfe;typehash", ""),
    ],
)
def test_the_hash_that_a_publisher_tells(user_data: bytes, hash_: str) -> None:
    assert told_hash(Offer(1, "rt/x", "t", reliable=True, latched=False, user_data=user_data)) == hash_


def test_what_could_hide_topics(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in [("ROS_DOMAIN_ID", "7"), ("ROS_LOCALHOST_ONLY", "1"), ("RMW_IMPLEMENTATION", "rmw_zenoh_cpp"),
                        ("ROS_DISCOVERY_SERVER", "127.0.0.1:11811"), ("ROS_SECURITY_ENABLE", "true")]:  # fmt: skip
        monkeypatch.setenv(name, value)
    assert place_in_words() == "domain 7, this machine"
    hints = hidden_by(over_dds=True)
    for word in ("domains than 7", "this machine alone", "rmw_zenoh_cpp", "server of Fast DDS", "without their keys"):
        assert sum(word in hint for hint in hints) == 1, word
    assert not any("zenoh" in hint or "keys" in hint for hint in hidden_by(over_dds=False))  # as rclpy does it


def test_security_that_is_enforced_is_not_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", "Enforce")
    refuse_enforced_security()  # by sros2 it counts only where security is enabled
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    with pytest.raises(SourceError, match="ROS_SECURITY_STRATEGY is Enforce, and DDS is spoken here without security"):
        Ros2Dds()
