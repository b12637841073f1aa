"""The live source of a server of the Foxglove WebSocket protocol."""

from __future__ import annotations

import json
import re
import threading
import time
from collections import Counter
from collections.abc import Collection
from itertools import count
from typing import Any

from robophm.core.errors import SourceError
from robophm.transports.foxglove.protocol import (
    MOST_CHANNELS,
    PUBLISHED_ENCODINGS,
    SERVER,
    Channel,
    channels_of,
    message_in,
    text,
)
from robophm.transports.live.decoding import Numbers, TopicDecoder
from robophm.transports.live.pushed import Pushed
from robophm.transports.live.receiving import CLOCK_TOPIC, QUEUE, TICK
from robophm.transports.live.served import ServedSource, Subscriptions, uncounted
from robophm.transports.signals.incidents import TypeRefusedError
from robophm.transports.signals.message_type import numeric_fields
from robophm.transports.signals.source import TopicInfo

DISCOVERY_SECONDS = 1.0
"""Seconds from the first connection until the channels that a server has are taken to be known."""

AGAIN_SECONDS, MOST_AGAIN = 0.2, 10
"""Seconds until a channel is subscribed again that the server refused, and how many times that is done."""

LONGEST_STATUS = 1000
"""Characters of a server's warning that are read."""


class Foxglove(ServedSource[Channel]):
    """Live topics of a robot that serves them over the Foxglove WebSocket protocol; a context manager.

    ``place`` is ``foxglove://host:port``; the server's own default is port 8765 of this machine. ``samples`` is
    endless: it goes on through a server that is lost and channels that come and go, until ``close``, which may come
    from any thread. A sample's time is its header's stamp, or its receipt where that is zero or 10 s off; where the
    server has /clock, receipt is its time. Clock samples come at multiples of ``period`` [s], and at least twice a
    second. ``notes`` counts what was dropped, refused, unreadable, and made anew.

    Raises SourceError where there is no such server.
    """

    server = SERVER

    def __init__(self, place: str = "foxglove", *, queue: int = QUEUE, period: float = TICK) -> None:
        super().__init__(place, queue, period)
        self._descriptions: dict[str, tuple[str, tuple[str, ...]]] = {}
        self._taken: tuple[str, ...] = ()
        """Encodings of messages that the server takes from us; none where it takes none."""
        self._listening: _Listening | None = None
        self.connection.start()
        self._born = time.monotonic()

    def hidden_by(self) -> list[str]:
        """Return what could keep topics from being heard."""
        return ["a server may serve some of its robot's topics alone: topic_whitelist of foxglove_bridge"]

    def published_encoding(self) -> str:
        """Return the encoding in which the server takes messages of ROS; empty where it takes none."""
        self._settle()
        return next((one for one in PUBLISHED_ENCODINGS if one in self._taken), "")

    def _settle(self) -> None:
        time.sleep(max(0.0, self._born + DISCOVERY_SECONDS - time.monotonic()))

    def take(self, frame: str | bytes) -> None:
        """Take a frame; called in the connection's thread."""
        if isinstance(frame, bytes):
            if (message := message_in(frame)) and (listening := self._listening):
                listening.hear(*message)
            return
        try:
            said = json.loads(frame)
        except (ValueError, RecursionError):
            said = None
        if isinstance(said, dict):
            self._told(said)
        else:
            self.connection.notes.add("malformed message of the server")

    def opened(self) -> None:
        """Take it that there is a connection again: the server tells its channels by itself."""

    def _told(self, message: dict[str, Any]) -> None:
        op = message.get("op")
        if op == "serverInfo":
            takes = "clientPublish" in _listed(message, "capabilities")
            self._taken = tuple(map(str, _listed(message, "supportedEncodings"))) if takes else ()
        elif op == "advertise":
            with self._lock:
                for channel in channels_of(message.get("channels")):
                    if len(self._announced) >= MOST_CHANNELS:
                        self._notes.add(f"over {MOST_CHANNELS} channels, some not heard")
                        break
                    self._announced[channel.id] = channel
                    if self._listening:
                        self._listening.take_in(channel)
        elif op == "unadvertise":
            with self._lock:
                gone = [
                    one for one in _listed(message, "channelIds") if isinstance(one, int) and one in self._announced
                ]
                for number in gone:
                    del self._announced[number]
                if self._listening:
                    self._listening.let_go(gone)
        elif op == "status" and message.get("level") in (1, 2):
            self._notes.add("the server warns, as its own log says")
            with self._lock:
                if self._listening:
                    self._listening.refused(str(message.get("message"))[:LONGEST_STATUS])

    def topics(self) -> list[TopicInfo]:
        """Return the topics served now; their messages and times are counted since they are listened to."""
        if self._closed:
            raise SourceError("the source is closed")
        self._settle()
        found: dict[str, TopicInfo] = {}
        with self._lock:
            channels = list(self._announced.values())
        for channel in channels:
            name, fields = self._described(channel)
            found.setdefault(channel.topic, TopicInfo(channel.topic, name, *self._counted(channel.topic), fields))
        return [found[topic] for topic in sorted(found)]

    def _described(self, channel: Channel) -> tuple[str, tuple[str, ...]]:
        """The name of its type and the fields that are numbers; none where it cannot be decoded."""
        if channel.identity not in self._descriptions:
            try:
                type_ = channel.type()
            except SourceError:
                found: tuple[str, tuple[str, ...]] = channel.schema_name, ()
            else:
                found = type_.name, tuple(numeric_fields(type_.definitions, type_.name))
            self._descriptions[channel.identity] = found
        return self._descriptions[channel.identity]

    def _subscriptions(self, wanted: dict[str, list[str]], pushed: Pushed) -> _Listening:
        return _Listening(self, wanted, pushed)


