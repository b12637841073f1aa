"""Addresses of robots at an MQTT broker, and where secrets are read from, which are no part of an address."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote, urlsplit

from robophm.core.errors import SourceError

EXAMPLE = "mqtt://127.0.0.1:1883/uagv/v2/MAKER/0001"
"""An address as messages show it: that of one robot by VDA 5050, interface/version/manufacturer/serial number."""

PORTS = {"mqtt": 1883, "mqtts": 8883}
"""Ports of a broker that names none, without and with TLS (IANA)."""

LONGEST_SECRET = 4096
"""Bytes of a file beyond which it is no password's."""


@dataclass(frozen=True)
class Address:
    """The place of a robot: a broker, and the topic below which it speaks."""

    host: str
    port: int
    encrypted: bool
    """Whether the broker is spoken to over TLS."""
    user: str | None
    root: str
    """Topic below which all others are, ``uagv/v2/MAKER/0001``; empty for the whole broker."""

    def __str__(self) -> str:
        scheme = "mqtts" if self.encrypted else "mqtt"
        return f"{scheme}://{self.host}:{self.port}" + (f"/{self.root}" if self.root else "")


@dataclass(frozen=True, repr=False)
class Secrets:
    """The secrets that a broker is shown to let us in, as the environment names them."""

    password: str | None = None
    authority: str | None = None
    """File with the certificates of those who may vouch for the broker; None: those that the system trusts."""
    certificate: str | None = None
    key: str | None = None


def address(text: str) -> Address:
    """Return the address of ``mqtt[s]://[user@]host[:port][/topic]``. Raises SourceError where the text is none."""
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if not host or parts.scheme not in PORTS or parts.query or parts.fragment:
        raise SourceError(f"'{text}' is not the address of an MQTT broker; expected e.g. {EXAMPLE}")
    if parts.password is not None:
        raise SourceError("a password in an address can be read by others; expected it in MQTT_PASSWORD_FILE")
    root = unquote(parts.path).strip("/")
    if {*root} & {*"+#\0"}:
        raise SourceError(f"'{root}' is not one topic; expected that of one robot without + and #, e.g. {EXAMPLE}")
    user = unquote(parts.username) if parts.username else None
    return Address(host, port or PORTS[parts.scheme], parts.scheme == "mqtts", user, root)


def secrets() -> Secrets:
    """Return what MQTT_PASSWORD or MQTT_PASSWORD_FILE, MQTT_CA_FILE, MQTT_CERTIFICATE_FILE and MQTT_KEY_FILE name.

    Raises SourceError where a file cannot be read.
    """
    password = os.environ.get("MQTT_PASSWORD")
    if password is None and (file := _file("MQTT_PASSWORD_FILE")):
        with Path(file).open("rb") as opened:
            password = opened.read(LONGEST_SECRET).decode("utf-8", "replace").rstrip("\r\n")
    return Secrets(password, _file("MQTT_CA_FILE"), _file("MQTT_CERTIFICATE_FILE"), _file("MQTT_KEY_FILE"))


def _file(variable: str) -> str | None:
    path = os.environ.get(variable)
    if path:
        try:
            Path(path).open("rb").close()
        except OSError as error:
            raise SourceError(f"{variable} is '{path}': {error.strerror}") from None
    return path or None
