"""MCAP with messages in JSON and in Protocol Buffers: every number as mcap's own libraries decode it."""

from __future__ import annotations

import importlib
import json
import math
import pkgutil
import random
import struct
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import foxglove_schemas_protobuf as foxglove
import numpy as np
import pytest
from foxglove_schemas_protobuf.JointStates_pb2 import JointStates
from foxglove_schemas_protobuf.LaserScan_pb2 import LaserScan
from foxglove_schemas_protobuf.Log_pb2 import Log
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory
from mcap_protobuf.writer import Writer as ProtobufWriter

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, bracketed
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals import protobuf_messages

T0 = 1_750_000_000 * SECOND
WHOLE = {
    "int32": 31,
    "sint32": 31,
    "sfixed32": 31,
    "uint32": 32,
    "fixed32": 32,
    "int64": 63,
    "uint64": 64,
    "fixed64": 64,
}


def foxglove_types() -> list[Any]:
    """Foxglove's types of messages, one of each module."""
    found = []
    for module in sorted(one.name for one in pkgutil.iter_modules(foxglove.__path__) if one.name.endswith("_pb2")):
        types = importlib.import_module(f"foxglove_schemas_protobuf.{module}")
        found.append(getattr(types, module.removesuffix("_pb2")))
    return [one for one in found if hasattr(one, "DESCRIPTOR") and hasattr(one, "FromString")]


def filled(type_: Any, chance: random.Random) -> Any:
    """A message with any values; now and then a field is missing."""
    message = type_()
    for field in type_.DESCRIPTOR.fields:
        if chance.random() < 0.2:
            continue
        if field.message_type:
            for _ in range(2):
                inner = filled(field.message_type._concrete_class, chance)
                if not field.is_repeated:
                    getattr(message, field.name).CopyFrom(inner)
                    break
                getattr(message, field.name).add().CopyFrom(inner)
            continue
        kind = {number: name for name, number in descriptor_pb2.FieldDescriptorProto.Type.items()}[field.type][
            5:
        ].lower()
        made = [value(field, kind, chance) for _ in range(3)]
        if field.is_repeated:
            getattr(message, field.name).extend(made)
        else:
            setattr(message, field.name, made[0])
    return message


def value(field: Any, kind: str, chance: random.Random) -> Any:
    if kind in WHOLE:
        return chance.randrange(1 << WHOLE[kind])
    if kind == "enum":
        return chance.choice(field.enum_type.values).number
    return {"string": "some", "bytes": b"some", "bool": True}.get(
        kind, chance.choice([chance.uniform(-9, 9), math.inf])
    )


def numbers(message: Any, prefix: str = "") -> Iterator[tuple[str, float]]:
    """Every number in a message of Protocol Buffers, by the path of its field."""
    for field in message.DESCRIPTOR.fields:
        known = getattr(message, field.name)
        each = list(enumerate(known)) if field.is_repeated else [(None, known)]
        if field.has_presence and not message.HasField(field.name):
            continue
        for index, one in each:
            path = f"{prefix}{field.name}" + ("" if index is None else f"[{index}]")
            if field.message_type:
                yield from numbers(one, f"{path}.")
            elif isinstance(one, int | float):
                yield path, float(one)


def write_protobuf(path: Path, messages: Mapping[str, Sequence[Any]]) -> Path:
    with path.open("wb") as file, ProtobufWriter(file) as writer:
        for topic, each in messages.items():
            for step, message in enumerate(each):
                writer.write_message(topic, message, T0 + step * SECOND, T0 + step * SECOND)
    return path


def write_json(path: Path, schema: Any, messages: Sequence[bytes], topic: str = "/battery") -> Path:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        known = schema if isinstance(schema, bytes) else json.dumps(schema).encode()
        number = writer.register_schema("pack.Battery", "jsonschema", known) if known else 0
        channel = writer.register_channel(topic, "json", number)
        for step, raw in enumerate(messages):
            writer.add_message(channel, T0 + step * SECOND, raw, T0 + step * SECOND)
        writer.finish()
    return path


