"""The way of a robot's payloads to its fleet: over HTTP, or over a broker of MQTT, as the fleet's address says."""

from __future__ import annotations

from typing import Protocol

from robophm.fleet.address import FleetAddress
from robophm.fleet.mqtt.post import MqttPost
from robophm.fleet.post import HttpPost
from robophm.stores.outbox import Batch

LONGEST_ANSWER = 30.0
"""Seconds to wait for an answer: the fleet answers once all is on its disk."""


class Way(Protocol):
    """The way of one robot's payloads to its fleet."""

    def send(self, body: bytes, batch: Batch) -> None:
        """Send the payload of a batch, and return once the fleet says that all of it is committed.

        Raises OSError, HTTPException or RobophmError where it does not; ``post.why_not`` has words for each.
        """

    def close(self) -> None:
        """Let go of what it holds."""


def way_to(fleet: FleetAddress, token: str, patience: float = LONGEST_ANSWER) -> Way:
    """Return the way to a fleet. Raises RobophmError where what it needs is not installed."""
    return (MqttPost if fleet.over_mqtt else HttpPost)(fleet, token, patience)
