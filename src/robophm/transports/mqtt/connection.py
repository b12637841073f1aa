"""All use of paho-mqtt, in one place: one connection to a broker, which is made again with growing pauses."""

from __future__ import annotations

import logging
import threading
import uuid
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.mqtt.address import Address, secrets
from robophm.transports.signals.incidents import Incidents

ANSWER_SECONDS = 8.0
"""Seconds within which a broker has to let us in."""

CONNECT_SECONDS = 4.0
"""Seconds that one attempt to reach a broker may take."""

FIRST_WAIT, LONGEST_WAIT = 1, 30
"""Seconds before a lost connection is made again, doubled with every failure."""

KEEP_ALIVE = 10
"""Seconds after which a broker that says nothing is asked whether it is there."""

LONGEST_PACKET = 2 << 20
"""Bytes of a message, beyond which a broker of MQTT 5 is told to keep it; older ones send up to 256 MiB."""

LONGEST_RECEIVED = 32 << 20
"""Bytes of a packet beyond which the connection is given up."""

MOST_WAITING = 1000
"""Messages that wait to be sent; further ones are dropped."""

Heard = Callable[[str, bytes, bool], None]
"""Function that takes a message: its topic, its bytes, and whether it is one that the broker had kept."""

_UNKNOWN_VERSION = "Unsupported protocol version"


def paho() -> Any:
    """Return the module paho.mqtt.client. Raises SourceError, which says what to install, where it cannot be had."""
    try:
        import paho.mqtt.client
        import paho.mqtt.properties
        import paho.mqtt.subscribeoptions
    except ImportError as error:
        raise SourceError(f"MQTT needs the package paho-mqtt ({error}): pip install robophm[mqtt]") from None
    return paho


class Connection:
    """A connection to a broker, by MQTT 5, or 3.1.1 where the broker speaks no other; all below one topic is heard.

    ``heard`` is called in a thread of the connection with each message, ``lost`` when the connection is; both may
    not raise. Raises SourceError where the broker is not there, or does not let us in.
    """

    def __init__(self, place: Address, notes: Incidents, heard: Heard, lost: Callable[[], None]) -> None:
        self._place, self.notes = place, notes
        self._heard, self._lost = heard, lost
        self._name = f"robophm_{uuid.uuid4().hex[:12]}"
        self._answered = threading.Event()
        self._refused = ""
        self._over = False
        for version in (5, 4):
            self._refused = ""
            self._answered.clear()
            self._client = self._opened(version)
            if self._refused != _UNKNOWN_VERSION:
                break
            self._client.disconnect()
            self._client.loop_stop()
        if self._refused:
            self.close()
            raise SourceError(f"the MQTT broker at {place} does not let us in: {self._refused}; {_remedy(place)}")

    def _opened(self, version: int) -> Any:
        package = paho()
        client = client_of(self._place, self._name, version, self._malformed)
        client.on_connect, client.on_subscribe = self._on_connect, self._on_subscribe
        client.on_message, client.on_disconnect = self._on_message, self._on_disconnect
        client.connect_timeout = CONNECT_SECONDS
        client.reconnect_delay_set(FIRST_WAIT, LONGEST_WAIT)
        words: dict[str, Any] = {}
        if version == 5:
            properties = package.mqtt.properties.Properties(package.mqtt.packettypes.PacketTypes.CONNECT)
            properties.MaximumPacketSize = LONGEST_PACKET
            words = {"clean_start": True, "properties": properties}
        try:
            client.connect(self._place.host, self._place.port, KEEP_ALIVE, **words)
        except (OSError, ValueError) as error:  # no such host, nobody there, no TLS
            raise SourceError(f"no MQTT broker at {self._place}: {error}") from None
        client.loop_start()
        if not self._answered.wait(ANSWER_SECONDS):
            self._refused = "it did not answer"
        return client

    def _on_connect(self, client: Any, _: object, __: object, reason: Any, ___: object) -> None:
        if reason.is_failure:
            self._refused = str(reason)
            if not self._answered.is_set() or self._over:
                client.disconnect()
            else:
                self.notes.add(f"the broker does not let us in: {reason}")
            self._answered.set()
            return
        if self._answered.is_set():
            self.notes.add("connected again to the broker")
        self._subscribe(client)

    def _subscribe(self, client: Any) -> None:
        wanted = f"{self._place.root}/#" if self._place.root else "#"
        if client.protocol == 5:
            client.subscribe(wanted, options=paho().mqtt.subscribeoptions.SubscribeOptions(qos=1, noLocal=True))
        else:
            client.subscribe(wanted, qos=1)

    def ask_again(self) -> None:
        """Have the broker send once more what it keeps."""
        self._subscribe(self._client)

    def _on_subscribe(self, client: Any, _: object, __: object, reasons: list[Any], ___: object) -> None:
        if refused := next((reason for reason in reasons if reason.is_failure), None):
            self._refused = f"it may not be listened to ({refused})"
            self.notes.add(f"the broker does not let us listen: {refused}")
        self._answered.set()

    def _on_message(self, _: object, __: object, message: Any) -> None:
        try:
            topic = message.topic
        except UnicodeDecodeError:
            self._malformed()
            return
        try:
            self._heard(topic.removeprefix(self._place.root) if self._place.root else f"/{topic}",
                        bytes(message.payload), bool(message.retain))  # fmt: skip
        except Exception:  # a fault of ours must not end the listening
            self._broken()

    def _on_disconnect(self, *_: object) -> None:
        if self._answered.is_set() and not self._over and not self._refused:
            self._lost()

    def _malformed(self) -> None:
        self.notes.add("malformed packet of the broker")

    def _broken(self) -> None:
        self.notes.add("internal error")
        logging.getLogger(__name__).exception("of %s", self._name)

    def publish(self, topic: str, payload: bytes) -> None:
        """Send a message, ``topic`` below our own; never waits. What cannot be sent is counted and dropped."""
        with suppress(ValueError):
            if self._client.publish(f"{self._place.root}{topic}".lstrip("/"), payload, qos=0).rc == 0:
                return
        self.notes.add(f"not sent: {topic}")

    def close(self) -> None:
        """End the connection and its thread; twice does no harm."""
        self._over = True
        self._client.disconnect()
        self._client.loop_stop()