@pytest.mark.full
def test_every_number_of_every_type_of_foxglove_is_as_mcap_reads_it(tmp_path: Path) -> None:
    chance = random.Random(7)
    types = foxglove_types()
    made = {f"/{one.DESCRIPTOR.name}": [filled(one, chance) for _ in range(2)] for one in types}
    path = write_protobuf(tmp_path / "drive.mcap", made)
    expected: dict[str, list[float]] = {}
    with path.open("rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            for field, number in numbers(message):
                expected.setdefault(f"{channel.topic}.{field}", []).append(number)
    with open_source(path) as source:
        known = {f"{info.topic}.{field}" for info in source.topics() for field in info.fields}
        found: dict[str, list[float]] = {}
        for one in source.samples(expected):
            if not math.isnan(one.value):
                found.setdefault(one.signal, []).append(one.value)
    assert {name: np.array(each).tobytes() for name, each in found.items()} == {
        name: np.array(each).tobytes() for name, each in expected.items()
    }
    assert len(types) > 40
    assert len(expected) > 500
    columns: dict[str, list[float]] = {}
    for block in read_columns(path, expected):
        for topic, part in block.items():
            for field, each in part.values.items():
                columns.setdefault(f"{topic}.{field}", []).extend(each[~np.isnan(each)].tolist())
    assert {name: each for name, each in columns.items() if each} == found
    assert known >= {"/JointStates.joints[].effort", "/LaserScan.ranges[]", "/Log.level"}


def test_the_time_of_a_sample_is_the_one_that_the_message_says(tmp_path: Path) -> None:
    scan = LaserScan(ranges=[1.0, 2.0])
    scan.timestamp.seconds, scan.timestamp.nanos = T0 // SECOND, 250
    path = write_protobuf(tmp_path / "drive.mcap", {"/scan": [scan, LaserScan(ranges=[3.0])]})
    with open_source(path) as source:
        assert [one[::2] for one in source.samples(["/scan.ranges[0]"])] == [(T0 + 250, 1.0), (T0 + SECOND, 3.0)]
        assert source.notes["receipt time used for /scan"] == 1
    (block,) = read_columns(path, ["/scan.ranges[0]"])
    assert block["/scan"].times.tolist() == [T0 + 250, T0 + SECOND]


def test_elements_have_the_names_that_messages_give_them(tmp_path: Path) -> None:
    message = JointStates()
    for name, effort in (("pan", 1.5), ("lift", 2.5)):
        message.joints.add(name=name, effort=effort)
    path = write_protobuf(tmp_path / "drive.mcap", {"/joints": [message]})
    with Recording(path) as source:
        assert [one.value for one in source.samples(["/joints.joints[lift].effort"])] == [2.5]
        assert source.names()["/joints"]["joints[]"] == ["pan", "lift"]


SCHEMA = {
    "type": "object",
    "definitions": {"cell": {"type": "object", "properties": {"volts": {"type": "number"}}}},
    "properties": {
        "timestamp": {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}},
        "voltage": {"type": ["number", "null"]},
        "charging": {"type": "boolean"},
        "serial": {"type": "string"},
        "cells": {"type": "array", "items": {"$ref": "#/definitions/cell"}},
        "readings": {"type": "array", "items": {"type": "number"}},
        "either": {"oneOf": [{"type": "number"}, {"type": "string"}]},
        "class": {"type": "integer"},
        "not a name": {"type": "number"},
    },
}


