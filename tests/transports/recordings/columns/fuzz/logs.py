"""Small sound files of the formats that hold samples, and of messages that are not of ROS, and what is in them."""

from __future__ import annotations

import io
import json
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from . import messages
from .seeds import SECOND, STEPS, T0, Seed

Samples = dict[str, list[tuple[int, float]]]
"""By signal: time [ns] and value of each sample."""

FORMATS = ("bin", "tlog", "ulg", "csv", "parquet", "json", "cbor", "protobuf", "old bag")

COUNT, VALUES, ALL = "count", "values", "all"
"""What of a file one change cannot take away or alter unsaid: samples; values, by checksums; times too."""


@dataclass(frozen=True)
class LogSeed(Seed):
    """A sound file of samples, and what it holds."""

    samples: tuple[tuple[str, tuple[tuple[int, float], ...]], ...] = ()
    guard: str = ""
    """What of it is guarded; nothing of a table."""
    records: tuple[tuple[int, int], ...] = ()
    """Where its records begin and end."""
    numbers: tuple[tuple[int, int], ...] = ()
    """Where numbers lie that say where others lie, or when and whose they are."""

    @property
    def plain(self) -> bool:
        """Nothing of it is sealed anew."""
        return False


def seeds(format_: str) -> Iterator[LogSeed]:
    """The sound files of a format."""
    made = {"bin": _bin, "tlog": _tlog, "ulg": _ulg, "csv": _csv, "parquet": _parquet, "json": _json,
            "cbor": _cbor, "protobuf": _protobuf, "old bag": _old_bag}  # fmt: skip
    yield from made[format_]() if format_ in made else _messages(format_)


def _rows(*signals: str, step: int = SECOND, first: int = T0) -> tuple[tuple[str, tuple[tuple[int, float], ...]], ...]:
    """Whole numbers, which every format keeps, others for each signal."""
    return tuple(
        (signal, tuple((first + number * step, float(number + 100 * which)) for number in range(STEPS)))
        for which, signal in enumerate(signals)
    )


def _parts(parts: list[bytes]) -> tuple[bytes, tuple[tuple[int, int], ...]]:
    spans, at = [], 0
    for part in parts:
        spans.append((at, at + len(part)))
        at += len(part)
    return b"".join(parts), tuple(spans)


def _within(spans: tuple[tuple[int, int], ...], *places: tuple[int, int]) -> tuple[tuple[int, int], ...]:
    """Numbers at the same places of each record."""
    return tuple(
        (start + at, start + at + size) for start, end in spans for at, size in places if start + at + size <= end
    )


def _bin() -> Iterator[LogSeed]:
    from ....written.dataflash import defines, message

    kinds = {"FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns"), "BAT": (130, "Qff", "TimeUS,Volt,Curr"),
             "TEM": (131, "QdB", "TimeUS,T,I")}  # fmt: skip
    parts = [defines(number, name, letters, labels) for name, (number, letters, labels) in kinds.items()]
    first = 1_000_000_000
    for number in range(STEPS):
        stamp = (first + number * SECOND) // 1000
        parts += [message(130, "Qff", stamp, number, number + 100), message(131, "QdB", stamp, number + 200, 0)]
    content, spans = _parts(parts)
    numbers = _within(spans, (0, 1), (1, 1), (2, 1), (3, 8)) + _within(
        spans[:3], (3, 1), (4, 1), (5, 4), (9, 1), (10, 1)
    )
    yield LogSeed("", content, ".BIN", samples=_rows("/BAT.Volt", "/BAT.Curr", "/TEM.T", first=first), guard=COUNT,
                  records=spans, numbers=numbers)  # fmt: skip