def client_of(place: Address, name: str, version: int, broken: Callable[[], None], **words: Any) -> Any:
    """Return a client of paho that is not connected yet, with the secrets of the environment, and TLS if that is asked.

    ``broken`` is called in its thread at a packet that paho cannot read, by which the connection is lost. Raises
    SourceError.
    """
    client = _client_class(broken)(paho().mqtt.client.CallbackAPIVersion.VERSION2, name, protocol=version, **words)
    shown = secrets()
    if place.user is not None or shown.password is not None:
        client.username_pw_set(place.user or "", shown.password)
    if place.encrypted:
        try:
            client.tls_set(shown.authority, shown.certificate, shown.key)
        except (OSError, ValueError) as error:  # a certificate without its key
            raise SourceError(f"no MQTT broker at {place}: {error}") from None
    return client


def _client_class(broken: Callable[[], None]) -> Any:
    mqtt = paho().mqtt

    class Client(mqtt.client.Client):  # type: ignore[misc, name-defined]
        """A client that gives up the connection, and makes it again, at a packet that paho cannot read."""

        def _packet_read(self) -> Any:
            try:
                return super()._packet_read()
            except Exception:  # paho lets out whatever comes of it
                broken()
                return mqtt.client.MQTT_ERR_PROTOCOL

        def _sock_recv(self, bufsize: int) -> bytes:
            if bufsize > LONGEST_RECEIVED:
                raise ValueError(f"a packet of {bufsize} bytes")
            received: bytes = super()._sock_recv(bufsize)
            return received

    return Client


def _remedy(place: Address) -> str:
    if place.user is None:
        return f"expected a user in its address, mqtt://USER@{place.host}, and MQTT_PASSWORD_FILE"
    return f"expected the password of {place.user} in MQTT_PASSWORD_FILE, and leave to read {place.root or '#'}"
