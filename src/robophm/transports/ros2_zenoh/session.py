"""Sessions of Zenoh: all that is configured of them, as rmw_zenoh has it."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from robophm.core.errors import SourceError
from robophm.transports.ros2_dds.environment import LONGEST_MESSAGE

PORT = 7447
"""Port of a router that names none."""

LOCAL = f"localhost:{PORT}"
"""The router to which the nodes of a robot connect, by rmw_zenoh's own configuration."""


def wheel() -> Any:
    """Return the package zenoh. Raises SourceError, which says what to install, where it cannot be had."""
    try:
        import zenoh
        import zenoh.ext
        import zenoh.handlers
    except Exception as error:  # of a library that does not load
        raise SourceError(f"ROS 2 over Zenoh needs eclipse-zenoh ({error}): pip install robophm[zenoh]") from None
    return zenoh


def router_of(address: str) -> str:
    """Return ``host:port`` of ``zenoh://host[:port]``, and nothing for ``zenoh``. Raises SourceError for another."""
    if address in ("", "zenoh"):
        return ""
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if host is None or parts.scheme != "zenoh" or parts.path not in ("", "/") or "@" in parts.netloc:
        raise SourceError(f"'{address[:200]}' is no address; expected zenoh://host or zenoh://host:{PORT}")
    return f"[{host}]:{port or PORT}" if ":" in host else f"{host}:{port or PORT}"


def place_of(router: str) -> str:
    """Return where nodes are looked for, for people."""
    own = os.environ.get("ZENOH_SESSION_CONFIG_URI")
    return f"the router at {router}" if router else f"what {own} says" if own else f"the router at {LOCAL}"


def opened(router: str) -> Any:
    """Open a session: as a node of this robot, or with a ``router``, ``host:port``, as its client.

    ZENOH_SESSION_CONFIG_URI and ZENOH_CONFIG_OVERRIDE hold as for rmw_zenoh. Raises SourceError where a router that is
    named does not answer, or what is configured is no configuration.
    """
    zenoh = wheel()
    own = os.environ.get("ZENOH_SESSION_CONFIG_URI")
    try:
        config = zenoh.Config.from_file(own) if own and not router else zenoh.Config()
        told = {} if own and not router else _defaults(router)
        for part in filter(None, os.environ.get("ZENOH_CONFIG_OVERRIDE", "").split(";")):
            name, _, value = part.partition("=")
            told[name.strip()] = value
        for name, value in told.items():
            config.insert_json5(name, value)
        return zenoh.open(config)
    except Exception as error:  # of files, of JSON5 and of Zenoh, which tells them apart in words alone
        why = " ".join(str(error).partition(" at /")[0].split())
        raise SourceError(f"no Zenoh by {place_of(router)}: {why}") from None


def undeclare(declared: Any) -> None:
    """Take back what was declared; twice, or after the session has ended, does no harm."""
    with suppress(wheel().ZError):
        declared.undeclare()


def _defaults(router: str) -> dict[str, str]:
    """rmw_zenoh's: nodes find each other by the robot's router, not by multicast, and then speak to each other."""
    values = {
        "mode": "client" if router else "peer",
        "connect/endpoints": [f"tcp/{router or LOCAL}"],
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": True,
        "timestamping/enabled": True,  # history needs it
        "transport/link/rx/max_message_size": LONGEST_MESSAGE,
    }
    if not router:
        values["listen/endpoints"] = ["tcp/localhost:0"]
    return {name: json.dumps(value) for name, value in values.items()}
