"""Logs of ground stations: what they hold is what pymavlink reads, field by field, at the time that stands before."""

from __future__ import annotations

import random
import struct
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import all as dialect

from robophm.core.errors import SourceError
from robophm.transports.recordings.formats.mavlink import MavlinkRecording
from robophm.transports.recordings.opening import open_source

from ..written.mavlink import logged, sender

T0 = 1_750_000_000_000_000
LIMITS = {"uint8_t": (0, 255), "int8_t": (-128, 127), "uint16_t": (0, 65535), "int16_t": (-32768, 32767),
          "uint32_t": (0, 2**32 - 1), "int32_t": (-(2**31), 2**31 - 1), "uint64_t": (0, 2**64 - 1),
          "int64_t": (-(2**63), 2**63 - 1)}  # fmt: skip


def some(chance: random.Random, type_: str) -> Any:
    if type_ in LIMITS:
        return chance.choice([0, chance.randint(*LIMITS[type_])])
    return struct.unpack("<f", struct.pack("<f", chance.uniform(-1e3, 1e3)))[0]


def message(chance: random.Random, kind: Any) -> Any:
    """A message of a kind with any values, zeros among them: those at its end are not sent."""
    counts = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
    given = []
    for name, type_ in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        if type_ == "char":
            given.append(b"name"[: max(1, counts[name])])
        elif counts[name]:
            given.append([some(chance, type_) for _ in range(counts[name])])
        else:
            given.append(some(chance, type_))
    return kind(*given)


def every_kind(seed: int = 1) -> list[bytes]:
    """Two messages of every kind that pymavlink knows, of MAVLink 1 where it has them, and one that is signed."""
    chance, by = random.Random(seed), sender()
    log = []
    for kind in dialect.mavlink_map.values():
        log.append(message(chance, kind).pack(by))
        log.append(message(chance, kind).pack(by, force_mavlink1=kind.id < 256))
    by.signing.secret_key, by.signing.link_id, by.signing.timestamp, by.signing.sign_outgoing = b"k" * 32, 1, 1, True
    return [*log, dialect.MAVLink_attitude_message(1, 0.5, 0, 0, 0, 0, 0).pack(by)]


def whole(messages: list[bytes]) -> bytes:
    """A log of messages, one a second."""
    return b"".join(struct.pack(">Q", T0 + number * 1_000_000) + one for number, one in enumerate(messages))


