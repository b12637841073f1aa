"""Messages that are not of ROS, each damaged for itself in a sound MCAP file, and what their own libraries read."""

from __future__ import annotations

import importlib
import io
import json
import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from robophm.transports.signals.json_messages import LONGEST_WITH_OTHER_KEYS

from .seeds import SECOND, STEPS, T0

FORMATS = ("json message", "cbor message", "msgpack message", "protobuf message", "flatbuffer message")

DAMAGED = 6
"""Messages of a file that are damaged."""

Numbers = list[float]
"""Numbers of wanted fields, NaN where there is none."""


@dataclass(frozen=True)
class Encoding:
    """A way in which messages are written, and the library that reads them."""

    encoding: str
    schema_encoding: str
    type: str
    schema: bytes
    fields: tuple[str, ...]
    sound: tuple[bytes, ...]
    reader: Callable[[bytes], Callable[[bytes], Numbers] | None]
    """Of a schema, which may be damaged, what makes numbers of a message; none where nobody reads by it."""


@dataclass(frozen=True)
class Told:
    """What a file holds: messages a second apart, and their schema."""

    of: Encoding
    schema: bytes
    raws: tuple[bytes, ...]
    sound: bool
    """Whether the schema is as it was."""


def encoding(format_: str) -> Encoding:
    """The encoding of this format."""
    return {"json": _json, "cbor": _cbor, "msgpack": _msgpack, "protobuf": _protobuf, "flatbuffer": _flatbuffer}[
        format_.split()[0]
    ]()


def mcap(told: Told) -> bytes:
    """The file, written by the library mcap."""
    from mcap.writer import CompressionType, Writer

    file = io.BytesIO()
    writer = Writer(file, compression=CompressionType.NONE)
    writer.start()
    schema = writer.register_schema(told.of.type, told.of.schema_encoding, told.schema) if told.of.schema else 0
    channel = writer.register_channel("/a", told.of.encoding, schema)
    for step, raw in enumerate(told.raws):
        writer.add_message(channel, T0 + step * SECOND, raw, T0 + step * SECOND)
    writer.finish()
    return file.getvalue()


def damaged(format_: str, chance: random.Random) -> tuple[str, Told]:
    """What was done, and a file of which some messages, or the schema, are damaged."""
    one = encoding(format_)
    if one.schema and chance.random() < 0.25:
        how, schema = _changed(one.schema, (one.schema,), chance)
        return f"schema {how}", Told(one, schema, one.sound, False)
    raws, done = list(one.sound), []
    for step in chance.sample(range(len(raws)), DAMAGED):
        how, raws[step] = _changed(raws[step], one.sound, chance)
        done.append(how)
    return " ".join(done), Told(one, one.schema, tuple(raws), True)


def _changed(raw: bytes, others: Sequence[bytes], chance: random.Random) -> tuple[str, bytes]:
    """Bytes changed one to four times: whatever lies there, a length and a kind of value among it."""
    content, how = bytearray(raw), ""
    for _ in range(chance.choice([1, 1, 1, 2, 4])):
        how = chance.choice([*_WAYS])
        _WAYS[how](content, chance.choice(others), chance)
    return how, bytes(content)


def _bit(content: bytearray, _: bytes, chance: random.Random) -> None:
    if content:
        content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)


def _byte(content: bytearray, _: bytes, chance: random.Random) -> None:
    if content:
        content[chance.randrange(len(content))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, chance.randrange(256)])


def _word(content: bytearray, _: bytes, chance: random.Random) -> None:
    at, size = chance.randrange(len(content) + 1), chance.choice([2, 4, 8])
    lie = chance.choice([0, 1, 2**15, 2**31 - 1, 2**31, 2**32 - 1, 2**63, len(content), chance.getrandbits(32)])
    content[at : at + size] = (lie % 2 ** (8 * size)).to_bytes(size, chance.choice(["little", "big"]))


def _cut(content: bytearray, _: bytes, chance: random.Random) -> None:
    del content[chance.randrange(len(content) + 1) :]


def _without(content: bytearray, _: bytes, chance: random.Random) -> None:
    at = chance.randrange(len(content) + 1)
    del content[at : at + chance.choice([1, 2, 4, 9])]


def _twice(content: bytearray, _: bytes, chance: random.Random) -> None:
    at = chance.randrange(len(content) + 1)
    content[at:at] = content[at : at + chance.choice([1, 4, 9, 40])] * chance.choice([1, 1, 2, 300])


