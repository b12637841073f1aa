"""One connection to a broker by MQTT 5, from when it is made until it is lost; both ends of the wire have one."""

from __future__ import annotations

import logging
import threading
import uuid
from collections.abc import Callable
from typing import Any
from urllib.parse import quote, unquote

from robophm.core.errors import RobophmError, SourceError
from robophm.fleet.address import is_this_machine
from robophm.transports.mqtt import Address
from robophm.transports.mqtt.connection import ANSWER_SECONDS, CONNECT_SECONDS, KEEP_ALIVE, client_of, paho

LONGEST_PACKET = 2_000_000
"""Bytes of a message, beyond which the broker is told to keep it: twice the largest payload."""

AT_ONCE = 50
"""Messages that the broker may hand over before those that it has handed over are acknowledged."""

MOST_WAITING = 1000
"""Messages that wait to be sent; further ones are dropped, and their robots send again."""

NOBODY_LISTENS = 0x10
"""Reason by which a broker of MQTT 5 says that nobody has subscribed to what was published."""


class Lines:
    """The topics of a fleet below the one of an address: what robots report, and what they are answered."""

    def __init__(self, root: str) -> None:
        self._before = f"{root}/robots/" if root else "robots/"

    def reports(self, robot: str | None) -> str:
        """Return where a robot reports to; None: each of them."""
        return f"{self._before}{'+' if robot is None else quote(robot, safe='')}/reports"

    def answers(self, robot: str) -> str:
        """Return where a robot is answered."""
        return f"{self._before}{quote(robot, safe='')}/answers"

    def robot_of(self, topic: str) -> str:
        """Return whose topic it is."""
        return unquote(topic.removeprefix(self._before).rpartition("/")[0])


class Connection:
    """A connection to a broker on which one topic is heard; it ends when it is lost, and is then made anew by whoever
    needs it.

    ``heard`` takes each message of paho, ``sent`` why one of ours was not taken, or "", and ``lost`` is called once;
    all in a thread of the connection, and none may raise. Raises RobophmError where the broker is not there, or does
    not let us in.
    """

    def __init__(
        self, place: Address, topic: str, heard: Callable[[Any], None], lost: Callable[[], None],
        sent: Callable[[str], None] = lambda why: None,
    ) -> None:  # fmt: skip
        refuse_plain(place)
        self._place, self._topic = place, topic
        self._heard, self._sent, self._lost = heard, sent, lost
        self._answered = threading.Event()
        self._refused = "it did not answer"
        self.is_open = False
        mqtt = paho().mqtt
        self._client = client_of(
            place,
            f"robophm_{uuid.uuid4().hex[:12]}",
            5,
            self._on_disconnect,
            manual_ack=True,
            reconnect_on_failure=False,
        )
        self._client.max_queued_messages_set(MOST_WAITING)
        self._client.on_connect, self._client.on_subscribe = self._on_connect, self._on_subscribe
        self._client.on_message, self._client.on_publish = self._on_message, self._on_publish
        self._client.on_disconnect = self._on_disconnect
        self._client.connect_timeout = CONNECT_SECONDS
        properties = mqtt.properties.Properties(mqtt.packettypes.PacketTypes.CONNECT)
        properties.MaximumPacketSize, properties.ReceiveMaximum = LONGEST_PACKET, AT_ONCE
        try:
            self._client.connect(place.host, place.port, KEEP_ALIVE, clean_start=True, properties=properties)
        except (OSError, ValueError) as error:  # no such host, nobody there, no TLS
            raise SourceError(f"no MQTT broker at {place}: {error}") from None
        self._client.loop_start()
        self._answered.wait(ANSWER_SECONDS)
        if not self.is_open:
            self.close()
            raise SourceError(f"the MQTT broker at {place} does not let us in: {self._refused}")

    def _on_connect(self, client: Any, _: object, __: object, reason: Any, ___: object) -> None:
        if reason.is_failure:
            self._refused = str(reason)
            self._answered.set()
        else:
            client.subscribe(self._topic, qos=1)

    def _on_subscribe(self, _: object, __: object, ___: object, reasons: list[Any], ____: object) -> None:
        refused = [str(reason) for reason in reasons if reason.is_failure]
        self._refused = f"{self._topic} may not be listened to ({', '.join(refused)})"
        self.is_open = not refused
        self._answered.set()

    def _on_message(self, _: object, __: object, message: Any) -> None:
        self._heard(message)

    def _on_publish(self, _: object, __: object, ___: object, reason: Any, ____: object) -> None:
        if reason.is_failure:
            self._sent(f"the broker does not take it: {reason}")
        else:
            self._sent("no service takes reports at the broker" if reason.value == NOBODY_LISTENS else "")

    def _on_disconnect(self, *_: object) -> None:
        was, self.is_open = self.is_open, False
        self._answered.set()
        if was:
            self._lost()

    def publish(self, topic: str, body: bytes, correlation: bytes, token: str | None = None) -> None:
        """Send a message, with a token if there is one; never waits. What cannot be sent is dropped."""
        mqtt = paho().mqtt
        properties = mqtt.properties.Properties(mqtt.packettypes.PacketTypes.PUBLISH)
        properties.CorrelationData = correlation
        if token is not None:
            properties.UserProperty = ("authorization", f"Bearer {token}")
        try:
            self._client.publish(topic, body, qos=1, properties=properties)
        except ValueError:  # larger than MQTT has
            logging.getLogger("robophm").exception("a message for %s", self._place)

    def acknowledge(self, message: Any) -> None:
        """Tell the broker that it may let go of a message."""
        self._client.ack(message.mid, message.qos)

    def close(self) -> None:
        """End the connection and its thread; twice does no harm."""
        self.is_open = False
        self._client.disconnect()
        self._client.loop_stop()


def refuse_plain(place: Address) -> None:
    """Raise RobophmError where tokens would go to another machine so that others can read them."""
    if not place.encrypted and not is_this_machine(place.host):
        raise RobophmError(f"broker {str(place)!r:.100}: robots' tokens go there; expected mqtts://, or mqtt:// to "
                           "this machine")  # fmt: skip
