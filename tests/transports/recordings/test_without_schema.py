"""MCAP whose messages alone say which fields they have: JSON without a schema, CBOR and MessagePack."""

from __future__ import annotations

import json
import math
import struct
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import Writer

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns, recorded_topics
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording

cbor2 = pytest.importorskip("cbor2", reason="no cbor2 (make setup installs it)")
msgpack = pytest.importorskip("msgpack", reason="no msgpack (make setup installs it)")

T0 = 1_750_000_000 * SECOND
ENCODERS: dict[str, Callable[[Any], bytes]] = {"json": lambda one: json.dumps(one).encode(), "cbor": cbor2.dumps,
                                               "msgpack": msgpack.packb}  # fmt: skip


def write(path: Path, encoding: str, messages: Sequence[bytes], schema: bytes | None = None, first: int = T0) -> Path:
    """Messages a second apart; where there is no schema the channel says so by the number 0."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=2000)
        writer.start()
        number = 0 if schema is None else writer.register_schema("pack", "jsonschema", schema)
        channel = writer.register_channel("/pack", encoding, number)
        for step, raw in enumerate(messages):
            writer.add_message(channel, first + step * SECOND, raw, first + step * SECOND)
        writer.finish()
    return path


def numbers(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Every number in what a library decoded, by the path of its field."""
    if isinstance(value, dict):
        for name, one in value.items():
            yield from numbers(one, f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for index, one in enumerate(value):
            yield from numbers(one, f"{path}[{index}]")
    elif isinstance(value, int | float):
        yield path, float(value)


PACK = [
    {
        "timestamp": {"sec": T0 // SECOND + step, "nsec": 5},
        "volts": 24.1 + step / 7,
        "charging": step % 2 == 0,
        "serial": "7",
        "cells": [{"volts": 4.0 + cell / 3, "cycles": 2**40 + step} for cell in range(3)],
        "readings": [step * 0.1, step * 0.2],
        "joints": [{"name": "pan", "effort": 1.5 * step}, {"name": "lift", "effort": -step}],
        "nothing": None,
    }
    for step in range(50)
]


@pytest.mark.parametrize("encoding", ENCODERS)
@pytest.mark.parametrize("schema", [None, b"", b"{}", b'{"type": "object"}'], ids=["none", "empty", "any", "an object"])
def test_every_number_is_read_as_it_comes(tmp_path: Path, encoding: str, schema: bytes | None) -> None:
    path = write(tmp_path / "drive.mcap", encoding, [ENCODERS[encoding](one) for one in PACK], schema)
    expected: dict[str, list[float]] = {}
    for one in PACK:
        for field, value in numbers(one):
            expected.setdefault(f"/pack.{field}", []).append(value)
    with open_source(path) as source:
        found: dict[str, list[float]] = {}
        for sample in source.samples(expected):
            found.setdefault(sample.signal, []).append(sample.value)
            assert sample.time % SECOND == 5
    assert found == expected
    columns: dict[str, list[float]] = {}
    for block in read_columns(path, expected):
        for field, values in block["/pack"].values.items():
            columns.setdefault(f"/pack.{field}", []).extend(values.tolist())
    assert columns == expected
    ((_, fields),) = recorded_topics(path).values()
    assert fields == ("timestamp.sec", "timestamp.nsec", "volts", "charging", "cells[].volts", "cells[].cycles",
                      "readings[]", "joints[].effort")  # fmt: skip
    with Recording(path) as recording:
        assert recording.names()["/pack"]["joints[]"] == ["pan", "lift"]
        assert [one.value for one in recording.samples(["/pack.joints[lift].effort"])] == [-step for step in range(50)]


@pytest.mark.full
@pytest.mark.parametrize("encoding", ENCODERS)
def test_a_field_that_few_messages_have_is_read_where_it_is_asked_for(tmp_path: Path, encoding: str) -> None:
    each: list[dict[str, Any]] = [{"volts": step} for step in range(3000)]
    each[1100]["fault"] = {"code": 7.5}
    path = write(tmp_path / "drive.mcap", encoding, [ENCODERS[encoding](one) for one in each])
    for _ in range(2):  # also of what was learnt before of the file
        assert recorded_topics(path)["/pack"][1] == ("volts",)
        with open_source(path) as source:
            found = [one.value for one in source.samples(["/pack.fault.code"]) if not math.isnan(one.value)]
            assert found == [7.5]
            assert sum(len(block["/pack.volts"].values) for block in source.columns(["/pack.volts"], 0) or ()) == 3000
        with open_source(path) as source, pytest.raises(SourceError, match=r"has no field 'faults.code'") as raised:
            list(source.samples(["/pack.faults.code"]))
        assert "\n" not in str(raised.value)
    values = [block["/pack"].values["fault.code"] for block in read_columns(path, ["/pack.fault.code"])]
    assert [one for some in values for one in some.tolist() if not math.isnan(one)] == [7.5]


def test_files_of_a_drive_have_the_fields_of_all(tmp_path: Path) -> None:
    for number, field in enumerate(("volts", "amps", "volts")):
        raws = [json.dumps({field: step + 0.5}).encode() for step in range(30)]
        write(tmp_path / f"{number}.mcap", "json", raws, first=T0 + number * 60 * SECOND)
    with Recording(*sorted(tmp_path.iterdir())) as source:
        (info,) = source.topics()
        assert info.fields == ("volts", "amps")
        for field, count in (("volts", 60), ("amps", 30)):
            values = [one.value for one in source.samples([f"/pack.{field}"]) if not math.isnan(one.value)]
            assert values == [step + 0.5 for _ in range(count // 30) for step in range(30)]


def test_a_field_of_several_kinds_is_a_number_where_it_is_one(tmp_path: Path) -> None:
    each = [{"level": "low", "odd": {"a": 1}}, {"level": 3, "odd": 2}, {"level": True}, {"level": "high"}, {"level": 4}]
    path = write(tmp_path / "drive.mcap", "json", [json.dumps(one).encode() for one in each])
    with open_source(path) as source:
        assert source.topics()[0].fields == ("level", "odd.a")
        values = [one.value for one in source.samples(["/pack.level"])]
    assert [one for one in values if not math.isnan(one)] == [3, 1, 4]
    assert len(values) == len(each)


def test_an_array_that_is_something_else_costs_itself(tmp_path: Path) -> None:
    """A tag or a simple value that nobody has assigned, bytes, a text, a number, nothing."""
    each = [cbor2.CBORTag(7, 1), cbor2.CBORSimpleValue(11), b"12", "12", 1.5, None, {"1": 2}]
    raws = [cbor2.dumps({"many": one, "v": 1.5}) for one in ([1, 2], *each)]
    number = {"type": "number"}
    schema = {"properties": {"many": {"type": "array", "items": number}, "v": number}}
    with open_source(write(tmp_path / "drive.mcap", "cbor", raws, json.dumps(schema).encode())) as source:
        found = [(one.signal, one.value) for one in source.samples(["/pack.many[1]", "/pack.v"])]
    assert [value for signal, value in found if signal == "/pack.v"] == [1.5] * len(raws)
    assert [value for signal, value in found if signal != "/pack.v" and not math.isnan(value)] == [2]


def test_a_message_that_is_no_object_is_its_value(tmp_path: Path) -> None:
    path = write(tmp_path / "drive.mcap", "json", [b"1.5", b"2.5"])
    with open_source(path) as source:
        assert [one.value for one in source.samples(["/pack.value"])] == [1.5, 2.5]


RFC_8949 = {
    "00": 0, "1818": 24, "1903e8": 1000, "1a000f4240": 1e6, "1b000000e8d4a51000": 1e12, "1bffffffffffffffff": 2.0**64,
    "c249010000000000000000": 2.0**64, "3bffffffffffffffff": -(2.0**64), "3903e7": -1000, "f98000": -0.0,
    "f93c00": 1.0, "fb3ff199999999999a": 1.1, "f97bff": 65504.0, "fa47c35000": 100000.0, "fb7e37e43c8800759c": 1e300,
    "f90001": 5.960464477539063e-8, "f9c400": -4.0, "fbc010666666666666": -4.1, "f97c00": math.inf, "f4": 0, "f5": 1,
}  # fmt: skip
"""Numbers that the specification prints, in its appendix A."""


def test_numbers_of_cbor_are_those_that_its_specification_prints(tmp_path: Path) -> None:
    raws = [b"\xa1\x61v" + bytes.fromhex(one) for one in RFC_8949]
    with open_source(write(tmp_path / "drive.mcap", "cbor", raws)) as source:
        assert [one.value for one in source.samples(["/pack.v"])] == [*RFC_8949.values()]


def test_of_cbor_what_has_other_keys_or_tags_is_no_number(tmp_path: Path) -> None:
    """And does not cost the numbers beside it."""
    tags = [cbor2.CBORTag(tag, one) for tag, one in ((1, 1.5e9), (4, [-1, 15]), (30, [1, 2]), (258, [1, 2]), (999, 1))]
    told = cbor2.CBORTag(55799, {1: 2.0, (1, 2): 3.0, "tags": tags, "v": 4.5})
    path = write(tmp_path / "drive.mcap", "cbor", [cbor2.dumps(told)])
    assert recorded_topics(path)["/pack"][1] == ("v",)
    with open_source(path) as source:
        assert [one.value for one in source.samples(["/pack.v"])] == [4.5]


MESSAGE_PACK = {
    "7f": 127, "e0": -32, "cc80": 128, "cdffff": 65535, "ceffffffff": 2**32 - 1, "cfffffffffffffffff": 2.0**64,
    "d080": -128, "d18000": -(2**15), "d280000000": -(2**31), "d38000000000000000": -(2.0**63), "c2": 0, "c3": 1,
    "ca3fc00000": 1.5, "cb7e37e43c8800759c": 1e300, "cb3ff199999999999a": 1.1, "ca7f800000": math.inf,
}  # fmt: skip
"""A number of each of its formats, as its specification says that they lie; the floats are those of RFC 8949."""


def test_numbers_of_message_pack_are_those_that_its_specification_says(tmp_path: Path) -> None:
    raws = [b"\x81\xa1v" + bytes.fromhex(one) for one in MESSAGE_PACK]
    with open_source(write(tmp_path / "drive.mcap", "msgpack", raws)) as source:
        assert [one.value for one in source.samples(["/pack.v"])] == [*MESSAGE_PACK.values()]


def one_hash(number: int) -> bytes:
    """A key of CBOR, all of which have the same hash in Python, and its value."""
    return b"\x1b" + struct.pack(">Q", number * (2**61 - 1) % 2**64) + b"\x01"


HOSTILE = {
    "cbor": {
        "cut": cbor2.dumps({"v": [1.0] * 9})[:-3],
        "deep": b"\xa1\x61v" + b"\x81" * 100_000,
        "claims": b"\xa1\x61v\x9b\x00\x00\x00\xff\xff\xff\xff\xff\x01",
        "shared": b"\xa1\x61v\x82\xd8\x1c\x81\x01\xd8\x1d\x00",
        "a number of a thousand bytes": b"\xa1\x61v\xc2\x59\x03\xe8" + b"\x01" * 1000,
        "a power of two": b"\xa1\x61v\xc5\x82\x1b\x00\x00\x00\xff\xff\xff\xff\xff\x01",
        "keys that are none": b"\xa2\x01\x02\xf6\x03",
        "keys of one hash": b"\xba\x00\x00\xea\x60" + b"".join(map(one_hash, range(60_000))),
        "a set of one hash": b"\xa1\x61v\xd9\x01\x02\x9a\x00\x00\xea\x60"
        + b"".join(one_hash(n)[:-1] for n in range(60_000)),
        "a decimal fraction": b"\xa1\x61v\xc4\x82\x00\xc2\x5a\x00\x0f\x42\x40" + b"\x7b" * 1_000_000,
        "a pattern": b"\xa1\x61v\xd8\x23\x7a\x00\x0f\x42\x40" + b"[a-z]|(" * 142_857 + b"a",
        "nothing": b"",
    },
    "msgpack": {
        "cut": msgpack.packb({"v": [1.0] * 9})[:-3],
        "deep": b"\x81\xa1v" + b"\x91" * 100_000,
        "claims": b"\x81\xa1v\xdd\xff\xff\xff\xff\x01",
        "a time": b"\x81\xa1v\xd6\xff\x00\x00\x00\x01",
        "a type of its own": b"\x81\xa1v\xd4\x05\x01",
        "keys that are none": b"\x83\x01\x02\xc0\x03\x90\x04",
        "keys of one hash": b"\xde\xea\x60"
        + b"".join(msgpack.packb(n * (2**61 - 1) % 2**64) + b"\x01" for n in range(60_000)),
        "no text": b"\x81\xa1\xff\x01",
        "two": b"\x81\xa1v\x01\x81\xa1v\x02",
        "nothing": b"",
    },
}


@pytest.mark.parametrize(("encoding", "what"), [(one, what) for one, some in HOSTILE.items() for what in some])
@pytest.mark.parametrize("place", [0, 1])
def test_messages_that_are_none_cost_themselves(tmp_path: Path, encoding: str, what: str, place: int) -> None:
    raws = [ENCODERS[encoding]({"v": 1.5}), ENCODERS[encoding]({"v": 2.5})]
    path = write(tmp_path / "drive.mcap", encoding, [*raws[:place], HOSTILE[encoding][what], *raws[place:]])
    with open_source(path) as source:
        found = [one.value for one in source.samples(["/pack.v"])]
    assert [one for one in found if math.isfinite(one)] == [1.5, 2.5]
    (block,) = read_columns(path, ["/pack.v"])
    values = block["/pack"].values["v"]
    assert [one for one in values.tolist() if math.isfinite(one)] == [1.5, 2.5]


def test_a_topic_of_which_no_message_says_a_field_says_so(tmp_path: Path) -> None:
    path = write(tmp_path / "drive.mcap", "json", [b"{", b"", b"\xff"])
    with Recording(path) as source:
        assert source.topics()[0].fields == ()
        assert source.undecoded()["/pack"].startswith("has no schema, and no message that was looked into says")


@pytest.mark.parametrize(("encoding", "library"), [("cbor", "cbor2"), ("msgpack", "msgpack")])
def test_without_the_library_it_is_said_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: str, library: str
) -> None:
    path = write(tmp_path / "drive.mcap", encoding, [ENCODERS[encoding]({"v": 1.5})])
    monkeypatch.setitem(sys.modules, library, None)
    with Recording(path) as source:
        said = source.undecoded()["/pack"]
    assert said == f"needs {library}; install it with `pip install 'robophm[{encoding}]'`"
