"""Programs find in the bytes what rosbags and mcap-ros2 decode from them."""

from __future__ import annotations

import random
import struct
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from tests.cases import examples

from robophm.transports.recordings.columns.field_extraction import Elements, Numbers, Take
from robophm.transports.recordings.columns.message_layout import NotCompilableError, compile_fields
from robophm.transports.recordings.columns.single import Single
from robophm.transports.signals.element_names import names_in
from robophm.transports.signals.message_type import MessageType, field_getter, may_name_elements

from .messages import INTEGERS, fields_of, message, numeric_types

CDR, PACKED = get_typestore(Stores.LATEST), get_typestore(Stores.ROS1_NOETIC)
KINDS = [(CDR, False, type_) for type_ in numeric_types(CDR)] + [(PACKED, True, t) for t in numeric_types(PACKED)]
IDS = [f"{'ros1' if packed else 'cdr'}-{type_}" for _, packed, type_ in KINDS]


def type_of(store: Any, type_: str, packed: bool = False) -> MessageType:
    decode = store.deserialize_ros1 if packed else store.deserialize_cdr
    return MessageType(
        type_, store.fielddefs, "ros1" if packed else "cdr", partial(decode, typename=type_), None, False, store, True
    )


def laid_out(raws: list[bytes], guard: bytes = b"\xff\xff\xff") -> tuple[Any, Any, Any]:
    """The messages in one buffer, at odd places, with something else around each."""
    buffer = guard + guard.join(raws) + guard
    ends = np.cumsum([len(raw) + len(guard) for raw in raws])
    return np.frombuffer(buffer, np.uint8), ends - [len(raw) for raw in raws], ends


def found(numbers: Numbers, slot: int, row: int) -> float | None:
    return None if numbers.absent[slot][row] else float(numbers.values[slot][row])


def decoded(type_: MessageType, field: str, decoded_message: Any) -> float | None:
    try:
        return float(field_getter(type_.definitions, type_.name, field)(decoded_message))
    except IndexError:
        return None


def same(one: float | None, other: float | None) -> bool:
    return one == other or (one is not None and other is not None and np.isnan(one) and np.isnan(other))


@pytest.mark.parametrize(("store", "packed", "name"), KINDS, ids=IDS)
@given(seed=st.integers(0, 2**32))
@settings(max_examples=examples(2), deadline=None, derandomize=True)
def test_all_fields_of_every_type_are_as_rosbags_decodes_them(store: Any, packed: bool, name: str, seed: int) -> None:
    chance = random.Random(seed)
    type_ = type_of(store, name, packed)
    fields = tuple(fields_of(store, name, chance))
    some = tuple(chance.sample(fields, chance.randint(1, len(fields))))
    raws = []
    for _ in range(3):
        written = message(store, chance, name, longest=3)
        if packed:
            raws.append(bytes(store.serialize_ros1(written, name)))
        else:
            raws.append(bytes(store.serialize_cdr(written, name, little_endian=chance.random() < 0.5)))
    for asked in (fields, some):
        numbers = compile_fields(type_, asked).run(*laid_out(raws))
        assert not numbers.doubtful.any()
        for row, raw in enumerate(raws):
            read = type_.decode(raw)
            for slot, field in enumerate(asked):
                assert same(found(numbers, slot, row), decoded(type_, field, read)), (field, row)
        try:
            single = Single(compile_fields(type_, asked))
        except NotCompilableError:
            continue
        for row, raw in enumerate(raws):
            alone = single.read(raw)
            if alone is None:  # the other order of bytes
                assert raw[:2] == b"\0\0"
                continue
            assert all(same(float(alone[slot]), found(numbers, slot, row)) for slot in range(len(asked)))


