"""What is sent, in both directions; and what is none is refused in words."""

from __future__ import annotations

import json
import math
import random
import zlib
from contextlib import suppress

import pytest

from robophm.core.errors import DataError
from robophm.fleet.payload import MOST_REPORTS, MOST_TEXT, packed, unpacked
from robophm.stores.outbox import COLUMNS, Batch, Present, Waiting

EPOCH = "0123456789abcdef"
FIGURES = [0.1 + at for at in range(len(COLUMNS))]
BATCH = Batch(
    (Waiting(5, EPOCH, 3, 10**18, 0, FIGURES), Waiting(9, EPOCH, 7, 2 * 10**18, 3, [None, "Infinity", *FIGURES[2:]])),
    4,
    Present(EPOCH, 12, '{"hours": 1.10, "ä": "\\u00e4"}', {"robot": "c", "design_hash": "d", "time": None}),
)


def said(**changes):
    """The JSON of a payload, with some of it changed."""
    found = json.loads(zlib.decompress(packed("r", 1, BATCH)))
    return {**found, **changes}


def sent(document) -> bytes:
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    return zlib.compress(text)


def test_what_is_packed_is_unpacked():
    found = unpacked(packed("courier 1/ä", 77, BATCH))
    assert (found.robot, found.epoch, found.sent, found.waiting) == ("courier 1/ä", EPOCH, 77, 4)
    one, other = found.reports
    assert (one.seq, one.time, one.thinned, one.figures) == (3, 10**18, 0, tuple(FIGURES))
    assert (other.seq, other.thinned) == (7, 3)
    assert math.isnan(other.figures[0])
    assert other.figures[1] == math.inf
    assert found.present.ledger == BATCH.present.ledger
    assert found.present.report == BATCH.present.report


def test_it_is_what_the_reference_says():
    found = said()
    assert list(found) == ["version", "robot", "epoch", "sent", "waiting", "columns", "reports", "present"]
    assert found["columns"] == [
        "seq", "time", "thinned", "hazard_rate.nominal", "hazard_rate.sensor_based", "unreliability.nominal",
        "unreliability.sensor_based", "remaining_life.nominal", "remaining_life.sensor_based", "task_failure.nominal",
        "task_failure.sensor_based", "operating", "state", "failure_within.24", "failure_within.168",
        "failure_within.720", "bound",
    ]  # fmt: skip


def test_columns_of_a_newer_robot_are_passed_over_and_those_of_an_older_one_not_known():
    columns = ["seq", "time", "thinned", "state", "colour"]
    (one,) = unpacked(sent(said(columns=columns, reports=[[1, 2, 0, 3, 0.5]]))).reports
    known = {name: value for name, value in zip(COLUMNS, one.figures, strict=True) if not math.isnan(value)}
    assert known == {"state": 3.0}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"version": 2}, "version 2 of the payload; this service knows version 1"),
        ({"epoch": "x" * 16}, "16 hexadecimal digits"),
        ({"epoch": 3}, "epoch: expected a text"),
        ({"robot": None}, "robot: expected a text"),
        ({"sent": -1}, "sent -1: expected a whole number"),
        ({"waiting": 1.5}, "waiting 1.5"),
        ({"columns": ["time", "seq", "thinned"]}, "columns"),
        ({"reports": "many"}, "expected a list"),
        ({"reports": [[1, 2, 0]]}, "expected rows of 17 values"),
        ({"reports": [[0, 2, 0, *FIGURES]]}, "seq: expected at least 1"),
        ({"reports": [[True, 2, 0, *FIGURES]]}, "seq True"),
        ({"reports": [[1, 2**63, 0, *FIGURES]]}, "time"),
        ({"reports": [[2, 2, 0, *FIGURES], [2, 2, 0, *FIGURES]]}, "ascending"),
        ({"reports": [[1, 2, 0, "high", *FIGURES[1:]]]}, "'high'; expected a number"),
        ({"reports": [[1, 2, 0, 1e301, *FIGURES[1:]]]}, "expected a number"),
        ({"reports": [[1, 2, 0, [], *FIGURES[1:]]]}, "expected a number"),
        ({"reports": [[at + 1, 2, 0, *FIGURES] for at in range(MOST_REPORTS + 1)]}, "at most 500"),
        ({"reports": [], "present": None}, "neither"),
        ({"present": []}, "present: expected an object"),
        ({"present": {"revision": 1, "ledger": "{", "report": None}}, "ledger"),
        ({"present": {"revision": 1, "ledger": "[]", "report": None}}, "as objects"),
        ({"present": {"revision": 1, "ledger": "{}", "report": {"robot": 3}}}, "robot: expected a text"),
        ({"present": {"revision": 1, "ledger": "[" * 100_000, "report": None}}, "ledger"),
    ],
)
def test_what_is_no_payload_is_refused_in_words(changes, words):
    with pytest.raises(DataError, match=words) as refused:
        unpacked(sent(said(**changes)))
    assert len(str(refused.value)) < 300


@pytest.mark.parametrize(
    "body",
    [
        b"", b"{}", b"\x00" * 1000, zlib.compress(b"{}")[:-2], zlib.compress(b"{}") + b"more", sent([]), sent(b"[1,"),
        sent(b"[" * 200_000), sent(b'{"version": NaN}'), sent(b"\xff\xfe"), sent(b"9" * 10_000),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused(body):
    with pytest.raises(DataError):
        unpacked(body)


def test_a_bomb_is_not_opened():
    with pytest.raises(DataError, match="more than 16 MB"):
        unpacked(zlib.compress(b" " * (MOST_TEXT + 1)))


def test_what_is_damaged_on_the_way_is_refused_or_the_same():
    """Each of 10,000 payloads with bytes changed: zlib's own checksum stands for all that JSON would pass."""
    whole, chance = packed("r", 1, BATCH), random.Random(5)
    right = unpacked(whole)
    for _ in range(10_000):
        body = bytearray(whole)
        for _ in range(chance.randint(1, 4)):
            body[chance.randrange(len(body))] = chance.randrange(256)
        with suppress(DataError):
            assert str(unpacked(bytes(body))) == str(right)  # as text, for NaN is not itself


def test_what_is_too_large_is_not_packed():
    noise = random.Random(1).randbytes(1_200_000).hex()
    with pytest.raises(DataError, match="expected at most 16 and 1"):
        packed("r", 1, BATCH._replace(present=Present(EPOCH, 1, json.dumps({"noise": noise}), None)))