def _listed(message: dict[str, Any], name: str) -> list[Any]:
    """The list in a message, empty where it has none."""
    found = message.get(name)
    return found if isinstance(found, list) else []


class _Mixed(TopicDecoder):
    """Reads a channel, on which a server puts the messages of all publishers of a topic: their header.seq is none."""

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        """Return the numbers of one message, without its place in a sequence."""
        return super().read(raw, whole=whole)._replace(sequence=None)


class _Listening(Subscriptions[Channel]):
    """Which channels are subscribed, each with its decoder."""

    _numbers = count(1)

    def __init__(self, source: Foxglove, wanted: dict[str, list[str]], pushed: Pushed) -> None:
        super().__init__(source.connection.notes, wanted, pushed)
        self._source = source
        self._decoders: dict[int, TopicDecoder] = {}
        """Decoders by the numbers of subscriptions."""
        self._subscribed: dict[int, int] = {}
        """Subscriptions by the numbers of their channels."""
        self._refusals: Counter[int] = Counter()
        """How many times each channel was refused."""

    def take_in(self, channel: Channel) -> None:
        """Subscribe a channel, where it is wanted and can be decoded."""
        if channel.topic not in self._wanted or channel.id in self._subscribed:
            return
        try:
            decoder = self._decoder(channel)
        except TypeRefusedError as error:
            self._refuse(channel.topic, error.kind, error)
            return
        self._begin(channel.topic, channel.identity)
        if channel.topic != CLOCK_TOPIC:
            self._notes.once(f"{uncounted(SERVER)}: its messages have no numbers, and may be of several publishers")
        number = next(self._numbers)
        self._decoders[number] = decoder
        self._subscribed[channel.id] = number
        self._ask(channel.id, number)

    def _ask(self, channel: int, number: int) -> None:
        """Send a subscription, where it is still wanted."""
        if self._subscribed.get(channel) == number and number in self._decoders:
            self._source.connection.send(text("subscribe", subscriptions=[{"id": number, "channelId": channel}]))

    def refused(self, status: str) -> None:
        """Subscribe again the channels that a warning of the server names.

        The server of Foxglove's SDK announces a channel before it can be subscribed: who is quicker is refused.
        """
        for channel in {int(one) for one in re.findall(r"[0-9]{1,15}", status)} & self._subscribed.keys():
            self._refusals[channel] += 1
            if self._refusals[channel] <= MOST_AGAIN:
                again = threading.Timer(AGAIN_SECONDS, self._ask, (channel, self._subscribed[channel]))
                again.daemon = True
                again.start()

    def _decoder(self, channel: Channel) -> TopicDecoder:
        try:
            return _Mixed(channel.topic, channel.type(), self._wanted[channel.topic], channel.identity)
        except TypeRefusedError:
            raise
        except SourceError as error:
            raise TypeRefusedError(str(error), "definition missing or damaged") from None

    def hear(self, subscription: int, raw: bytes) -> None:
        """Take a message of a subscription; of one that has ended it is left."""
        if decoder := self._decoders.get(subscription):
            self.pushed.hear(decoder, raw)

    def let_go(self, channels: Collection[int] | None = None) -> None:
        """Take it that channels are gone, all unless some are given: what was heard there has a gap."""
        gone = [self._subscribed.pop(one, 0) for one in list(self._subscribed if channels is None else channels)]
        decoders = [self._decoders.pop(number, None) for number in gone]  # of which there are none once it is closed
        self.pushed.lost([decoder for decoder in decoders if decoder])

    def close(self) -> None:
        """Subscribe no longer; twice does no harm."""
        numbers = list(self._decoders)
        self._decoders.clear()
        if numbers:
            self._source.connection.send(text("unsubscribe", subscriptionIds=numbers))
        self.pushed.close()