def test_a_message_by_itself() -> None:
    """By hand: a text, a number that CDR aligns, and bytes too few, too many, or without the text's end."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg("string name\nuint8 small\nfloat64 value\nbool on", "a/msg/Named"))
    for packed in (True, False):
        single = Single(compile_fields(type_of(store, "a/msg/Named", packed), ("on", "value", "small")))
        text = b"\x02\0\0\0ab" if packed else b"\0\1\0\0\x03\0\0\0ab\0"
        # from behind the encapsulation: 7 bytes, the small one the eighth, the double at 8
        raw = text + b"\x07" + struct.pack("<d?", 2.5, True)
        assert single.read(raw) == [True, 2.5, 7]
        assert [single.read(raw[:length]) for length in range(len(raw))] == [None] * len(raw)
        longest = 0 if packed else 3
        assert single.read(raw + bytes(longest)) == [True, 2.5, 7]
        assert single.read(raw + bytes(longest + 1)) is None
        for length in (0, 1, 200, 0x7FFFFFFF, 0xFFFFFFFF):
            lied = bytearray(raw)
            struct.pack_into("<I", lied, 0 if packed else 4, length)
            assert single.read(bytes(lied)) is None


def test_what_is_behind_a_sequence_is_left_to_a_decoder() -> None:
    with pytest.raises(NotCompilableError):
        Single(compile_fields(type_of(CDR, "sensor_msgs/msg/JointState"), ("effort[0]",)))


def plain(value: Any) -> Any:
    """A message as mcap-ros2 takes it."""
    if isinstance(value, list | np.ndarray):
        return [plain(element) for element in value]
    if hasattr(value, "__msgtype__"):
        names = [name for name in value.__dataclass_fields__ if not name.startswith("__")]
        return {name.removesuffix("_") if name == "from_" else name: plain(getattr(value, name)) for name in names}
    return value.item() if isinstance(value, np.generic) else value


@pytest.mark.full
@pytest.mark.parametrize("name", numeric_types(CDR))
def test_what_mcap_ros2_writes(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for small in ("byte", "char"):  # rosbags and mcap-ros2 take the other one to be signed
        monkeypatch.setitem(INTEGERS, small, (0, 127))
    dynamic = pytest.importorskip("mcap_ros2._dynamic")
    chance = random.Random(name)
    short = name.replace("/msg/", "/")
    write = dynamic.serialize_dynamic(short, CDR.generate_msgdef(name, ros_version=2)[0])[short]
    messages = [message(CDR, chance, name) for _ in range(4)]
    type_ = type_of(CDR, name)
    fields = tuple(fields_of(CDR, name, chance))
    numbers = compile_fields(type_, fields).run(*laid_out([write(plain(written)) for written in messages]))
    assert not numbers.doubtful.any()
    for row, written in enumerate(messages):
        for slot, field in enumerate(fields):
            assert same(found(numbers, slot, row), decoded(type_, field, written)), (field, row)


# By hand, from the rules of CDR


def defined(text: str, name: str = "a_msgs/msg/A") -> MessageType:
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, name))
    return type_of(store, name)


def test_numbers_are_aligned_to_their_size_from_behind_the_encapsulation() -> None:
    type_ = defined("uint8 a\nfloat64 b\nstring s\nint16 c\nfloat64[] d\nuint8 e")
    raw = bytes.fromhex(
        "00010000"  # encapsulation: CDR, little-endian
        "07 00000000000000 000000000000f83f"  # a = 7, seven of padding, b = 1.5
        "03000000 6f6b00 00 feff 0000"  # s = 'ok' with its zero, one of padding, c = -2, two
        "01000000 0000000000000040"  # one of d, 4 + 32 is at a multiple of 8: 2.0
        "09"
    )
    numbers = compile_fields(type_, ("a", "b", "c", "d[0]", "d[1]", "e")).run(*laid_out([raw]))
    assert [found(numbers, slot, 0) for slot in range(6)] == [7, 1.5, -2, 2, None, 9]


def test_fixed_runs_are_one_step() -> None:
    type_ = defined("float64[9] k\nuint8[1000] rest\nfloat32 x\nstring s\nfloat32 y")
    assert [type(step) for step in compile_fields(type_, ("x",)).steps[:-1]] == [Take]
    assert compile_fields(type_, ("x",)).steps[0].skip == 1072


def test_elements_of_fixed_size_are_passed_at_once() -> None:
    store = get_typestore(Stores.LATEST)
    steps = compile_fields(type_of(store, "geometry_msgs/msg/PoseArray"), ("poses[3].position.x",)).steps
    assert Elements in map(type, steps)


def test_what_is_not_compiled_says_so() -> None:
    with pytest.raises(NotCompilableError):
        compile_fields(defined("string[9999] a\nfloat64 x"), ("x",))
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_idl("module a_msgs { module msg { struct A { long double a; double x; }; }; };"))
    with pytest.raises(NotCompilableError):
        compile_fields(type_of(store, "a_msgs/msg/A"), ("x",))


# Damage


@pytest.mark.parametrize(("store", "packed", "name"), KINDS[::4], ids=IDS[::4])
def test_nothing_outside_a_message_is_ever_read(store: Any, packed: bool, name: str) -> None:
    """What lies around damaged messages makes no difference; what is still found is what rosbags still finds."""
    chance = random.Random(name)
    type_ = type_of(store, name, packed)
    raws = []
    for _ in range(40):
        written = message(store, chance, name)
        raw = bytearray(store.serialize_ros1(written, name) if packed else store.serialize_cdr(written, name))
        for _ in range(chance.randint(1, 3)):
            raw[chance.randrange(len(raw))] = chance.choice([0, 1, 127, 255, chance.randrange(256)])
        raws.append(bytes(raw[: chance.choice([len(raw), chance.randrange(len(raw))])]))
    fields = tuple(fields_of(store, name, chance))
    program = compile_fields(type_, fields)
    results = [program.run(*laid_out(raws, guard)) for guard in (b"\0" * 64, b"\xff" * 64)]
    for row, raw in enumerate(raws):
        assert results[0].doubtful[row] == results[1].doubtful[row]
        if results[0].doubtful[row]:
            continue
        try:
            read = type_.decode(raw)
        except Exception:
            read = None
        for slot, field in enumerate(fields):
            value = found(results[0], slot, row)
            assert same(value, found(results[1], slot, row))
            if read is not None:
                assert same(value, decoded(type_, field, read))


def test_a_message_out_of_step_does_not_take_its_neighbours_along() -> None:
    name = "sensor_msgs/msg/JointState"
    chance = random.Random(3)
    raws = [bytes(CDR.serialize_cdr(message(CDR, chance, name), name)) for _ in range(50)]
    bad = {3: raws[3][:10], 7: b"", 11: b"\0\2\0\0" + raws[11][4:], 13: raws[13] + b"\0" * 4, 49: raws[49][:16]}
    for row, raw in bad.items():
        raws[row] = raw
    numbers = compile_fields(type_of(CDR, name), ("effort[0]",)).run(*laid_out(raws))
    assert set(np.flatnonzero(numbers.doubtful)) >= {3, 7, 11, 49}
    assert set(np.flatnonzero(numbers.doubtful)) <= set(bad)


@pytest.mark.full
def test_pairs_of_types_in_one_message() -> None:
    """Every number behind every other, in messages and in sequences: where padding is got wrong."""
    numbers = ["bool", "byte", "char", "int16", "uint32", "int64", "float32", "float64", "string"]
    chance = random.Random(5)
    for one in numbers:
        for other in numbers:
            text = (
                f"{one}[] a\n{other} b\n{one} c\nB[] d\nB[2] e\nfloat64 x\n"
                + "=" * 80
                + f"\nMSG: a_msgs/B\n{one} f\n{other}[] g\n"
            )
            type_ = defined(text)
            store = get_typestore(Stores.EMPTY)
            store.register(get_types_from_msg(text, type_.name))
            raws = [bytes(store.serialize_cdr(message(store, chance, type_.name), type_.name)) for _ in range(3)]
            fields = tuple(fields_of(store, type_.name, chance))
            found_ = compile_fields(type_, fields).run(*laid_out(raws))
            for row, raw in enumerate(raws):
                read = store.deserialize_cdr(raw, type_.name)
                for slot, field in enumerate(fields):
                    assert same(found(found_, slot, row), decoded(type_, field, read)), (one, other, field)


def test_messages_of_types_without_strings_in_arrays_name_no_elements() -> None:
    """Of all types: what is passed over where names are looked for has none in any message."""
    chance = random.Random(1)
    naming = set()
    for store, packed, name in KINDS:
        type_ = type_of(store, name, packed)
        if any(names_in(message(store, chance, name)) for _ in range(4)):
            naming.add(name)
            assert may_name_elements(type_), name
    assert naming >= {"sensor_msgs/msg/JointState", "diagnostic_msgs/msg/DiagnosticArray", "tf2_msgs/msg/TFMessage"}
    assert not may_name_elements(type_of(CDR, "sensor_msgs/msg/BatteryState"))
