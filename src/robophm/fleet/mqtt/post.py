"""One payload of a robot brought to its fleet over a broker, and what the fleet answers."""

from __future__ import annotations

import json
import queue
import secrets
import time
from typing import Any

from robophm.core.errors import DataError
from robophm.fleet.address import FleetAddress
from robophm.fleet.answer import check
from robophm.fleet.mqtt.connection import Connection, Lines
from robophm.stores.outbox import Batch
from robophm.transports.mqtt import address


class MqttPost:
    """The way of one robot's payloads to its fleet over a broker, with the robot's token.

    The connection is made when something is to be sent and there is none. What counts is the fleet's answer, never the
    broker's: a broker says what it has taken, not what is on the fleet's disk.
    """

    def __init__(self, fleet: FleetAddress, token: str, patience: float) -> None:
        """``patience``: seconds to wait for the fleet's answer."""
        self._place, self._robot, self._token, self._patience = address(fleet.service), fleet.robot, token, patience
        self._lines = Lines(self._place.root)
        self._came: queue.SimpleQueue[Any] = queue.SimpleQueue()
        """Messages that came, and texts that say why none will come."""
        self._connection: Connection | None = None

    def send(self, body: bytes, batch: Batch) -> None:
        """Send the payload of a batch, and return once the fleet says that all of it is committed.

        Raises OSError where no answer comes, SourceError where the broker is not reached, DataError where the fleet
        answers something else.
        """
        connection = self._connected()
        while not self._came.empty():
            self._came.get()
        mark = secrets.token_bytes(16)
        connection.publish(self._lines.reports(self._robot), body, mark, self._token)
        answer = self._answer(connection, mark)
        if isinstance(answer, dict) and "message" in answer:
            status, why = str(answer.get("status"))[:10], str(answer["message"])[:1000]
            raise DataError(f"refuses reports ({status}): {' '.join(why.split())}")
        check(answer, batch)

    def _connected(self) -> Connection:
        if not (self._connection and self._connection.is_open):
            self.close()
            self._connection = Connection(
                self._place, self._lines.answers(self._robot), self._came.put,
                lambda: self._came.put("the connection to the broker is lost"), self._came.put,
            )  # fmt: skip
        return self._connection

    def _answer(self, connection: Connection, mark: bytes) -> Any:
        """What is answered to the message of that mark. Raises OSError where that is nothing."""
        end = time.monotonic() + self._patience
        while True:
            try:
                one = self._came.get(timeout=max(0.0, end - time.monotonic()))
            except queue.Empty:
                raise TimeoutError("the broker has taken it, and no answer came") from None
            if isinstance(one, str):
                if one:
                    raise ConnectionError(one)
                continue
            connection.acknowledge(one)
            if getattr(one.properties, "CorrelationData", b"") == mark:  # others are of what was sent before
                try:
                    return json.loads(one.payload)
                except (ValueError, RecursionError):
                    return one.payload

    def close(self) -> None:
        """End the connection."""
        if self._connection:
            self._connection.close()
            self._connection = None
