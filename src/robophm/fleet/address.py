"""The address at which a fleet takes the reports of one robot."""

from __future__ import annotations

from ipaddress import ip_address
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

from robophm.core.errors import RobophmError

EXPECTED = "expected https://host/robots/NAME, as robophm fleet token prints it; http:// only to this machine"


class FleetAddress(NamedTuple):
    """The place of a fleet's service, and the robot's name there."""

    service: str
    """Address of the service, without a stroke at its end."""
    robot: str
    reports: str
    """Address to which its reports are sent."""

    @classmethod
    def of(cls, text: str) -> FleetAddress:
        """Read an address. Raises RobophmError where it is none, or would send the token so that others can read it."""
        try:
            where = urlsplit(text)
            host, _ = where.hostname, where.port
        except ValueError as error:
            raise RobophmError(f"fleet {text!r:.100}: {error}; {EXPECTED}") from None
        before, slash, name = where.path.rstrip("/").rpartition("/robots/")
        plain = where.scheme == "http" and _is_this_machine(host or "")
        whole = host and slash and name and "/" not in name and not (where.query or where.fragment or where.username)
        if not whole or not (where.scheme == "https" or plain):
            raise RobophmError(f"fleet {text!r:.100}: {EXPECTED}")
        service = f"{where.scheme}://{where.netloc}{before}"
        return cls(service, unquote(name), f"{service}/robots/{name}/reports")


def _is_this_machine(host: str) -> bool:
    try:
        return host == "localhost" or ip_address(host).is_loopback
    except ValueError:
        return False