def _joined(content: bytearray, other: bytes, chance: random.Random) -> None:
    content[chance.randrange(len(content) + 1) :] = other[chance.randrange(len(other) + 1) :]


def _letter(content: bytearray, _: bytes, chance: random.Random) -> None:
    """Something that means something in one of the encodings."""
    at = chance.randrange(len(content) + 1)
    word = chance.choice([b"[", b"{", b"]", b"}", b'"', b",", b":", b"null", b"NaN", b"1e999", b"-", b"1" * 400,
                          b"\\ud800", b"\xbf", b"\x9f", b"\xff", b"\xc2", b"\xc3", b"\xd8\x1c", b"\xc1", b"\xdf",
                          b"\xd9\x01\x02", b"\xf9\x7e\x00", b"\xc7\x05\x01", b"\x0a\x00", b"\x0b", b"\x0c", b"\x99" * 9,
                          b"[" * 3000, b"\x81" * 3000, b"\x91" * 3000])  # fmt: skip
    content[at : at + chance.choice([0, len(word)])] = word


_WAYS = {"bit": _bit, "byte": _byte, "word": _word, "cut": _cut, "without": _without, "twice": _twice,
         "joined": _joined, "letter": _letter}  # fmt: skip


# Encodings

_FIELDS = ("x", "deep.y", "list[1]", "parts[1].z", "flag")


def _plain() -> Iterator[dict[str, Any]]:
    for step in range(STEPS):
        yield {"x": step / 4, "deep": {"y": 2**40 + step, "note": "n" * step}, "list": [0.5 * step, step, -step],
               "parts": [{"name": "p", "z": one + step} for one in range(3)], "flag": step % 2 == 0,
               "nothing": None}  # fmt: skip


def _number(message: Any, field: str) -> float:
    """The number at the path of a field in what a library decoded."""
    for part in field.split("."):
        name, _, index = part.partition("[")
        message = message.get(name) if isinstance(message, Mapping) else None
        if index:
            at = int(index.rstrip("]"))
            message = (
                message[at]
                if isinstance(message, Sequence) and not isinstance(message, str | bytes) and at < len(message)
                else None
            )
    if isinstance(message, int):
        return float(message) if message.bit_length() < 1024 else math.copysign(math.inf, message)
    return message if isinstance(message, float) else math.nan


def _reads(loads: Callable[[bytes], Any]) -> Callable[[bytes], Callable[[bytes], Numbers]]:
    def read(raw: bytes) -> Numbers:
        message = loads(raw)
        return [_number(message, field) for field in _FIELDS]

    return lambda _: read


_NUMBER = {"type": "number"}
_SCHEMA = {
    "type": "object",
    "properties": {
        "x": _NUMBER,
        "deep": {"type": "object", "properties": {"y": {"type": "integer"}, "note": {"type": "string"}}},
        "list": {"type": "array", "items": _NUMBER},
        "parts": {"type": "array", "items": {"type": "object", "properties": {"z": _NUMBER}}},
        "flag": {"type": "boolean"},
    },
}


@cache
def _json() -> Encoding:
    def loads(raw: bytes) -> Any:
        return json.loads(raw, parse_int=float)  # Python refuses to make whole numbers of over 4,300 digits

    sound = tuple(json.dumps(one).encode() for one in _plain())
    return Encoding("json", "jsonschema", "a", json.dumps(_SCHEMA).encode(), _FIELDS, sound, _reads(loads))


@cache
def _cbor() -> Encoding:
    import cbor2

    def refuse(*_: Any) -> Any:
        raise ValueError("a part that is there twice")

    tags: dict[int, Any] = dict.fromkeys(
        (0, 1, 4, 5, 30, 35, 36, 37, 52, 54, 100, 258, 260, 261, 1004, 43000), lambda *_: None
    )
    tags |= {28: refuse, 29: refuse}  # what other tags mean plays no part, and may be refused

    def loads(raw: bytes) -> Any:
        return cbor2.loads(raw, semantic_decoders=tags, strict_hashable_types=len(raw) > LONGEST_WITH_OTHER_KEYS)

    return Encoding("cbor", "", "", b"", _FIELDS, tuple(cbor2.dumps(one) for one in _plain()), _reads(loads))


@cache
def _msgpack() -> Encoding:
    import msgpack

    def loads(raw: bytes) -> Any:
        return msgpack.unpackb(raw, strict_map_key=False)

    return Encoding("msgpack", "", "", b"", _FIELDS, tuple(msgpack.packb(one) for one in _plain()), _reads(loads))


