"""The wire over a real broker, Debian's Mosquitto, with the rules of access that the guide has."""

from __future__ import annotations

import itertools
import json
import re
import shutil
import subprocess
from contextlib import contextmanager
from pathlib import Path

import pytest
from tests.fleet.conftest import DEADLINE, saved, serving, wait_for
from tests.fleet.test_sender import ledger_of
from tests.transports.mqtt.conftest import Broker, mosquitto

from robophm.core.errors import RobophmError
from robophm.fleet.address import FleetAddress
from robophm.fleet.mqtt import listener
from robophm.fleet.payload import packed
from robophm.fleet.questions import present, reports, status
from robophm.fleet.sender import Sender
from robophm.fleet.store import FleetStore
from robophm.stores.sqlite import SqliteStore

__all__ = ["mosquitto"]

GUIDE = Path(__file__).parents[2] / "docs" / "guides" / "fleet.md"


@pytest.fixture(scope="module")
def users(mosquitto, tmp_path_factory):
    """A broker where users have passwords, and the rules of the guide."""
    folder = tmp_path_factory.mktemp("broker")
    (rules,) = re.findall(r"```text\n(pattern .*?)```", GUIDE.read_text(), re.DOTALL)
    (folder / "rules").write_text(rules)
    for number, name in enumerate(("fleet", "r", "other")):
        subprocess.run(
            ["mosquitto_passwd", *["-c"][number:], "-b", folder / "users", name, "secret"], check=True, timeout=DEADLINE
        )
    broker = Broker(
        folder, "allow_anonymous false", f"password_file {folder / 'users'}", f"acl_file {folder / 'rules'}"
    )
    yield broker
    broker.stop()


@pytest.fixture
def robot(tmp_path):
    with SqliteStore(tmp_path / "robot.db") as opened:
        yield opened


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setenv("MQTT_PASSWORD", "secret")
    monkeypatch.setattr(listener, "FIRST_WAIT", 0.02)
    monkeypatch.setattr(listener, "LONGEST_WAIT", 0.1)


def at(broker, robot, user=None):
    return FleetAddress.of(f"mqtt://{f'{user}@' if user else ''}127.0.0.1:{broker.port}/robots/{robot}")


@contextmanager
def taking(broker, path, caplog):
    """A service that has subscribed at the broker."""
    caplog.set_level("INFO", "robophm")
    with serving(path, broker=f"mqtt://fleet@127.0.0.1:{broker.port}"):
        wait_for(lambda: "reports are taken at" in caplog.text)
        yield


@contextmanager
def sending(robot, address, token, patience=30.0):
    """A robot with its password; what it says of trouble."""
    told: list[str] = []
    wait = {"look_every": 0.02, "first_wait": 0.02, "patience": patience}
    with Sender(robot.path, "courier", address, token, told.append, **wait):
        yield told


def paho_client(broker, user):
    """A client of paho with nothing of robophm."""
    import paho.mqtt.client as mqtt

    client = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2, protocol=mqtt.MQTTv5)
    client.username_pw_set(user, "secret")
    client.connect("127.0.0.1", broker.port)
    client.loop_start()
    wait_for(client.is_connected)
    return client


def asked(client, robot, body, token, mark):
    """What a service answers to a message, as a stranger hears it who knows the reference alone."""
    from paho.mqtt.packettypes import PacketTypes
    from paho.mqtt.properties import Properties

    heard = []
    client.on_message = lambda _, __, one: heard.append((one.properties.CorrelationData, json.loads(one.payload)))
    client.subscribe(f"robots/{robot}/answers", qos=1)
    properties = Properties(PacketTypes.PUBLISH)
    properties.CorrelationData = mark
    if token is not None:
        properties.UserProperty = ("authorization", f"Bearer {token}")
    sent = client.publish(f"robots/{robot}/reports", body, qos=1, properties=properties)
    sent.wait_for_publish(DEADLINE)
    return wait_for(lambda: [said for came, said in heard if came == mark])[0]


def test_reports_come_over_a_broker_that_is_lost_meanwhile(users, tmp_path, robot, caplog):
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        token = store.add_token("r")
        saved(robot, range(5))
        with (
            taking(users, tmp_path / "fleet.db", caplog),
            sending(robot, at(users, "r", "r"), token, patience=1.0) as told,
        ):
            wait_for(lambda: len([*reports(store)]) == 5)
            users.stop()
            saved(robot, range(5, 700), begin=False, each=139)
            wait_for(lambda: told)
            assert users.start()
            wait_for(lambda: robot.outboxes.of("courier").count() == 0)
            wait_for(lambda: told[-1].endswith("takes reports"))
        assert [one.seq for one in reports(store)] == [*range(1, 701)]
        assert present(store, "r")[0] == ledger_of(robot)
        assert (status(store)[0].missing, status(store)[0].refused) == (0, {})


def test_a_broker_without_a_service_does_not_pass_for_a_fleet(users, robot):
    """The broker takes what is published, and says so; the outbox keeps it."""
    saved(robot, range(3))
    with sending(robot, at(users, "r", "r"), "t") as told:
        wait_for(lambda: told)
    assert "no service takes reports at the broker; what is not sent waits in the store" in told[0]
    assert robot.outboxes.of("courier").count() == 3


