"""Guesses of passwords: a few at once from each address, then one a minute; other addresses are not held up."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from functools import lru_cache
from ipaddress import IPv6Address, ip_address, ip_network

AT_ONCE = 5
"""Wrong passwords that an address may send before it has to wait."""

EVERY = 60.0
"""Seconds after which an address that has to wait may try once more."""

MOST_KNOWN = 10_000
"""Addresses that are remembered, the latest."""


class Guesses:
    """The wrong passwords of each address."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._free_at: OrderedDict[str, float] = OrderedDict()
        """When all the guesses of an address will be forgotten."""

    def wait(self, address: str) -> float:
        """Return the seconds until an address may try again; 0 where it may now."""
        ahead = self._free_at.get(network_of(address), 0.0) - self._clock()
        return max(ahead - (AT_ONCE - 1) * EVERY, 0.0)

    def wrong(self, address: str) -> None:
        """Take note of a wrong password."""
        key = network_of(address)
        self._free_at[key] = max(self._free_at.pop(key, 0.0), self._clock()) + EVERY
        while len(self._free_at) > MOST_KNOWN:
            self._free_at.popitem(last=False)

    def right(self, address: str) -> None:
        """Forget the wrong ones of an address."""
        self._free_at.pop(network_of(address), None)


@lru_cache(MOST_KNOWN)
def network_of(address: str) -> str:
    """Return what one customer of a network has: an address of IPv4, a /64 of IPv6."""
    try:
        found = ip_address(address)
    except ValueError:
        return address
    return str(ip_network((found, 64), strict=False)) if isinstance(found, IPv6Address) else address