@cache
def _protobuf() -> Encoding:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    file = descriptor_pb2.FileDescriptorProto(name="a.proto", package="a", syntax="proto3")
    message = file.message_type.add(name="A")
    part, deep, entry = (message.nested_type.add(name=name) for name in ("Part", "Deep", "AxesEntry"))
    part.field.add(name="z", number=1, type=2, label=1)
    deep.field.add(name="y", number=1, type=3, label=1)
    deep.field.add(name="note", number=2, type=9, label=1)
    entry.options.map_entry = True
    entry.field.add(name="key", number=1, type=5, label=1)
    entry.field.add(name="value", number=2, type=1, label=1)
    for number, (name, type_, many, within) in enumerate(
        (("x", 1, False, None), ("deep", 11, False, ".a.A.Deep"), ("list", 1, True, None),
         ("parts", 11, True, ".a.A.Part"), ("flag", 8, False, None), ("axes", 11, True, ".a.A.AxesEntry")), 1
    ):  # fmt: skip
        message.field.add(name=name, number=number, type=type_, label=3 if many else 1, type_name=within)
    schema = descriptor_pb2.FileDescriptorSet(file=[file]).SerializeToString()

    def class_of(known: bytes) -> Any:
        pool = descriptor_pool.DescriptorPool()
        for one in descriptor_pb2.FileDescriptorSet.FromString(known).file:
            pool.Add(one)
        return message_factory.GetMessageClass(pool.FindMessageTypeByName("a.A"))

    def reader(known: bytes) -> Callable[[bytes], Numbers]:
        type_ = class_of(known)

        def read(raw: bytes) -> Numbers:
            told = type_.FromString(raw)
            many = [float(told.list[1])] if len(told.list) > 1 else [math.nan]
            many += [float(told.parts[1].z)] if len(told.parts) > 1 else [math.nan]
            axis = float(told.axes[-3]) if -3 in told.axes else math.nan
            deep = float(told.deep.y) if told.HasField("deep") else math.nan
            return [told.x, deep, *many, float(told.flag), axis]

        return read

    type_ = class_of(schema)
    sound = []
    for one in _plain():
        parts = [{"z": each["z"]} for each in one["parts"]]
        axes = {-3: one["x"], 7: 1.0}
        told = type_(x=one["x"], deep=one["deep"], list=one["list"], parts=parts, flag=one["flag"], axes=axes)
        sound.append(told.SerializeToString())
    return Encoding("protobuf", "protobuf", "a.A", schema, (*_FIELDS, "axes[-3].value"), tuple(sound), reader)


@cache
def _flatbuffer() -> Encoding:
    """Foxglove's type LaserScan, with tables in tables, numbers and a text."""
    import flatbuffers
    import foxglove_schemas_flatbuffer as foxglove

    scan, pose, vector = (
        importlib.import_module(f"foxglove_schemas_flatbuffer.{name}") for name in ("LaserScan", "Pose", "Vector3")
    )
    sound = []
    for step in range(STEPS):
        builder = flatbuffers.Builder(0)
        vector.Start(builder)
        vector.AddX(builder, step / 4)
        place = vector.End(builder)
        pose.Start(builder)
        pose.AddPosition(builder, place)
        stands = pose.End(builder)
        frame = builder.CreateString("base" * step)
        scan.StartRangesVector(builder, 5)
        for one in range(5):
            builder.PrependFloat64(one + step / 8)
        ranges = builder.EndVector()
        scan.Start(builder)
        scan.AddFrameId(builder, frame)
        scan.AddPose(builder, stands)
        scan.AddStartAngle(builder, 1.0 + step)
        scan.AddRanges(builder, ranges)
        builder.Finish(scan.End(builder))
        sound.append(bytes(builder.Output()))
    schema = (Path(foxglove.__path__[0]) / "LaserScan.bfbs").read_bytes()

    def read(raw: bytes) -> Numbers:
        told = scan.LaserScan.GetRootAs(raw)
        position = told.Pose() and told.Pose().Position()
        x = float(position.X()) if position else math.nan
        return [float(told.StartAngle()), x, float(told.Ranges(1)) if told.RangesLength() > 1 else math.nan]

    fields = ("start_angle", "pose.position.x", "ranges[1]")
    return Encoding("flatbuffer", "flatbuffer", "foxglove.LaserScan", schema, fields, tuple(sound),
                    lambda known: read if known == schema else None)  # fmt: skip