def test_every_field_of_every_kind_is_as_pymavlink_decodes_it(tmp_path: Path) -> None:
    path, messages = tmp_path / "flight.tlog", every_kind()
    path.write_bytes(b"".join(struct.pack(">Q", T0 + n) + raw for n, raw in enumerate(messages)))
    decoder, compared = dialect.MAVLink(None), 0
    theirs = [decoder.decode(bytearray(raw)) for raw in messages]
    with open_source(path) as source:
        assert sum(info.messages for info in source.topics()) == len(theirs)
        signals = {}
        for info in source.topics():
            for field in info.fields:
                name, array = field.removesuffix("[]"), field.endswith("[]")
                first = getattr(theirs[(info.first or 0) // 1000 - T0], name)
                for index in range(len(first)) if array else (None,):
                    signals[f"{info.topic}.{name}" + ("" if index is None else f"[{index}]")] = name, index
        (columns,) = source.columns(signals, 0)
        for signal, (name, index) in signals.items():
            read = [getattr(theirs[time // 1000 - T0], name) for time in columns[signal].times.tolist()]
            expected = np.array([float(one if index is None else one[index]) for one in read])
            assert columns[signal].values.tobytes() == expected.tobytes(), signal
            compared += len(expected)
        assert not source.notes
    assert compared > 8000


def test_a_flight_is_read_as_pymavlink_reads_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, by, chance = tmp_path / "flight.tlog", sender(), random.Random(3)
    made = [dialect.MAVLink_attitude_message(n, chance.random(), n, 1, 1, 1, 1) for n in range(50)]
    path.write_bytes(b"".join(logged(T0 + 4 * n, one, by) for n, one in enumerate(made)))
    monkeypatch.setattr(mavutil, "mavlink", dialect)
    peer = mavutil.mavlogfile(str(path))
    try:
        theirs = [(round(one._timestamp * 1e6) * 1000, one.roll) for one in iter(peer.recv_msg, None)]
    finally:
        peer.close()
    assert [(time, value) for time, _, value in open_source(path).samples(["/ATTITUDE.roll"])] == theirs
    assert len(theirs) == 50


def test_senders_and_instances_are_topics(tmp_path: Path) -> None:
    path, log = tmp_path / "flight.tlog", b""
    for step in range(3):
        log += logged(T0 + step, dialect.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3), sender())
        log += logged(T0 + step, dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), sender(255, 190))
        for battery in (0, 1):
            cells = [4000 + battery, *[65535] * 9]
            made = dialect.MAVLink_battery_status_message(battery, 0, 0, 2500, cells, 100, 5, 5, 90)
            log += logged(T0 + step, made, sender())
        for name in (b"lift", b"a.b c"):
            log += logged(T0 + step, dialect.MAVLink_named_value_float_message(1, name, 0.5), sender())
    path.write_bytes(log)
    with open_source(path) as source:
        assert [info.topic for info in source.topics()] == [
            "/255/190/HEARTBEAT", "/BATTERY_STATUS", "/BATTERY_STATUS_1", "/HEARTBEAT", "/NAMED_VALUE_FLOAT_a_b_c",
            "/NAMED_VALUE_FLOAT_lift",
        ]  # fmt: skip
        assert [one.value for one in source.samples(["/BATTERY_STATUS_1.voltages[0]"])] == [4001] * 3
        assert [one.value for one in source.samples(["/255/190/HEARTBEAT.type"])] == [6] * 3
        assert source.spans() == [(T0 * 1000, (T0 + 2) * 1000)]


def test_only_what_has_its_checksum_counts(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    each = [logged(T0 + n, dialect.MAVLink_attitude_message(n, n, 0, 0, 0, 0, 0), sender()) for n in range(20)]
    changed = bytearray(each[7])
    changed[20] ^= 1
    unknown = struct.pack(">Q", T0) + b"\xfd\x02\x00\x00\x00\x01\x01\xff\xff\xff\x01\x02\x03\x04"
    path.write_bytes(
        b"".join([*each[:7], changed, *each[8:12], b"\xfd\xfe" * 9, *each[12:15], unknown, *each[15:], b"x"])
    )
    source = open_source(path)
    found = [one.value for one in source.samples(["/ATTITUDE.roll"])]
    assert found == [n for n in range(20) if n != 7]
    assert source.notes == {
        "damaged, and read as far as it is whole": 1,
        "bytes of a log that belong to no message": len(changed) + 18 + 1,
        "message of a kind that is not known: 16777215": 1,
    }


@pytest.mark.full
@pytest.mark.parametrize(
    "filling", [b"\xfd", bytes(8) + b"\xfe\xff\x00\x01\x01\x1e" + b"\xfe" * 257], ids=["FD", "long"]
)
def test_megabytes_of_what_may_begin_messages_take_no_minutes(filling: bytes, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(whole(every_kind()) + filling * ((1 << 24) // len(filling)))
    begun = time.process_time()
    with open_source(path) as source:
        assert len(source.topics()) > 300
        next(iter(source.columns(["/ATTITUDE.roll"], 0)))
        assert source.notes["bytes of a log that belong to no message"] > 1 << 23
    assert time.process_time() - begun < 10  # half a minute, if each place were tried by itself


def test_more_kinds_of_messages_than_are_believed_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    by = sender()
    messages = []
    for number in range(5000):
        by.srcSystem, by.srcComponent = 1 + number % 250, 1 + number // 250
        messages.append(dialect.MAVLink_heartbeat_message(0, 0, 0, 0, 0, 0).pack(by))
    path.write_bytes(whole(messages))
    with pytest.raises(SourceError, match=f"{path}: cannot be read: has messages of more than 4096 kinds or senders"):
        open_source(path)


def test_hundreds_of_damaged_logs_are_read_or_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    chance = random.Random(5)
    kinds = list(dialect.mavlink_map.values())
    each = [logged(T0 + n, message(chance, chance.choice(kinds)), sender()) for n in range(60)]
    whole, path, read = b"".join(each), tmp_path / "flight.tlog", 0
    for _ in range(100):
        damaged = bytearray(whole[: chance.randrange(40, len(whole))])
        for _ in range(chance.randrange(6)):
            damaged[chance.randrange(len(damaged))] = chance.randrange(256)
        path.write_bytes(damaged)
        try:
            source = MavlinkRecording(path)
            for info in source.topics()[:5]:
                field = info.fields[-1].replace("[]", "[0]") if info.fields else ""
                read += sum(1 for _ in source.samples([f"{info.topic}.{field}"])) if field else 0
        except SourceError as error:
            assert str(error).startswith(str(path))  # noqa: PT017
            assert "\n" not in str(error)  # noqa: PT017
    assert read > 200
    assert capfd.readouterr() == ("", "")


def test_without_pymavlink_it_is_said_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "flight.tlog"
    path.write_bytes(logged(T0, dialect.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3), sender()) * 2)
    monkeypatch.setitem(sys.modules, "pymavlink.dialects.v20", None)
    with pytest.raises(SourceError, match=r"needs pymavlink; install it with `pip install 'robophm\[mavlink\]'`"):
        open_source(path)
