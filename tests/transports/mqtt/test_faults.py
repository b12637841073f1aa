"""Brokers that are lost, closed to us or of an older version, and messages that are none."""

from __future__ import annotations

import json
import resource
import socket
import subprocess
import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.mqtt import Mqtt, address
from robophm.transports.mqtt import source as mqtt_source

from ..listener import Heard, within
from .conftest import LOOPBACK, Broker, Robot

SECRET = "s3cret pass"


@pytest.fixture
def guarded(mosquitto: None, tmp_path: Path) -> Iterator[Broker]:
    """Lets in the user amr alone."""
    file = tmp_path / "passwords"
    subprocess.run(["mosquitto_passwd", "-b", "-c", str(file), "amr", SECRET], check=True, timeout=50)
    broker = Broker(tmp_path, "allow_anonymous false", f"password_file {file}")
    yield broker
    broker.stop()


def test_a_broker_that_comes_back_is_heard_again(mosquitto: None, tmp_path: Path) -> None:
    broker = Broker(tmp_path)
    with Mqtt(broker.address()) as source:
        heard = Heard(source, "/t.value")
        before = Robot(broker)
        before.say("/t", 1)
        within(5, lambda: heard.of("/t.value") == [1.0])
        before.close()
        broker.stop()
        within(5, lambda: source.notes["connection lost on /t"] == 1)
        clocks = len(heard.of("clock"))
        within(5, lambda: len(heard.of("clock")) > clocks + 1)  # time goes on, and is no value
        assert broker.start()
        within(20, lambda: source.notes["connected again to the broker"] == 1)
        after = Robot(broker)
        after.say("/t", 2)
        within(5, lambda: heard.of("/t.value") == [1.0, 2.0])
        after.close()
    broker.stop()


def test_the_password_comes_from_a_file_and_is_in_no_error(
    guarded: Broker, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "secret").write_text(f"{SECRET}\n")
    place = f"mqtt://amr@{LOOPBACK}:{guarded.port}"
    with pytest.raises(SourceError, match=r"does not let us in: Not authorized; expected a user in its address"):
        Mqtt(guarded.address())
    monkeypatch.setenv("MQTT_PASSWORD", "wrong")
    with pytest.raises(SourceError, match="expected the password of amr in MQTT_PASSWORD_FILE") as refused:
        Mqtt(place)
    assert "wrong" not in str(refused.value)
    monkeypatch.delenv("MQTT_PASSWORD")
    monkeypatch.setenv("MQTT_PASSWORD_FILE", str(tmp_path / "secret"))
    Mqtt(place).close()
    monkeypatch.setenv("MQTT_PASSWORD_FILE", str(tmp_path / "absent"))
    with pytest.raises(SourceError, match=r"MQTT_PASSWORD_FILE is '.*absent': No such file"):
        Mqtt(place)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # paho leaves the refused socket open
def test_tls_and_a_certificate_that_nobody_vouches_for(
    mosquitto: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    words = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost",
             "-addext", f"subjectAltName=IP:{LOOPBACK}", "-keyout", str(key), "-out", str(certificate)]  # fmt: skip
    subprocess.run(words, check=True, capture_output=True, timeout=50)
    broker = Broker(tmp_path, "allow_anonymous true", f"keyfile {key}", f"certfile {certificate}")
    place = f"mqtts://{LOOPBACK}:{broker.port}"
    with pytest.raises(SourceError, match=r"no MQTT broker at mqtts://.*certificate verify failed"):
        Mqtt(place)
    monkeypatch.setenv("MQTT_CA_FILE", str(certificate))
    Mqtt(place).close()
    broker.stop()


HOSTILE = [
    b"", b"{", b"null", b"\xff\xfe", b"{" * 100_000, b"[" * 100_000, b'{"value": "12"}', b'{"value": 1e999}',
    b'{"value": ' + b"9" * 100_000 + b"}", b'{"value": {"value": 1}}', b'{"value": [1]}', b'{"other": 1}',
    b'{"value":' * 30_000 + b"1" + b"}" * 30_000, b'{"value": 1' + b" " * (1 << 20) + b"}",
    json.dumps({f"f{number}": number for number in range(50_000)}).encode(),
    b'{"e": [{"name": 5}, 7, {"name": "a", "value": "x"}]}', b'{"timestamp": 1e300, "headerId": "x", "value": true}',
    b'{"timestamp": "9999-12-31T23:59:59Z", "value": 2}', b'{"header": {"stamp": {"sec": "a"}}, "value": 3}',
]  # fmt: skip