def _tlog() -> Iterator[LogSeed]:
    from pymavlink.dialects.v20 import all as dialect

    from ....written.mavlink import sender

    for older in (False, True):
        by, parts = sender(), []
        for number in range(STEPS):
            time = struct.pack(">Q", (T0 + number * SECOND) // 1000)
            attitude = dialect.MAVLink_attitude_message(1, number, number + 100, 0, 0, 0, 0)
            parts += [time + attitude.pack(by, force_mavlink1=older)]
            parts += [time + dialect.MAVLink_named_value_float_message(1, b"lift", number + 200).pack(by)]
        content, spans = _parts(parts)
        signals = ("/ATTITUDE.roll", "/ATTITUDE.pitch", "/NAMED_VALUE_FLOAT_lift.value")
        places = [(0, 8), *((at, 1) for at in range(8, 19))]
        yield LogSeed("older" if older else "", content, ".tlog", samples=_rows(*signals), guard=VALUES, records=spans,
                      numbers=_within(spans, *places))  # fmt: skip


def _ulg() -> Iterator[LogSeed]:
    from ....written.ulog import data, head, listens

    begin = head("battery:uint64_t timestamp;double volt;double curr;", "temp:uint64_t timestamp;double t;")
    parts = [begin, listens(0, "battery"), listens(1, "temp")]
    first = 1_000_000_000
    for number in range(STEPS):
        stamp = (first + number * SECOND) // 1000
        parts += [data(0, "Qdd", stamp, number, number + 100), data(1, "Qd", stamp, number + 200)]
    content, spans = _parts(parts)
    numbers = _within(spans, (0, 2), (2, 1), (3, 2), (5, 8)) + tuple((at, at + 2) for at in range(16, len(begin), 7))
    yield LogSeed("", content, ".ulg", samples=_rows("/battery.volt", "/battery.curr", "/temp.t", first=first),
                  guard=COUNT, records=spans, numbers=numbers)  # fmt: skip


def _csv() -> Iterator[LogSeed]:
    for name, first, separator in (("", "time,/a.x,/a.y,/b.z", "."), ("plotjuggler", "__time,/a/x,/a/y,/b/z", ".")):
        samples = _rows("/a.x", "/a.y", "/b.z")
        lines = [first.encode() + b"\n"]
        for number in range(STEPS):
            values = [repr(own[number][1]) for _, own in samples]
            lines.append(f"{(T0 + number * SECOND) // SECOND}{separator}0,{','.join(values)}\n".encode())
        content, spans = _parts(lines)
        cells = tuple((at, at + 1) for at in range(len(content)) if content[at : at + 1] in b",.\n_/")
        yield LogSeed(name, content, ".csv", samples=samples, records=spans, numbers=cells)


def _parquet() -> Iterator[LogSeed]:
    import pyarrow as arrow
    from pyarrow import parquet

    samples = _rows("/a.x", "/a.y", "/b.z")
    times = arrow.array([time for time, _ in samples[0][1]], arrow.timestamp("ns", "UTC"))
    table = arrow.table({"time": times} | {signal: [value for _, value in own] for signal, own in samples})
    for compression in ("none", "zstd"):
        file = io.BytesIO()
        parquet.write_table(table, file, compression=compression, row_group_size=4)
        content = file.getvalue()
        windows = tuple((at, min(at + 64, len(content))) for at in range(0, len(content), 64))
        numbers = tuple((at, min(at + size, len(content))) for at in range(len(content) // 2, len(content), 5)
                        for size in (1, 4))  # fmt: skip
        yield LogSeed(compression, content, ".parquet", samples=samples, records=windows, numbers=numbers)


def _json() -> Iterator[LogSeed]:
    from mcap.writer import Writer

    samples = _rows("/a.x", "/a.deep.y", "/b.z")
    number = {"type": "number"}
    deep = {"type": "object", "properties": {"x": number, "deep": {"type": "object", "properties": {"y": number}}}}
    file = io.BytesIO()
    writer = Writer(file, chunk_size=300)
    writer.start()
    first = writer.register_schema("a", "jsonschema", json.dumps(deep).encode())
    second = writer.register_schema(
        "b", "jsonschema", json.dumps({"type": "object", "properties": {"z": number}}).encode()
    )
    channels = [writer.register_channel(topic, "json", schema) for topic, schema in (("/a", first), ("/b", second))]
    for (time, x), (_, y), (_, z) in zip(*(own for _, own in samples), strict=True):
        writer.add_message(channels[0], time, json.dumps({"x": x, "deep": {"y": y}}).encode(), time)
        writer.add_message(channels[1], time, json.dumps({"z": z}).encode(), time)
    writer.finish()
    yield LogSeed("zstd", file.getvalue(), ".mcap", samples=samples, guard=ALL)


def _cbor() -> Iterator[LogSeed]:
    """Of messages without a schema, in CBOR and in JSON."""
    import cbor2
    from mcap.writer import Writer

    samples = _rows("/a.x", "/a.deep.y", "/b.z")
    file = io.BytesIO()
    writer = Writer(file, chunk_size=300)
    writer.start()
    channels = [writer.register_channel("/a", "cbor", 0), writer.register_channel("/b", "json", 0)]
    for (time, x), (_, y), (_, z) in zip(*(own for _, own in samples), strict=True):
        writer.add_message(channels[0], time, cbor2.dumps({"x": x, "deep": {"y": y}}), time)
        writer.add_message(channels[1], time, json.dumps({"z": z}).encode(), time)
    writer.finish()
    yield LogSeed("zstd", file.getvalue(), ".mcap", samples=samples, guard=ALL)


def _protobuf() -> Iterator[LogSeed]:
    from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
    from mcap_protobuf.writer import Writer

    samples = _rows("/a.x", "/a.y", "/b.z")
    file = io.BytesIO()
    with Writer(file) as writer:
        for (time, x), (_, y), (_, z) in zip(*(own for _, own in samples), strict=True):
            writer.write_message("/a", Vector3(x=x, y=y, z=1.0), time, time)
            writer.write_message("/b", Vector3(x=1.0, y=1.0, z=z), time, time)
    yield LogSeed("zstd", file.getvalue(), ".mcap", samples=samples, guard=ALL)


def _messages(format_: str) -> Iterator[LogSeed]:
    """The sound file whose messages are damaged one by one."""
    one = messages.encoding(format_)
    read = one.reader(one.schema)
    assert read
    rows = [read(raw) for raw in one.sound]
    samples = tuple(
        (f"/a.{field}", tuple((T0 + step * SECOND, row[at]) for step, row in enumerate(rows)))
        for at, field in enumerate(one.fields)
    )
    yield LogSeed("", messages.mcap(messages.Told(one, one.schema, one.sound, True)), ".mcap", samples=samples)


def _old_bag() -> Iterator[LogSeed]:
    """A bag of version 1.2, with an index and as its recorder was ended without one."""
    from ....written.old_bag import Message, bag

    samples = _rows("/a.data", "/b.data")
    sound = [
        Message(signal.removesuffix(".data"), "std_msgs/Float64", time, struct.pack("<d", value))
        for both in zip(*(own for _, own in samples), strict=True)
        for (signal, _), (time, value) in zip(samples, both, strict=True)
    ]
    for indexed in (True, False):
        content = bag(sound, indexed)
        spans, at = [], 13
        while at < len(content):
            head = struct.unpack_from("<I", content, at)[0]
            end = at + 8 + head + struct.unpack_from("<I", content, at + 4 + head)[0]
            spans.append((at, end))
            at = end
        heads = [(at, at + 4) for at, _ in spans]
        words = tuple((at + skip, at + skip + 4) for at, end in spans for skip in range(4, min(end - at, 160) - 4, 7))
        yield LogSeed("indexed" if indexed else "", content, ".bag", samples=samples, records=tuple(spans),
                      numbers=(*heads, *words))  # fmt: skip
