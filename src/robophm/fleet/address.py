"""The address at which a fleet takes the reports of one robot."""

from __future__ import annotations

from ipaddress import ip_address
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

from robophm.core.errors import RobophmError

EXPECTED = (
    "expected https://host/robots/NAME, or mqtts://user@broker/robots/NAME, as robophm fleet token prints it; "
    "http:// and mqtt:// only to this machine"
)

BROKERS = ("mqtt://", "mqtts://")
"""Beginnings of the addresses of brokers."""


class FleetAddress(NamedTuple):
    """The place of a fleet's service, and the robot's name there."""

    service: str
    """Address of the service, without a stroke at its end."""
    robot: str
    reports: str
    """Address to which its reports are sent; of a broker, its topic too."""

    @property
    def over_mqtt(self) -> bool:
        """Return whether it is reached over a broker."""
        return self.service.startswith(BROKERS)

    @classmethod
    def of(cls, text: str) -> FleetAddress:
        """Read an address. Raises RobophmError where it is none, or would send the token so that others can read it."""
        try:
            where = urlsplit(text)
            host, _ = where.hostname, where.port
        except ValueError as error:
            raise RobophmError(f"fleet {text!r:.100}: {error}; {EXPECTED}") from None
        before, slash, name = where.path.rstrip("/").rpartition("/robots/")
        plain = where.scheme in ("http", "mqtt") and is_this_machine(host or "")
        user = where.username if where.scheme.startswith("http") else where.password  # a password is in no address
        whole = host and slash and name and "/" not in name and not (where.query or where.fragment or user)
        if not whole or not (where.scheme in ("https", "mqtts") or plain):
            raise RobophmError(f"fleet {text!r:.100}: {EXPECTED}")
        service = f"{where.scheme}://{where.netloc}{before}"
        return cls(service, unquote(name), f"{service}/robots/{name}/reports")


def is_this_machine(host: str) -> bool:
    """Return whether a host is the machine that asks."""
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False