def test_messages_that_are_none_cost_little_and_are_counted(broker: Broker) -> None:
    robot = Robot(broker)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with Mqtt(broker.address()) as source:
        heard = Heard(source, "/h.value", "/h.e[a].value", "/h.e[1].value", "/h.value[0]")
        for raw in HOSTILE:
            robot.say("/h", raw)
        robot.say("/h", {"value": 4.5})
        within(20, lambda: heard.of("/h.value")[-1:] == [4.5])
        assert heard.of("/h.value") == [float("inf"), 1.0, 2.0, 3.0, 4.5]
        assert heard.of("/h.value[0]") == [1.0]
        assert source.notes["unreadable message on /h"] == 8
        assert "internal error" not in source.notes
        assert max(len(info.fields) for info in source.topics()) <= 1000 + 10
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 256 * 1024
    robot.close()


def test_what_others_name_is_remembered_within_bounds(broker: Broker, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names of topics and fields, of any length and number, and how many messages are missing."""
    monkeypatch.setattr(mqtt_source, "MOST_FIELDS_OF_ALL", 150)
    robot = Robot(broker)
    with Mqtt(broker.address()) as source:
        heard = Heard(source, "/last.value", "/count.value")
        for number in range(3):
            robot.say(f"/many{number}", {f"field{at}": at for at in range(100)})
        robot.say("/" + "x" * 2000, {"value": 1})
        robot.say("/long", {"y" * 2000: 1, "value": 2})
        for number in (1, 10**400, 3):
            robot.say("/count", {"headerId": number, "value": number})
        robot.say("/last", {"value": 4.5})
        within(10, lambda: heard.of("/last.value") == [4.5])
        infos = {info.topic: info.fields for info in source.topics() if not info.topic.startswith("/t")}
        assert sum(map(len, infos.values())) == 150
        assert max(map(len, infos)) < 500
        assert max(len(field) for fields in infos.values() for field in fields) < 500
        assert source.notes["sequence gap on /count"] == 0
    robot.close()


def test_a_broker_that_speaks_3_1_1_alone(broker: Broker) -> None:
    """In front of the broker somebody who says to MQTT 5, as brokers of 3.1.1 do: unacceptable protocol version."""
    versions = []

    def pass_on(source: socket.socket, sink: socket.socket) -> None:
        with suppress(OSError):
            while some := source.recv(4096):
                sink.sendall(some)

    def serve() -> None:
        with suppress(OSError):
            while True:
                client, _ = server.accept()
                first = client.recv(4096)
                versions.append(first[first.index(b"MQTT") + 4])
                if versions[-1] > 4:
                    client.sendall(bytes([0x20, 2, 0, 1]))  # MQTT 3.1.1, 3.2.2.3
                    client.close()
                    continue
                behind = socket.create_connection((LOOPBACK, broker.port))
                behind.sendall(first)
                threading.Thread(target=pass_on, args=(behind, client), daemon=True).start()
                threading.Thread(target=pass_on, args=(client, behind), daemon=True).start()

    with socket.create_server((LOOPBACK, 0)) as server:
        threading.Thread(target=serve, daemon=True).start()
        robot = Robot(broker)
        with Mqtt(f"mqtt://{LOOPBACK}:{server.getsockname()[1]}") as source:
            heard = Heard(source, "/old.value")
            robot.say("/old", 7, retain=True)
            within(5, lambda: heard.of("/old.value") == [7.0])
        robot.say("/old", b"", retain=True)
        robot.close()
    assert versions == [5, 4]


def test_addresses() -> None:
    one = address("mqtts://amr@broker.example/uagv/v2/MAKER/00%201/")
    assert (one.host, one.port, one.encrypted, one.user, one.root) == (
        "broker.example", 8883, True, "amr", "uagv/v2/MAKER/00 1",
    )  # fmt: skip
    for text, words in [
        ("mqtt://amr:pw@h", "a password in an address can be read by others"),
        ("mqtt://h/a/+/b", "is not one topic"),
        ("http://h", "is not the address of an MQTT broker"),
        ("mqtt://h:99999", "is not the address of an MQTT broker"),
        ("mqtt://", "is not the address of an MQTT broker"),
    ]:
        with pytest.raises(SourceError, match=words):
            address(text)


def test_nobody_there(mosquitto: None) -> None:
    with socket.create_server((LOOPBACK, 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(SourceError, match=f"no MQTT broker at mqtt://{LOOPBACK}:{port}: "):
        Mqtt(f"mqtt://{LOOPBACK}:{port}")
