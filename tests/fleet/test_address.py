"""Where a robot reports to; a token goes to nobody who could read it on the way."""

from __future__ import annotations

import pytest

from robophm.core.errors import RobophmError
from robophm.fleet.address import FleetAddress


@pytest.mark.parametrize(
    ("text", "service", "robot"),
    [
        ("https://fleet.example:8708/robots/courier-17", "https://fleet.example:8708", "courier-17"),
        ("https://example.org/phm/robots/a%20b%2Fc/", "https://example.org/phm", "a b/c"),
        ("http://127.0.0.1:8708/robots/x", "http://127.0.0.1:8708", "x"),
        ("http://localhost/robots/x", "http://localhost", "x"),
        ("http://[::1]:80/robots/x", "http://[::1]:80", "x"),
        ("mqtts://a@broker.example/phm/robots/a%2Bb", "mqtts://a@broker.example/phm", "a+b"),
        ("mqtt://127.0.0.1:1883/robots/x", "mqtt://127.0.0.1:1883", "x"),
    ],
)
def test_addresses(text, service, robot):
    found = FleetAddress.of(text)
    assert (found.service, found.robot) == (service, robot)
    assert found.over_mqtt == text.startswith("mqtt")
    assert found.reports == f"{text.rstrip('/')}/reports"


@pytest.mark.parametrize(
    "text",
    [
        "", "fleet.example", "https://fleet.example", "https://fleet.example/robots/", "https://h/robots/a/b",
        "http://fleet.example/robots/a", "http://127.0.0.1.example.org/robots/a", "ftp://127.0.0.1/robots/a",
        "https://user:secret@h/robots/a", "https://h/robots/a?token=b", "https://h:port/robots/a", "https://[::1/robots/a",
        "mqtt://broker.example/robots/a", "mqtts://a:secret@broker.example/robots/a", "mqtts://broker.example/a",
    ],
)  # fmt: skip
def test_what_is_no_address_is_refused_in_words(text):
    with pytest.raises(RobophmError, match="expected https://host/robots/NAME"):
        FleetAddress.of(text)