def test_a_listener_that_is_no_service_does_not_pass_for_a_fleet(users, robot):
    saved(robot, range(3))
    other = paho_client(users, "fleet")
    other.subscribe("robots/+/reports", qos=1)
    with sending(robot, at(users, "r", "r"), "t", patience=0.3) as told:
        wait_for(lambda: any("no answer came" in one for one in told))
    assert robot.outboxes.of("courier").count() == 3
    other.disconnect()
    other.loop_stop()


def test_the_broker_keeps_robots_to_their_own_topics(users, robot, monkeypatch):
    saved(robot, range(2))
    for name, password, expected in [("other", "secret", "may not be listened to|does not take it: Not authorized"),
                                     ("r", "wrong", "does not let us in")]:  # fmt: skip
        monkeypatch.setenv("MQTT_PASSWORD", password)
        with sending(robot, at(users, name, "r"), "t") as told:
            wait_for(lambda told=told: told)
        assert re.search(expected, told[0])
    assert robot.outboxes.of("courier").count() == 2


def test_what_is_refused_is_answered_and_counted_and_repeats_change_nothing(
    users, tmp_path, robot, monkeypatch, caplog
):
    saved(robot, range(3))
    batch = robot.outboxes.of("courier").batch(500)
    marks = (b"%d" % number for number in itertools.count())
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        token, others = store.add_tokens(["r", "other"])
        client = paho_client(users, "r")
        with taking(users, tmp_path / "fleet.db", caplog):
            monkeypatch.setattr("robophm.fleet.intake.MOST_BYTES", 100_000)
            for body, shown, expected in [
                (packed("r", 1, batch), None, 401), (packed("r", 1, batch), "robophm_none", 401),
                (packed("r", 1, batch), others, 403), (packed("other", 1, batch), token, 403),
                (b"no payload", token, 422), (b"\0" * 100_001, token, 413),
            ]:  # fmt: skip
                answer = asked(client, "r", body, shown, next(marks))
                assert answer["status"] == expected
                assert answer["message"]
            assert [*reports(store)] == []
            for new in (3, 0, 0):
                answer = asked(client, "r", packed("r", 1, batch), token, next(marks))
                expected = {"epoch": batch.reports[0].epoch, "seq": 3}
                assert answer == {"status": 200, "committed": expected, "new": new, "repeated": 3 - new}
        client.disconnect()
        client.loop_stop()
        refused = {one.robot: one.refused for one in status(store)}
        assert refused["r"].pop("payload of another robot") == refused["r"].pop("malformed payload") == 1
        assert [*refused["r"]] == ["larger than 0.1 MB"]
        assert refused["other"] == {"writing for another robot": 1}


@pytest.mark.skipif(not shutil.which("openssl"), reason="no openssl")
def test_a_robot_is_its_certificate(mosquitto, tmp_path, robot, monkeypatch, caplog):
    def made(name, *signed):
        key = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-keyout", tmp_path / f"{name}.key"]
        words = ["openssl", "req", "-x509", *key, "-out", tmp_path / f"{name}.crt", "-subj", f"/CN={name}", *signed]
        subprocess.run(words, check=True, capture_output=True, timeout=DEADLINE)

    signed = ["-CA", tmp_path / "maker.crt", "-CAkey", tmp_path / "maker.key"]
    made("maker")
    made("broker", *signed, "-addext", "subjectAltName=IP:127.0.0.1")
    for name in ("fleet", "r", "stranger"):
        made(name, *(signed if name != "stranger" else ()))
    (rules,) = re.findall(r"```text\n(pattern .*?)```", GUIDE.read_text(), re.DOTALL)
    (tmp_path / "rules").write_text(rules)
    files = {"acl_file": "rules", "cafile": "maker.crt", "certfile": "broker.crt", "keyfile": "broker.key"}
    words = [f"{word} {tmp_path / file}" for word, file in files.items()]
    broker = Broker(tmp_path, *words, "require_certificate true", "use_identity_as_username true")
    address = FleetAddress.of(f"mqtts://127.0.0.1:{broker.port}/robots/r")
    monkeypatch.delenv("MQTT_PASSWORD")
    monkeypatch.setenv("MQTT_CA_FILE", str(tmp_path / "maker.crt"))

    def show(name):
        monkeypatch.setenv("MQTT_CERTIFICATE_FILE", str(tmp_path / f"{name}.crt"))
        monkeypatch.setenv("MQTT_KEY_FILE", str(tmp_path / f"{name}.key"))

    saved(robot, range(4))
    try:
        with FleetStore(tmp_path / "fleet.db", make=True) as store:
            token = store.add_token("r")
            show("stranger")
            with sending(robot, address, token) as told:
                wait_for(lambda: told)
            assert "MQTT broker" in told[0]
            show("fleet")
            caplog.set_level("INFO", "robophm")
            with serving(tmp_path / "fleet.db", broker=f"mqtts://127.0.0.1:{broker.port}"):
                wait_for(lambda: "reports are taken at" in caplog.text)
                show("r")
                with sending(robot, address, token):
                    wait_for(lambda: len([*reports(store)]) == 4)
    finally:
        broker.stop()


@pytest.mark.parametrize("text", ["mqtt://broker.example", "http://127.0.0.1", "mqtt://u:p@127.0.0.1", ""])
def test_a_broker_to_which_tokens_would_go_in_plain_text_is_refused(tmp_path, text):
    from robophm.fleet.serving import broker_of

    with pytest.raises(RobophmError, match="expected"):
        broker_of(text)
    assert [*tmp_path.iterdir()] == []
