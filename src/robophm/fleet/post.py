"""One payload of a robot brought to its fleet over HTTP, and what the fleet answers."""

from __future__ import annotations

import http.client
import json
import ssl
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.request import HTTPRedirectHandler, HTTPSHandler, ProxyHandler, Request, build_opener

from robophm.core.errors import RobophmError
from robophm.fleet.address import FleetAddress
from robophm.fleet.answer import check
from robophm.stores.outbox import Batch


class HttpPost:
    """The way of one robot's payloads to its fleet over HTTP, with the robot's token."""

    def __init__(self, fleet: FleetAddress, token: str, patience: float) -> None:
        """``patience``: seconds to wait for an answer."""
        self._fleet, self._patience = fleet, patience
        self._headers = {
            "authorization": f"Bearer {token}", "content-type": "application/zlib", "user-agent": "robophm",
        }  # fmt: skip
        self._opener = build_opener(ProxyHandler({}), _NoRedirect(), HTTPSHandler(context=ssl.create_default_context()))

    def send(self, body: bytes, batch: Batch) -> None:
        """Send the payload of a batch, and return once the fleet says that all of it is committed.

        Raises OSError or HTTPException where it is not reached, DataError where it answers something else; ``why_not``
        has words for each.
        """
        request = Request(self._fleet.reports, body, self._headers)
        with self._opener.open(request, timeout=self._patience) as answer:
            text = answer.read(10_000)
        try:
            said = json.loads(text)
        except (ValueError, RecursionError):
            said = text
        check(said, batch)

    def close(self) -> None:
        """Let go of what it holds, which is nothing: each payload has a connection of its own."""


class _NoRedirect(HTTPRedirectHandler):
    """An address that sends elsewhere is refused: the token goes where the command line says, and nowhere else."""

    def redirect_request(self, *_: Any, **__: Any) -> None:
        return None


def why_not(error: Exception) -> str:
    """Return what is in the way, in words: those of the fleet where it says why."""
    if isinstance(error, HTTPError):
        with error:
            try:
                said = str(json.loads(error.read(10_000))["message"])
            except (ValueError, KeyError, TypeError, OSError, http.client.HTTPException):
                said = error.reason
        return f"refuses reports ({error.code}): {said}"
    if isinstance(error, RobophmError):
        return str(error)
    reason = error.reason if isinstance(error, URLError) else error
    return f"is not reached: {' '.join(str(reason).split()) or type(error).__name__}"
