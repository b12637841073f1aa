"""MCAP with messages of FlatBuffers: every number of all of Foxglove's types as flatc's own readers find it."""

from __future__ import annotations

import importlib
import inspect
import math
import random
import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals import flatbuffer_messages, plain_messages

flatbuffers = pytest.importorskip("flatbuffers", reason="no flatbuffers (make setup installs it)")
foxglove = pytest.importorskip("foxglove_schemas_flatbuffer", reason="make setup installs foxglove-schemas-flatbuffer")

T0 = 1_750_000_000 * SECOND
FOLDER = Path(foxglove.__path__[0])


def module_of(name: str) -> Any:
    return importlib.import_module(f"foxglove_schemas_flatbuffer.{name}")


def types() -> list[str]:
    """Foxglove's types of tables: times and durations are structs, which are no messages."""
    return sorted(path.stem for path in FOLDER.glob("*.bfbs") if hasattr(module_of(path.stem), f"{path.stem}Start"))


def adders(name: str) -> list[str]:
    """The fields of a table as flatc calls them."""
    return re.findall(rf"^def {name}Add(\w+)\(", inspect.getsource(module_of(name)), re.MULTILINE)


def within(source: str) -> str | None:
    """The type of table or struct that an accessor of flatc gives."""
    found = re.search(r"from \.(\w+) import", source)
    return found[1] if found else None


def build(builder: Any, name: str, chance: random.Random) -> int:
    """Write a table of any values through what flatc made; now and then a field is missing."""
    module, made = module_of(name), {}
    for field in adders(name):
        source = inspect.getsource(getattr(getattr(module, name), field))
        inner = within(source)
        if chance.random() < 0.2:
            continue
        if "self._tab.String(" in source:
            made[field] = builder.CreateString("some")
        elif "self._tab.Vector(" in source:
            flags = re.search(r"Get\(flatbuffers\.number_types\.(\w+)Flags", source)
            each = (
                [build(builder, inner, chance) for _ in range(2)] if inner else [chance.randrange(256) for _ in "abc"]
            )
            getattr(module, f"{name}Start{field}Vector")(builder, len(each))
            for one in reversed(each):
                if inner:
                    builder.PrependUOffsetTRelative(one)
                else:
                    getattr(builder, f"Prepend{flags[1] if flags else None}")(one)
            made[field] = builder.EndVector()
        elif inner and not hasattr(module_of(inner), f"Create{inner}"):
            made[field] = build(builder, inner, chance)
        elif not inner:
            made[field] = chance.randrange(2) if "bool(" in source else chance.randrange(200)
            made[field] += chance.random() if "Float" in source else 0
    getattr(module, f"{name}Start")(builder)
    for field in adders(name):
        inner = within(inspect.getsource(getattr(getattr(module, name), field)))
        if inner and hasattr(module_of(inner), f"Create{inner}"):
            when = getattr(module_of(inner), f"Create{inner}")(builder, 1_700_000_000 + chance.randrange(9), 7)
            getattr(module, f"{name}Add{field}")(builder, when)
        elif field in made:
            getattr(module, f"{name}Add{field}")(builder, made[field])
    return int(getattr(module, f"{name}End")(builder))


def message(name: str, chance: random.Random) -> bytes:
    builder = flatbuffers.Builder(0)
    builder.Finish(build(builder, name, chance))
    return bytes(builder.Output())


def numbers(found: Any, prefix: str = "") -> Iterator[tuple[str, float]]:
    """Every number that flatc's reader of a table finds, by a path without capitals and strokes."""
    name = type(found).__name__
    for field in adders(name) or [
        one for one in vars(type(found)) if one[0].isupper() and one not in ("SizeOf", "Init")
    ]:
        each: list[tuple[str, Any]] = []
        if hasattr(found, f"{field}Length"):
            each = [(f"[{n}]", getattr(found, field)(n)) for n in range(getattr(found, f"{field}Length")())]
        else:
            each = [("", getattr(found, field)())]
        for index, one in each:
            if hasattr(one, "Init"):
                yield from numbers(one, f"{prefix}{field}{index}.")
            elif isinstance(one, int | float):
                yield plain(f"{prefix}{field}{index}"), float(one)


