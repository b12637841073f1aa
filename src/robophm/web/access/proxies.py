"""Reverse proxies that are believed when they say who asks: they log people in, by OpenID Connect for example."""

from __future__ import annotations

from collections.abc import Iterable
from ipaddress import ip_address, ip_network

from starlette.datastructures import Headers

from robophm.core.errors import RobophmError
from robophm.web.access.roles import ROLES
from robophm.web.access.users import LONGEST_NAME, User

NAME, GROUPS = "x-forwarded-user", "x-forwarded-groups"
"""Headers by which a proxy says who asks, and in which groups they are; as oauth2-proxy sends them."""


class Proxies:
    """The addresses of the proxies that are believed."""

    def __init__(self, networks: Iterable[str]) -> None:
        """Take addresses or networks of them. Raises RobophmError."""
        self._networks = []
        for one in networks:
            try:
                self._networks.append(ip_network(one.strip()))
            except ValueError:
                raise RobophmError(f"proxy {one}: expected an address such as 127.0.0.1, or 10.0.0.0/8") from None

    def __bool__(self) -> bool:
        """Return whether any is believed."""
        return bool(self._networks)

    def believed(self, address: str) -> bool:
        """Return whether a proxy is at that address."""
        try:
            found = ip_address(address)
        except ValueError:
            return False
        return any(found in network for network in self._networks)

    def address_of(self, peer: str, headers: Headers) -> str:
        """Return from where a request came: of all that a proxy names, the last that is none itself."""
        named = [one.strip() for line in headers.getlist("x-forwarded-for") for one in line.split(",")]
        while self.believed(peer) and named:
            peer = named.pop()
        return peer[:LONGEST_NAME]

    def is_secure(self, peer: str, headers: Headers) -> bool:
        """Return whether a proxy says that it was asked over TLS."""
        return self.believed(peer) and headers.get("x-forwarded-proto", "") == "https"

    def user(self, peer: str, headers: Headers) -> User | None:
        """Return who asks, as a proxy says; the role is that of the groups robophm-viewer, -operator, -editor."""
        name = headers.get(NAME, "").strip()
        if not name or not self.believed(peer):
            return None
        groups = {one.strip() for line in headers.getlist(GROUPS) for one in line.split(",")}
        roles = [role for role in ROLES if f"robophm-{role}" in groups]
        return User(name[:LONGEST_NAME], roles[-1], "person") if roles else None


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