def test_numbers_in_json_are_what_json_says(tmp_path: Path) -> None:
    chance, each = random.Random(3), []
    for step in range(5):
        cells = [{"volts": chance.random()} for _ in range(3)]
        when = {"sec": T0 // SECOND + step, "nsec": 7}
        each.append({"timestamp": when, "voltage": chance.random(), "charging": step > 2, "serial": "7", "cells": cells,
                     "readings": [chance.random(), None], "either": 1, "class": 2**40 + step})  # fmt: skip
    path = write_json(tmp_path / "drive.mcap", SCHEMA, [json.dumps(one).encode() for one in each])
    ways = {
        "voltage": lambda one: one["voltage"], "charging": lambda one: one["charging"],
        "cells[2].volts": lambda one: one["cells"][2]["volts"], "readings[0]": lambda one: one["readings"][0],
        "class": lambda one: one["class"],
    }  # fmt: skip
    with open_source(path) as source:
        (info,) = source.topics()
        assert info.fields == (
            "timestamp.sec", "timestamp.nsec", "voltage", "charging", "cells[].volts", "readings[]", "class",
        )  # fmt: skip
        for field, way in ways.items():
            found = list(source.samples([f"/battery.{field}"]))
            assert [one.value for one in found] == [float(way(one)) for one in each]
            assert [one.time for one in found] == [T0 + step * SECOND + 7 for step in range(5)]
        assert all(math.isnan(one.value) for one in source.samples(["/battery.readings[1]"]))


ODD = {
    "no object": b"[1, 2]",
    "cut": b'{"voltage": 1',
    "deep": b'{"voltage":' + b"[" * 100_000,
    "no text": b"\xff\xfe",
    "long number": b'{"voltage": 1' + b"0" * 5000 + b"}",
    "other types": b'{"voltage": "high", "cells": 7, "readings": {"a": 1}, "timestamp": [1], "class": 1e400}',
    "a wrong time": b'{"timestamp": {"sec": 1e300, "nsec": "x"}, "voltage": null}',
    "nothing": b"{}",
}


@pytest.mark.parametrize("raw", ODD.values(), ids=ODD)
def test_messages_that_are_no_json_or_other_than_their_schema_cost_themselves(tmp_path: Path, raw: bytes) -> None:
    path = write_json(tmp_path / "drive.mcap", SCHEMA, [b'{"voltage": 1.5}', raw, b'{"voltage": 2.5}'])
    signals = ["/battery.voltage", "/battery.readings[0]", "/battery.cells[0].volts", "/battery.class"]
    with open_source(path) as source:
        found = [one.value for one in source.samples(signals) if one.signal == signals[0]]
    assert [one for one in found if math.isfinite(one)] == [1.5, 2.5]
    (block,) = read_columns(path, signals)
    values = block["/battery"].values["voltage"]
    assert values[np.isfinite(values)].tolist() == [1.5, 2.5]


WRONG = {
    "no json": (b"{", "its JSON Schema is none"),
    "no object": (b"[]", "its JSON Schema is no object"),
    "itself": (b'{"type":"array","items":{"$ref":"#"},"properties":{"a":{"$ref":"#"}}}', "missing or damaged"),
    "doubling": (
        json.dumps(
            {"properties": {"a": {"$ref": "#/d/0"}},
             "d": {str(n): {"properties": {x: {"$ref": f"#/d/{n + 1}"} for x in "ab"}} for n in range(40)}}
        ).encode(),
        "over 2000 messages",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("schema", "says"), WRONG.values(), ids=WRONG)
def test_a_schema_that_names_no_numbers_is_said(tmp_path: Path, schema: bytes, says: str) -> None:
    path = write_json(tmp_path / "drive.mcap", schema, [b'{"voltage": 1.5}'])
    with open_source(path) as source:
        assert source.topics()[0].fields == ()
        with pytest.raises(SourceError, match=says) as raised:
            list(source.samples(["/battery.voltage"]))
    assert "\n" not in str(raised.value)


def test_other_encodings_say_why_they_have_no_numbers(tmp_path: Path) -> None:
    with (tmp_path / "drive.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        for encoding in ("flexbuffer", "flatbuffer", "protobuf"):
            writer.add_message(writer.register_channel(f"/{encoding}", encoding, 0), T0, b"x", T0)
        writer.finish()
    with Recording(tmp_path / "drive.mcap") as source:
        assert source.undecoded() == {
            "/flexbuffer": "is encoded as 'flexbuffer'; "
            "expected cdr, ros1, json, cbor, msgpack, protobuf or flatbuffer",
            "/flatbuffer": "the definition of its type '' is missing or damaged",
            "/protobuf": "the definition of its type '' is missing or damaged",
        }


def test_damaged_messages_and_schemas_of_protobuf_are_passed_by(tmp_path: Path) -> None:
    chance = random.Random(5)
    message = filled(LaserScan, chance)
    descriptors = descriptor_pb2.FileDescriptorSet()
    write_protobuf(tmp_path / "whole.mcap", {"/scan": [message]})
    with (tmp_path / "whole.mcap").open("rb") as file:
        (schema, _, raw) = next(iter(make_reader(file).iter_messages()))
    assert schema is not None
    descriptors.ParseFromString(schema.data)
    path, read = tmp_path / "drive.mcap", 0
    for turn in range(60):
        known, told = bytearray(schema.data), bytearray(raw.data)
        broken = known if turn % 2 else told
        for _ in range(3):
            broken[chance.randrange(len(broken))] = chance.randrange(256)
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start()
            number = writer.register_schema(schema.name, "protobuf", bytes(known))
            channel = writer.register_channel("/scan", "protobuf", number)
            for data in (bytes(told), raw.data):
                writer.add_message(channel, T0, data, T0)
            writer.finish()
        try:
            with open_source(path) as source:
                read += len(list(source.samples(["/scan.start_angle"])))
        except SourceError as error:
            assert "\n" not in str(error)  # noqa: PT017
    assert read > 30


def test_a_type_within_itself_is_read_as_far_as_it_is_not(tmp_path: Path) -> None:
    file = descriptor_pb2.FileDescriptorProto(name="tree.proto", package="t", syntax="proto3")
    tree = file.message_type.add(name="Tree")
    tree.field.add(name="value", number=1, type=1, label=1)
    tree.field.add(name="left", number=2, type=11, label=1, type_name=".t.Tree")
    with (tmp_path / "drive.mcap").open("wb") as out:
        writer = Writer(out)
        writer.start()
        schema = descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()
        channel = writer.register_channel("/tree", "protobuf", writer.register_schema("t.Tree", "protobuf", schema))
        writer.add_message(channel, T0, b"\x09" + np.float64(2.5).tobytes() + b"\x12\x00", T0)
        writer.finish()
    with open_source(tmp_path / "drive.mcap") as source:
        assert source.topics()[0].fields == ("value",)
        assert [one.value for one in source.samples(["/tree.value"])] == [2.5]


def test_elements_of_a_map_have_the_names_of_their_keys(tmp_path: Path) -> None:
    """Of both kinds of values and all three of keys, as the library of Protocol Buffers itself writes them."""
    file = descriptor_pb2.FileDescriptorProto(name="pack.proto", package="p", syntax="proto3")
    file.message_type.add(name="Cell").field.add(name="volts", number=1, type=1, label=1)
    pack = file.message_type.add(name="Pack")
    kinds = {"torque": (9, 1, None), "cells": (5, 11, ".p.Cell"), "on": (8, 3, None)}
    for number, (name, (key, value, type_)) in enumerate(kinds.items(), 1):
        entry = pack.nested_type.add(name=f"{name.capitalize()}Entry")
        entry.options.map_entry = True
        entry.field.add(name="key", number=1, type=key, label=1)
        entry.field.add(name="value", number=2, type=value, label=1, type_name=type_)
        pack.field.add(name=name, number=number, type=11, label=3, type_name=f".p.Pack.{entry.name}")
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    message = message_factory.GetMessageClass(pool.FindMessageTypeByName("p.Pack"))()
    torque = {"elbow": 1.5, "wrist.left": -2.5, "7": 3.5}
    message.torque.update(torque)
    message.cells[-3].volts, message.cells[12].volts = 4.1, 4.2
    message.on[True] = 2**40
    path = write_protobuf(tmp_path / "drive.mcap", {"/pack": [message, type(message)(torque={"elbow": 9.0})]})
    wanted = {
        **{f"torque[{bracketed(name)}].value": value for name, value in torque.items()},
        "cells[-3].value.volts": 4.1, "cells['12'].value.volts": 4.2, "on[true].value": 2.0**40,
    }  # fmt: skip
    with Recording(path) as source:
        assert source.topics()[0].fields == ("torque[].value", "cells[].value.volts", "on[].value")
        names = {"torque[]": sorted(torque), "cells[]": ["-3", "12"], "on[]": ["true"]}
        assert source.names()["/pack"] == names
        found = {one.signal: one.value for one in source.samples([f"/pack.{field}" for field in wanted])}
    assert found == {f"/pack.{field}": value for field, value in (wanted | {"torque[elbow].value": 9.0}).items()}


@pytest.mark.full
def test_a_map_whose_keys_have_one_hash_takes_no_longer_than_others() -> None:
    """Of a message in which the library's own maps would compare each of 20,000 keys with all before it."""
    file = descriptor_pb2.FileDescriptorProto(name="map.proto", package="p", syntax="proto3")
    pack = file.message_type.add(name="Pack")
    entry = pack.nested_type.add(name="VEntry")
    entry.options.map_entry = True
    entry.field.add(name="key", number=1, type=6, label=1)
    entry.field.add(name="value", number=2, type=1, label=1)
    pack.field.add(name="v", number=1, type=11, label=3, type_name=".p.Pack.VEntry")
    described = protobuf_messages.described("p.Pack", descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString())

    def taken(keys: list[int]) -> float:
        pairs = (b"\x0a\x12\x09" + struct.pack("<Q", key) + b"\x11" + struct.pack("<d", 0.5) for key in keys)
        raw = b"".join(pairs)
        times = []
        for _ in range(3):  # the machine may be busy with other things for one of them
            begun = time.process_time()
            assert len(described.decode(raw).v) == len(keys)
            times.append(time.process_time() - begun)
        return min(times)

    count = 20_000
    others = [key << 1 for key in range(count)]
    assert taken([key << 32 | key for key in range(count)]) < 4 * taken(others)


def test_without_protobuf_it_is_said_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_protobuf(tmp_path / "drive.mcap", {"/log": [Log(line=3)]})
    monkeypatch.setitem(sys.modules, "google.protobuf", None)
    from robophm.transports.signals import message_type

    message_type._described_type.cache_clear()
    with open_source(path) as source, pytest.raises(SourceError, match=r"needs protobuf; install it with `pip install"):
        list(source.samples(["/log.line"]))
    message_type._described_type.cache_clear()