def plain(field: str) -> str:
    return field.replace("_", "").lower()


def write(path: Path, messages: Mapping[str, Sequence[bytes]], schemas: Mapping[str, bytes] | None = None) -> Path:
    """A topic of each type, messages a second apart."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for name, each in messages.items():
            known = (schemas or {}).get(name) or (FOLDER / f"{name}.bfbs").read_bytes()
            schema = writer.register_schema(f"foxglove.{name}", "flatbuffer", known)
            channel = writer.register_channel(f"/{name}", "flatbuffer", schema)
            for step, raw in enumerate(each):
                writer.add_message(channel, T0 + step * SECOND, raw, T0 + step * SECOND)
        writer.finish()
    return path


@pytest.mark.full
def test_every_number_of_every_type_of_foxglove_is_as_flatc_reads_it(tmp_path: Path) -> None:
    chance = random.Random(7)
    made = {name: [message(name, chance) for _ in range(2)] for name in types()}
    path = write(tmp_path / "drive.mcap", made)
    expected: dict[str, list[float]] = {}
    for name, each in made.items():
        for raw in each:
            for field, value in numbers(getattr(module_of(name), name).GetRootAs(raw)):
                expected.setdefault(f"/{name}.{field}", []).append(value)
    with open_source(path) as source:
        known = {f"/{info.topic[1:]}.{field}" for info in source.topics() for field in info.fields}
        signals = [found for one in known for found in within_arrays(one)]
        found: dict[str, list[float]] = {}
        for sample in source.samples(signals):
            if not math.isnan(sample.value):
                topic, _, field = sample.signal.partition(".")
                found.setdefault(f"{topic}.{plain(field)}", []).append(sample.value)
    assert {name: np.array(each).tobytes() for name, each in found.items()} == {
        name: np.array(each).tobytes() for name, each in expected.items()
    }
    columns: dict[str, list[float]] = {}
    for block in read_columns(path, signals):
        for topic, part in block.items():
            for field, values in part.values.items():
                columns.setdefault(f"{topic}.{plain(field)}", []).extend(values[~np.isnan(values)].tolist())
    assert {name: each for name, each in columns.items() if each} == found
    assert len(made) > 40
    assert len(expected) > 500


def within_arrays(field: str) -> list[str]:
    """The paths to as many elements of arrays as are written."""
    head, array, tail = field.partition("[]")
    return [f"{head}[{n}]{rest}" for n in range(3) for rest in within_arrays(tail)] if array else [field]


def test_time_and_names_are_those_of_the_message(tmp_path: Path) -> None:
    builder = flatbuffers.Builder(0)
    joints, states, when = module_of("JointState"), module_of("JointStates"), module_of("Time")
    each = []
    for name, effort in (("pan", 1.5), ("lift", None)):
        text = builder.CreateString(name)
        joints.Start(builder)
        joints.AddName(builder, text)
        if effort:
            joints.AddEffort(builder, effort)
        each.append(joints.End(builder))
    states.StartJointsVector(builder, 2)
    for one in reversed(each):
        builder.PrependUOffsetTRelative(one)
    vector = builder.EndVector()
    states.Start(builder)
    states.AddTimestamp(builder, when.CreateTime(builder, T0 // SECOND + 2, 5))
    states.AddJoints(builder, vector)
    builder.Finish(states.End(builder))
    with Recording(write(tmp_path / "drive.mcap", {"JointStates": [bytes(builder.Output())]})) as source:
        assert source.names()["/JointStates"] == {"joints[]": ["pan", "lift"]}
        found = list(source.samples(["/JointStates.joints[pan].effort", "/JointStates.joints[lift].effort"]))
        assert [one.value for one in found if not math.isnan(one.value)] == [1.5]
        assert {one.time for one in found} == {T0 + 2 * SECOND + 5}


def test_damaged_messages_and_schemas_cost_themselves(tmp_path: Path) -> None:
    chance, read = random.Random(5), 0
    raw, known = message("LaserScan", chance), (FOLDER / "LaserScan.bfbs").read_bytes()
    for turn in range(100):
        schema, told = bytearray(known), bytearray(raw)
        broken = schema if turn % 2 else told
        for _ in range(3):
            broken[chance.randrange(len(broken))] = chance.randrange(256)
        path = write(tmp_path / "drive.mcap", {"LaserScan": [bytes(told), raw]}, {"LaserScan": bytes(schema)})
        try:
            with open_source(path) as source:
                read += len(list(source.samples(["/LaserScan.start_angle"])))
        except SourceError as error:
            assert "\n" not in str(error)  # noqa: PT017
    assert read > 70


def as_often(builder: Any, start: Callable[[Any, int], object], one: int, count: int) -> int:
    """A vector that has one table so often."""
    start(builder, count)
    for _ in range(count):
        builder.PrependUOffsetTRelative(one)
    return int(builder.EndVector())


def shared_tables(count: int, length: int) -> bytes:
    """A list of scenes, each of which is one and the same table, with one and the same list of cubes in it."""
    builder = flatbuffers.Builder(0)
    update, entity, cube = (module_of(one) for one in ("SceneUpdate", "SceneEntity", "CubePrimitive"))
    text = builder.CreateString("x" * length)
    cube.Start(builder)
    one = cube.End(builder)
    cubes = as_often(builder, entity.StartCubesVector, one, count)
    entity.Start(builder)
    entity.AddCubes(builder, cubes)
    entity.AddId(builder, text)
    scene = entity.End(builder)
    scenes = as_often(builder, update.StartEntitiesVector, scene, count)
    update.Start(builder)
    update.AddEntities(builder, scenes)
    builder.Finish(update.End(builder))
    return bytes(builder.Output())


@pytest.mark.parametrize(("count", "length"), [(3000, 1), (3, 2_000_000)], ids=["tables", "texts"])
def test_what_lies_once_and_is_named_a_thousand_times_is_bounded(
    monkeypatch: pytest.MonkeyPatch, count: int, length: int
) -> None:
    """Nine million cubes in 36 kB: within the bound on values of a message."""
    monkeypatch.setattr(plain_messages, "MOST_VALUES", 1 << 16)
    decode = flatbuffer_messages.described("foxglove.SceneUpdate", (FOLDER / "SceneUpdate.bfbs").read_bytes()).decode
    assert len(decode(shared_tables(3, 1)).entities[2].cubes) == 3
    with pytest.raises(ValueError, match=r"over 65,536 values"):
        decode(shared_tables(count, length))


LIES = {
    "nothing": b"",
    "beyond the end": struct.pack("<I", 1 << 31),
    "slots before the beginning": struct.pack("<Ii", 4, 100),
    "a vector of four billion": struct.pack("<IHHHHHHiI", 16, 8, 12, 0, 4, 0, 0, 12, 4) + struct.pack("<I", 2**32 - 1),
}


@pytest.mark.parametrize("raw", LIES.values(), ids=LIES)
def test_offsets_that_lie_are_not_followed(raw: bytes) -> None:
    decode = flatbuffer_messages.described("foxglove.JointStates", (FOLDER / "JointStates.bfbs").read_bytes()).decode
    with pytest.raises((ValueError, struct.error)):
        decode(raw)
    with pytest.raises((SourceError, ValueError, struct.error)):
        flatbuffer_messages.described("foxglove.JointStates", raw)


def test_a_type_that_a_schema_lacks_is_said(tmp_path: Path) -> None:
    schema = (FOLDER / "Log.bfbs").read_bytes()
    path = write(tmp_path / "drive.mcap", {"LaserScan": [b"x"]}, {"LaserScan": schema})
    with Recording(path) as source:
        assert source.undecoded() == {"/LaserScan": "its schema has no type 'foxglove.LaserScan'"}
